//! The CPU's convolutions, in floating-point operations a second: `cargo bench --bench convolution`.

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use footwork::ppo::convolution::{Convolution, Layer, Parameters, backward, chain, forward};

const SAMPLES: usize = 256;

fn convolution(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("convolution");
    for (name, strides) in [("paper", [1, 1]), ("strides of 2", [2, 2])] {
        let convolutions = [(16, 4, strides[0]), (32, 3, strides[1])];
        let convolutions = convolutions.map(|(filters, size, stride)| Convolution {
            filters,
            size,
            stride,
        });
        let layers = chain([16, 16, 2], &convolutions).expect("filters fit");
        let values = |length: usize| -> Vec<f32> {
            (0..length)
                .map(|i| (i * 7919 % 1000) as f32 / 5e3 - 0.1)
                .collect()
        };
        let owned = layers
            .iter()
            .map(|layer| (values(layer.weights()), values(layer.filters())));
        let owned: Vec<_> = owned.collect();
        let parameters: Vec<Parameters> = owned.iter().map(|(w, b)| (&w[..], &b[..])).collect();
        let input: Vec<f32> = (0..SAMPLES * 16 * 16 * 2)
            .map(|i| f32::from(i * 31 % 7 == 0))
            .collect();
        let activations = forward(&layers, &parameters, &input);
        let gradient = values(activations[1].len());
        let [first, second] = [0, 1].map(|i: usize| operations(&layers[i]));
        // Backward, a layer takes as many again for its weights and as many for its input, which
        // the first does not need.
        let work = [first + second, first + 2 * second];
        for threads in [1, 2] {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
            let pool = pool.build().expect("threads start");
            group.throughput(Throughput::Elements(work[0]));
            group.bench_function(format!("{name}, forward, threads: {threads}"), |b| {
                b.iter(|| pool.install(|| forward(&layers, &parameters, &input)));
            });
            group.throughput(Throughput::Elements(work[1]));
            group.bench_function(format!("{name}, backward, threads: {threads}"), |b| {
                b.iter(|| {
                    pool.install(|| backward(&layers, &parameters, &input, &activations, &gradient))
                });
            });
        }
    }
    group.finish();
}

/// Multiplications and additions of a layer forward.
fn operations(layer: &Layer) -> u64 {
    let [height, width, _] = layer.outputs();
    (2 * SAMPLES * height * width * layer.weights()) as u64
}

criterion_group!(benches, convolution);
criterion_main!(benches);
