//! The choice between devices and numbers of environments, from speeds alone.

use crate::gpu::Choice;
use anyhow::Result;

/// A speed this many times another is worth a change; less may be noise.
const WORTH: f64 = 1.1;
/// Doublings in a row that together were not worth it, after which speed has stopped growing.
const PATIENCE: usize = 2;

/// The speed of whole updates on a device.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Speed {
    /// The device.
    pub device: Choice,
    /// Environments stepped together.
    pub envs: usize,
    /// Environment steps a second.
    pub steps_per_s: f64,
}

/// Measures `first` environments, then twice as many again and again, until there are `most` of them or speed has
/// stopped growing. What fails after the first ends it as well: so many do not fit.
///
/// # Errors
/// The first fails.
pub fn grow(
    first: usize,
    most: usize,
    mut measure: impl FnMut(usize) -> Result<Speed>,
) -> Result<Vec<Speed>> {
    let mut speeds = vec![measure(first)?];
    let mut envs = 2 * first;
    while envs <= most && !has_stopped_growing(&speeds) {
        let Ok(speed) = measure(envs) else { break };
        speeds.push(speed);
        envs *= 2;
    }
    Ok(speeds)
}

fn has_stopped_growing(speeds: &[Speed]) -> bool {
    let (earlier, latest) = speeds.split_at(speeds.len().saturating_sub(PATIENCE));
    !earlier.is_empty() && quickest(latest) < WORTH * quickest(earlier)
}

fn quickest(speeds: &[Speed]) -> f64 {
    speeds
        .iter()
        .map(|speed| speed.steps_per_s)
        .fold(0.0, f64::max)
}

/// The device to train on and in how many environments: the fewest of each device that more are not worth leaving, and
/// of these the quickest. The devices before another stay where that one is not worth it.
pub fn choose(speeds: &[Speed]) -> Option<Speed> {
    let each = fewest_of_each(speeds).into_iter();
    each.reduce(|chosen, other| match worth(other, chosen) {
        true => other,
        false => chosen,
    })
}

/// Whether one speed is worth a change from another.
fn worth(one: Speed, other: Speed) -> bool {
    one.steps_per_s >= WORTH * other.steps_per_s
}

/// For each device its fewest environments that more are not worth leaving.
fn fewest_of_each(speeds: &[Speed]) -> Vec<Speed> {
    let of_devices = speeds.chunk_by(|one, next| one.device == next.device);
    let fewest = of_devices.filter_map(|own| {
        let best = quickest(own);
        own.iter().find(|speed| WORTH * speed.steps_per_s > best)
    });
    fewest.copied().collect()
}

/// Why it is this one.
pub fn reason(chosen: Speed, speeds: &[Speed]) -> String {
    let own = speeds.iter().filter(|speed| speed.device == chosen.device);
    let (mut fewer, mut more) = (false, false);
    for speed in own {
        fewer |= speed.envs < chosen.envs;
        more |= speed.envs > chosen.envs;
    }
    let envs = match (fewer, more) {
        (_, true) => Some("more environments are not 10 % quicker".to_string()),
        (true, false) => Some("the quickest that was measured".to_string()),
        (false, false) => None,
    };
    let others = fewest_of_each(speeds).into_iter();
    let others = others.filter(|other| other.device != chosen.device);
    let device = others.map(|other| match worth(chosen, other) {
        true => format!(
            "{:.1} times as quick as `{}`",
            chosen.steps_per_s / other.steps_per_s,
            other.device
        ),
        false => format!("`{}` is not 10 % quicker", other.device),
    });
    envs.into_iter()
        .chain(device)
        .collect::<Vec<_>>()
        .join(", ")
}

#[cfg(test)]
mod tests {
    use super::*;
    use anyhow::bail;

    const CPU: Choice = Choice::Cpu;
    const GPU: Choice = Choice::Gpu;

    /// Speeds of 256 environments, twice as many and so on.
    fn speeds(device: Choice, all: &[f64]) -> Vec<Speed> {
        let speed = |(doublings, &steps_per_s)| Speed {
            device,
            envs: 256usize << doublings,
            steps_per_s,
        };
        all.iter().enumerate().map(speed).collect()
    }

    /// How many environments are measured, of speeds that would be found.
    fn measured(all: &[f64], most: usize) -> Vec<usize> {
        let all = speeds(CPU, all);
        let measure = |envs| match all.iter().find(|speed| speed.envs == envs) {
            Some(&speed) => Ok(speed),
            None => bail!("they do not fit"),
        };
        let found = grow(256, most, measure).unwrap();
        found.iter().map(|speed| speed.envs).collect()
    }

    fn chosen(all: &[Speed]) -> (Choice, usize) {
        let chosen = choose(all).unwrap();
        (chosen.device, chosen.envs)
    }

    #[test]
    fn growth_ends_after_two_doublings_that_bring_little() {
        let most = 16_384;
        assert_eq!(measured(&[100.0; 9], most), [256, 512, 1024]);
        let pause = [100.0, 105.0, 130.0, 131.0, 132.0, 500.0];
        assert_eq!(measured(&pause, most), [256, 512, 1024, 2048, 4096]);
        let slower = [100.0, 90.0, 80.0, 500.0];
        assert_eq!(measured(&slower, most), [256, 512, 1024]);
        // Slow growth is growth: two doublings together count.
        let slow: Vec<f64> = (0..9).map(|n| 100.0 * 1.06_f64.powi(n)).collect();
        assert_eq!(measured(&slow, most).last(), Some(&16_384));
    }

    #[test]
    fn growth_ends_where_there_is_no_more_room() {
        let growing = [1.0, 2.0, 4.0, 8.0];
        assert_eq!(measured(&growing, 65_536), [256, 512, 1024, 2048]);
        assert_eq!(measured(&growing, 1024), [256, 512, 1024]);
        assert_eq!(measured(&growing, 256), [256]);
        assert!(grow(256, 1024, |_| bail!("they do not fit")).is_err());
    }

    #[test]
    fn a_gpu_is_taken_where_it_is_quicker() {
        let cpu = [200.0, 210.0, 205.0];
        let gpu = [20.0, 40.0, 80.0, 160.0, 320.0, 640.0, 650.0, 655.0];
        let all = |cpu: &[f64], gpu: &[f64]| [speeds(CPU, cpu), speeds(GPU, gpu)].concat();
        assert_eq!(chosen(&all(&cpu[..1], &gpu[..1])), (CPU, 256));
        assert_eq!(chosen(&all(&cpu, &gpu)), (GPU, 8192));
        assert_eq!(chosen(&all(&[200.0], &[300.0])), (GPU, 256));
        assert_eq!(chosen(&speeds(GPU, &gpu)), (GPU, 8192));
        assert_eq!(choose(&[]), None);
    }

    #[test]
    fn as_quick_is_no_reason_for_a_gpu_or_for_more_environments() {
        let all = [speeds(CPU, &[200.0, 215.0]), speeds(GPU, &[215.0, 219.0])].concat();
        assert_eq!(chosen(&all), (CPU, 256));
        let all = speeds(CPU, &[100.0, 150.0, 160.0, 155.0]);
        assert_eq!(chosen(&all), (CPU, 512));
    }

    #[test]
    fn the_reason_names_what_was_left() {
        let all = [speeds(CPU, &[100.0]), speeds(GPU, &[250.0])].concat();
        assert_eq!(reason(all[1], &all), "2.5 times as quick as `cpu`");
        let all = [speeds(CPU, &[100.0, 200.0]), speeds(GPU, &[50.0, 90.0])].concat();
        let why = reason(all[1], &all);
        assert_eq!(
            why,
            "the quickest that was measured, 2.2 times as quick as `gpu`"
        );
        let all = [speeds(CPU, &[100.0, 101.0]), speeds(GPU, &[102.0])].concat();
        let why = reason(all[0], &all);
        assert_eq!(
            why,
            "more environments are not 10 % quicker, `gpu` is not 10 % quicker"
        );
    }
}
