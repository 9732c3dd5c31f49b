//! Pictures against kept ones, with a tolerance; what differs is kept for a look.

use crate::Picture;
use footwork::report::png_file;
use std::path::{Path, PathBuf};

/// A pixel differs if one of its colours does by more than this.
const FAR: u8 = 24;
/// Share of pixels that may: edges fall differently from one driver to the next.
const SOME: f64 = 0.01;
/// Mean difference of all colours.
const MEAN: f64 = 1.5;

impl Picture {
    /// Share of pixels that differ and mean difference.
    pub fn difference(&self, other: &Picture) -> (f64, f64) {
        assert_eq!(self.size, other.size);
        let apart: Vec<u8> = self
            .rgb
            .iter()
            .zip(&other.rgb)
            .map(|(a, b)| a.abs_diff(*b))
            .collect();
        let pixels = apart.len() / 3;
        let far = apart
            .chunks_exact(3)
            .filter(|pixel| pixel.iter().any(|&d| d > FAR))
            .count();
        let sum: f64 = apart.iter().map(|&d| f64::from(d)).sum();
        (far as f64 / pixels as f64, sum / apart.len() as f64)
    }

    /// Compares with `tests/view/pictures/NAME.png`; makes it if `FOOTWORK_KEEP` is set.
    pub fn must_be(&self, name: &str) {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/view/pictures");
        let kept = folder.join(format!("{name}.png"));
        if std::env::var_os("FOOTWORK_KEEP").is_some() {
            return self.save(&kept);
        }
        let expected = read(&kept);
        let (far, mean) = self.difference(&expected);
        if far <= SOME && mean <= MEAN {
            return;
        }
        let drawn = place(&format!("{name}.png"));
        self.save(&drawn);
        let apart = place(&format!("{name}-difference.png"));
        let both = self.rgb.iter().zip(&expected.rgb);
        let rgb = both
            .map(|(a, b)| a.abs_diff(*b).saturating_mul(4))
            .collect();
        Picture {
            size: self.size,
            rgb,
        }
        .save(&apart);
        panic!(
            "{:.2} % of pixels differ (mean {mean:.2}): compare {} with {}; the difference is {}",
            100.0 * far,
            drawn.display(),
            kept.display(),
            apart.display()
        );
    }

    pub fn save(&self, path: &Path) {
        png_file::save(path, self.size[0], self.size[1], &self.rgb).unwrap();
    }
}

pub fn place(name: &str) -> PathBuf {
    Path::new(env!("CARGO_TARGET_TMPDIR")).join(name)
}

fn read(path: &Path) -> Picture {
    let file = std::fs::File::open(path);
    let file = file.unwrap_or_else(|error| {
        panic!(
            "{}: {error}; make it with FOOTWORK_KEEP=1 cargo test",
            path.display()
        )
    });
    let mut reader = png::Decoder::new(std::io::BufReader::new(file))
        .read_info()
        .unwrap();
    let mut rgb = vec![0; reader.output_buffer_size().unwrap()];
    let info = reader.next_frame(&mut rgb).unwrap();
    rgb.truncate(info.buffer_size());
    Picture {
        size: [info.width, info.height],
        rgb,
    }
}
