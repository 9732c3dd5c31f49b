//! The page of `footwork web` for its scripts: plain functions over one page.
//!
//! Whatever a script is given a place of stays there until the next call. What fails returns 0, and [`message`] says
//! why; what panics stops the module, and the message stays to be read.

#![warn(missing_docs)]

use footwork::playback::meshes::{cube, sphere};
use footwork::view::scene::Scene;
use footwork::view::sunlight::PassView;
use footwork::web::Page;
use std::cell::RefCell;

thread_local! {
    static MODULE: RefCell<Module> = RefCell::default();
    static MESSAGE: RefCell<String> = RefCell::default();
}

#[derive(Default)]
struct Module {
    page: Option<Page>,
    /// Where scripts put the contents of files.
    input: Vec<u8>,
    /// What scripts read.
    text: String,
    floats: Vec<f32>,
    views: Vec<PassView>,
    scene: Scene,
    /// Place and length of what a function has left, several of them where it is said so.
    places: Vec<u32>,
}

fn with<T>(call: impl FnOnce(&mut Module) -> T) -> T {
    MODULE.with_borrow_mut(call)
}

/// Lets the page do something, if there is one; what fails is kept as the message.
fn page<T: Default>(call: impl FnOnce(&mut Page) -> anyhow::Result<T>) -> T {
    with(|module| match &mut module.page {
        Some(page) => call(page).unwrap_or_else(|error| {
            MESSAGE.set(format!("{error:#}"));
            T::default()
        }),
        None => T::default(),
    })
}

fn place<T>(values: &[T]) -> [u32; 2] {
    [values.as_ptr() as u32, values.len() as u32]
}

/// Leaves places to be read.
fn leave(module: &mut Module, places: &[[u32; 2]]) -> *const u32 {
    module.places = places.concat();
    module.places.as_ptr()
}

/// Where the contents of a file of so many bytes are to be put, for [`open`] or [`add_part`].
#[unsafe(no_mangle)]
pub extern "C" fn input(bytes: usize) -> *mut u8 {
    with(|module| {
        module.input.clear();
        module.input.resize(bytes, 0);
        module.input.as_mut_ptr()
    })
}

/// Opens the run in the input.
#[unsafe(no_mangle)]
pub extern "C" fn open() -> u32 {
    std::panic::set_hook(Box::new(|panic| MESSAGE.set(panic.to_string())));
    with(|module| match Page::open(&module.input) {
        Ok(page) => {
            module.page = Some(page);
            1
        }
        Err(error) => {
            MESSAGE.set(format!("{error:#}"));
            0
        }
    })
}

/// Adds the part of the motion in the input.
#[unsafe(no_mangle)]
pub extern "C" fn add_part() -> u32 {
    let part = with(|module| std::mem::take(&mut module.input));
    page(|page| page.add_part(&part).map(|()| 1))
}

/// Goes on by so many seconds.
#[unsafe(no_mangle)]
pub extern "C" fn advance(seconds: f32) -> u32 {
    page(|page| page.advance(seconds).map(|()| 1))
}

/// The query that the next frame waits for, and the number of candidates; 0 if there is none.
#[unsafe(no_mangle)]
pub extern "C" fn query() -> *const u32 {
    with(|module| {
        let query = module.page.as_ref().and_then(Page::query);
        let Some(query) = query else {
            return std::ptr::null();
        };
        let candidates = query.candidates as u32;
        module.floats = query.features.to_vec();
        let place = place(&module.floats);
        leave(module, &[place, [candidates, 0]])
    })
}

/// Answers the query here and now.
#[unsafe(no_mangle)]
pub extern "C" fn search() {
    page(|page| {
        page.search();
        Ok(())
    });
}

/// Answers the query by a candidate.
#[unsafe(no_mangle)]
pub extern "C" fn set_match(candidate: u32) {
    page(|page| {
        page.set_match(candidate);
        Ok(())
    });
}

/// Rows of the candidates from a number on, for the search's shader.
#[unsafe(no_mangle)]
pub extern "C" fn search_rows(first: usize) -> *const u32 {
    with(|module| {
        let page = module.page.as_ref();
        module.floats = page.map_or_else(Vec::new, |page| page.search_rows(first));
        let place = place(&module.floats);
        leave(module, &[place])
    })
}

/// The views of both passes, capsules and boxes, for a picture so many times as wide as high.
#[unsafe(no_mangle)]
pub extern "C" fn picture(aspect: f32) -> *const u32 {
    with(|module| {
        if let Some(page) = &mut module.page {
            let picture = page.picture(aspect);
            module.views = picture.views.to_vec();
            module.scene = picture.scene;
        }
        let Scene { capsules, cuboids } = &module.scene;
        let places = [place(&module.views), place(capsules), place(cuboids)];
        leave(module, &places)
    })
}

/// The corners of capsules, four numbers each, and of boxes, six. Of a capsule there are so many `around`, and so many
/// rings from its middle up.
#[unsafe(no_mangle)]
pub extern "C" fn meshes(around: usize, up: usize) -> *const u32 {
    with(|module| {
        let (sphere, cube) = (sphere(around, up), cube());
        module.floats = sphere.as_flattened().to_vec();
        module.floats.extend(cube.as_flattened().as_flattened());
        let (all, split) = (place(&module.floats), sphere.len() as u32 * 4);
        let cube = [all[0] + 4 * split, all[1] - split];
        leave(module, &[[all[0], split], cube])
    })
}

/// The pointer goes down at a point of the picture, from (-1, -1) at the lower left to (1, 1).
#[unsafe(no_mangle)]
pub extern "C" fn press(x: f32, y: f32) {
    page(|page| {
        page.press([x, y]);
        Ok(())
    });
}

/// The pointer moves while it is down.
#[unsafe(no_mangle)]
pub extern "C" fn drag(x: f32, y: f32) {
    page(|page| {
        page.drag([x, y]);
        Ok(())
    });
}

/// The pointer goes up.
#[unsafe(no_mangle)]
pub extern "C" fn release() -> u32 {
    page(|page| page.release().map(|()| 1))
}

/// Multiplies the camera's distance by a factor.
#[unsafe(no_mangle)]
pub extern "C" fn zoom(factor: f32) {
    page(|page| {
        page.camera.zoom(factor);
        Ok(())
    });
}

/// What there is to tell of the run: JSON.
#[unsafe(no_mangle)]
pub extern "C" fn state() -> *const u32 {
    with(|module| {
        let state = module.page.as_ref().map(Page::state);
        module.text = serde_json::to_string(&state).unwrap_or_default();
        let place = place(module.text.as_bytes());
        leave(module, &[place])
    })
}

/// Why the last call failed.
#[unsafe(no_mangle)]
pub extern "C" fn message() -> *const u32 {
    static PLACE: std::sync::Mutex<[u32; 2]> = std::sync::Mutex::new([0; 2]);
    // The module may be borrowed by what has panicked.
    let mut found = PLACE
        .lock()
        .unwrap_or_else(|poisoned| poisoned.into_inner());
    *found = MESSAGE.with_borrow(|text| place(text.as_bytes()));
    found.as_ptr()
}
