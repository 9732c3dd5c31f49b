//! A step allocates nothing.

use super::place::PLACE;
use footwork::runtime::MovingObstacle;
use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;

/// The system's allocator, which counts what this thread asks of it.
struct Counting;

thread_local! {
    static ASKED: Cell<usize> = const { Cell::new(0) };
}

fn count() {
    // A thread that ends frees its own.
    let _ = ASKED.try_with(|asked| asked.set(asked.get() + 1));
}

// SAFETY: everything is the system allocator's; only a number is kept beside it.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        count();
        // SAFETY: as the caller promises.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        count();
        // SAFETY: as the caller promises.
        unsafe { System.dealloc(pointer, layout) }
    }

    unsafe fn realloc(&self, pointer: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        count();
        // SAFETY: as the caller promises.
        unsafe { System.realloc(pointer, layout, size) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

/// How often the allocator was called meanwhile.
fn during(work: impl FnOnce()) -> usize {
    let before = ASKED.get();
    work();
    ASKED.get() - before
}

/// Frames in which a character decides twenty times.
const FRAMES: usize = 120;

#[test]
fn the_allocator_is_counted() {
    assert_eq!(during(|| drop(std::hint::black_box(vec![1, 2, 3]))), 2);
}

#[test]
fn a_step_allocates_nothing() {
    for task in ["plane", "obstacles"] {
        let mut characters = PLACE.characters(task, 7);
        let obstacle = |i: usize| MovingObstacle {
            centre: [i as f32 - 10.0, 2.0],
            half: [0.4, 0.3],
            velocity: [0.1, -0.2],
        };
        let obstacles: Vec<MovingObstacle> = (0..20).map(obstacle).collect();
        for character in 0..characters.count() {
            characters.set_target(character, [4.0, -3.0]);
            characters.set_obstacles(character, &obstacles);
        }
        // All have decided.
        (0..6).for_each(|_| characters.step_all());
        let asked = during(|| {
            for frame in 0..FRAMES {
                for character in 0..characters.count() {
                    characters.set_target(character, [frame as f32, 2.0]);
                    characters.set_obstacles(character, &obstacles[..10]);
                }
                characters.step_all();
            }
        });
        assert_eq!(asked, 0, "{task}");
    }
}
