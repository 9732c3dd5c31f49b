//! Oracle: the twin, and rows by hand. Bar: equal bit for bit.

use crate::inputs::{Draw, SIZES, same};
use footwork::kernels::learn::gather_rows;

#[test]
fn rows_are_gathered_by_their_numbers() {
    for rows in SIZES {
        for width in [1, 4, 11] {
            let mut draw = Draw::new((rows + width) as u32);
            let mut table = draw.normals(70 * width);
            table[0] = f32::NAN;
            let numbers: Vec<u32> = (0..rows).map(|_| draw.below(70) as u32).collect();
            let params = gather_rows::Params {
                rows: rows as u32,
                width: width as u32,
            };
            let workgroups = [width.div_ceil(4) as u32, rows.div_ceil(64) as u32, 1];
            let forms = forms!(
                gather_rows, GATHER_ROWS, workgroups, params;
                table, numbers, out rows * width
            );
            for (form, out) in forms.shaders() {
                same(form, out, &forms.twin);
            }
            let row = |&number: &u32| &table[number as usize * width..][..width];
            let wanted: Vec<f32> = numbers.iter().flat_map(row).copied().collect();
            same("twin", &forms.twin, &wanted);
        }
    }
}
