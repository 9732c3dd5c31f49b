use footwork::motion::*;
use footwork::search::Index;
use std::time::Instant;
fn main() {
    let t = Instant::now();
    let imp = import::import(
        std::path::Path::new("../shared/mocap/lafan1"),
        &Default::default(),
    )
    .unwrap();
    let db = database::Database::build(&imp.clips, imp.roles, normalise::Weights::PAPER).unwrap();
    println!(
        "import+build {:?} frames {} candidates {}",
        t.elapsed(),
        db.frames(),
        db.candidates.len()
    );
    let rows = db.rows();
    let t = Instant::now();
    let index = Index::build(&rows);
    println!("index {:?} {} MB", t.elapsed(), index.bytes() / 1000000);
    use footwork::kernels::rng::*;
    for noise in [0.0f32, 0.3, 1.0] {
        for kind in 0..2 {
            let qs: Vec<[f32; 28]> = (0..4096u32)
                .map(|i| {
                    let a = index_below(random4(1, i, 0, 0)[0], rows.len() as u32) as usize;
                    let b = if kind == 0 {
                        a
                    } else {
                        index_below(random4(1, i, 1, 0)[0], rows.len() as u32) as usize
                    };
                    let mut q = rows[a];
                    for k in 15..27 {
                        q[k] = rows[b][k] + noise * gaussian(random4(2, i, k as u32, 0));
                    }
                    q
                })
                .collect();
            let mut out = vec![0u32; qs.len()];
            let t = Instant::now();
            for (q, o) in qs.iter().zip(&mut out) {
                *o = index.nearest(q).index;
            }
            let one = t.elapsed();
            let t = Instant::now();
            index.nearest_all(&qs, &mut out);
            let all = t.elapsed();
            println!(
                "noise {noise} kind {kind}: one core {:?}/q, all {:?}/q",
                one / 4096,
                all / 4096
            );
            let mut d = vec![0.0; 256];
            let mut ix = vec![0; 256];
            let n = 256;
            footwork::kernels::search_wide::twin(
                &rows,
                &qs[..n],
                &mut d,
                &mut ix,
                &footwork::kernels::search_wide::Params {
                    count: n as u32,
                    candidates: rows.len() as u32,
                    chunk: rows.len() as u32,
                },
            );
            assert_eq!(&ix[..], &out[..n]);
        }
    }
}
