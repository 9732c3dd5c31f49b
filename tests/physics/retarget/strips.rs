//! Film strips, on lavapipe.

use super::{humanoid_and, performed};
use footwork::gpu::Gpu;
use footwork::view::strip::strips;
use std::sync::Arc;

#[test]
fn a_motion_makes_two_film_strips() {
    let gpu = Gpu::lavapipe().unwrap_or_else(|error| panic!("{error}"));
    let (clip, roles) = performed();
    let (model, motion) = humanoid_and(&clip, &roles);
    let folder = tempfile::tempdir().expect("a folder");
    let position = folder.path().join("made/for/it");
    let files = strips(&gpu, &Arc::new(model), &motion, &position).expect("two strips");
    for (file, what) in files.iter().zip(["replayed", "driven"]) {
        let named = format!("synthetic_000-{what}.png");
        assert_eq!(file, &position.join(named));
        let picture = std::fs::read(file).expect("a picture");
        assert!(picture.len() > 50_000, "{what}: {} bytes", picture.len());
    }
}
