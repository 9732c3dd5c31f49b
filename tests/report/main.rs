//! Pictures are whole, of the right size and not blank, whatever they are given; event
//! files hold what TensorBoard expects.

mod ablation;
mod coverage;
#[path = "../support/events.rs"]
mod event_file;
mod events;
mod learning_curve;
mod obstacle_walks;
mod picture;
mod table;
mod trajectories;

use footwork::report::ReportError;
use footwork::report::learning_curve::Point;
use std::collections::HashSet;
use std::fs;
use std::io::BufReader;
use std::path::Path;

struct Picture {
    width: usize,
    height: usize,
    rgb: Vec<u8>,
}

impl Picture {
    fn open(path: &Path) -> Self {
        let file = BufReader::new(fs::File::open(path).unwrap());
        let mut reader = png::Decoder::new(file).read_info().unwrap();
        let mut rgb = vec![0; reader.output_buffer_size().unwrap()];
        let info = reader.next_frame(&mut rgb).unwrap();
        assert_eq!(info.color_type, png::ColorType::Rgb);
        Self {
            width: info.width as usize,
            height: info.height as usize,
            rgb,
        }
    }

    /// How many different colours a part of the picture has; the part is given in
    /// shares of the width and the height.
    fn colours(&self, x: (f64, f64), y: (f64, f64)) -> usize {
        let range = |(from, to): (f64, f64), size: usize| {
            (from * size as f64) as usize..(to * size as f64) as usize
        };
        let mut seen = HashSet::new();
        for row in range(y, self.height) {
            for column in range(x, self.width) {
                let at = 3 * (row * self.width + column);
                seen.insert(self.rgb[at..at + 3].to_vec());
            }
        }
        seen.len()
    }

    fn pixel(&self, x: usize, y: usize) -> [u8; 3] {
        let at = 3 * (y * self.width + x);
        [self.rgb[at], self.rgb[at + 1], self.rgb[at + 2]]
    }

    fn has(&self, colour: [u8; 3]) -> bool {
        self.rgb.chunks_exact(3).any(|pixel| pixel == colour)
    }
}

/// Draws into a fresh folder and checks that the picture is all that is left there.
fn drawn(draw: impl FnOnce(&Path) -> Result<(), ReportError>) -> Picture {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("picture.png");
    draw(&path).unwrap();
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
    Picture::open(&path)
}

fn training() -> Vec<Point> {
    (1..=200)
        .map(|update| {
            let part = f64::from(update) / 200.0;
            Point {
                steps: update as u64 * 5000,
                wall_s: 300.0 * part,
                success: Some(part.sqrt()),
                episode_return: Some(1000.0 * part + 20.0 * (40.0 * part).sin()),
                episode_length: Some(200.0 - 180.0 * part),
                ..Point::default()
            }
        })
        .collect()
}
