//! Pictures and windows, on lavapipe.

mod body;
mod bout;
mod compare;
mod crowd;
mod pictures;
mod skills;
mod viewer;

use footwork::env::locomotion::LocomotionTask;
use footwork::gpu::Gpu;
use footwork::matching::MotionMatcher;
use footwork::motion::database::Database;
use footwork::motion::normalise::Weights;
use footwork::motion::synthetic;
use footwork::playback::player::Style;
use footwork::train::controller::{Controller, Scripted};
use footwork::train::playthrough::PlaythroughContext;
use footwork::view::painter::Drawable;
use footwork::view::{Camera, RenderTarget, Renderer, Scene};
use std::sync::{Arc, LazyLock};

static DATABASE: LazyLock<Arc<Database>> = LazyLock::new(|| {
    let (clips, roles) = synthetic::perform(1, 1.0);
    Arc::new(Database::build(&clips, roles, Weights::PAPER).unwrap())
});
static MATCHER: LazyLock<Arc<MotionMatcher>> =
    LazyLock::new(|| Arc::new(MotionMatcher::new(DATABASE.clone())));

fn gpu() -> Gpu {
    Gpu::lavapipe().expect("lavapipe")
}

fn context(task: LocomotionTask) -> PlaythroughContext {
    PlaythroughContext::new(MATCHER.clone(), task, Style::BEST)
}

/// Walks straight to the target.
struct Walker;

impl Controller for Walker {
    fn act(&self, observation: &[f32], width: usize) -> anyhow::Result<Vec<f32>> {
        let database = &DATABASE;
        Scripted {
            database,
            speed: 1.5,
        }
        .act(observation, width)
    }
}

/// A drawn picture: rows from the top.
struct Picture {
    size: [u32; 2],
    rgb: Vec<u8>,
}

impl Picture {
    fn draw(
        scene: &Scene,
        beside: Option<&dyn Drawable>,
        camera: &Camera,
        size: [u32; 2],
    ) -> Picture {
        Self::with(&mut Renderer::new(&gpu()), scene, beside, camera, size)
    }

    fn with(
        renderer: &mut Renderer,
        scene: &Scene,
        beside: Option<&dyn Drawable>,
        camera: &Camera,
        size: [u32; 2],
    ) -> Picture {
        let target = RenderTarget::new(&renderer.device, size);
        renderer.draw(scene, beside, camera, &target);
        let rgb = target.read(&renderer.device, &renderer.queue).unwrap();
        Picture { size, rgb }
    }

    fn pixel(&self, x: u32, y: u32) -> [u8; 3] {
        let at = 3 * (y * self.size[0] + x) as usize;
        self.rgb[at..at + 3].try_into().unwrap()
    }

    /// Mean row of the pixels that a test picks, or nothing if there are none.
    fn mean_row(&self, pick: impl Fn([u8; 3]) -> bool) -> Option<f32> {
        let rows = (0..self.size[1]).flat_map(|y| (0..self.size[0]).map(move |x| (x, y)));
        let rows: Vec<f32> = rows
            .filter(|&(x, y)| pick(self.pixel(x, y)))
            .map(|(_, y)| y as f32)
            .collect();
        (!rows.is_empty()).then(|| rows.iter().sum::<f32>() / rows.len() as f32)
    }
}
