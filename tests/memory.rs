//! A training in its steady state asks the device for no memory. In a process of its own: the device's
//! pages are everybody's.

use footwork::gpu::{Choice, Device};
use footwork::ranks::Ranks;
use footwork::rl::Algorithm;
use footwork::rl::ppo::PpoLearner;
use footwork::train::config::Preset;
use footwork::train::tasks::REGISTRY;

/// Bytes that the driver has given, and in how many pieces.
fn given(device: &Device) -> (u64, usize) {
    let Device::Gpu(gpu) = device else {
        unreachable!("lavapipe is a GPU here")
    };
    let report = gpu.setup.device.generate_allocator_report();
    let report = report.expect("Vulkan's allocator tells");
    (report.total_reserved_bytes, report.blocks.len())
}

#[test]
fn updates_allocate_nothing_on_the_device() {
    let device = Device::open(Choice::Lavapipe).expect("an adapter");
    for entry in &REGISTRY {
        let mut config = entry.config(Preset::Fast);
        let ppo = &mut config.ppo;
        (ppo.envs, ppo.rollout_length, ppo.minibatch_size) = (32, 8, 128);
        let task = (entry.load)(&config).expect("its data").task;
        let mut envs = task
            .open(&device, &Ranks::alone(), config.ppo.envs, 1)
            .expect("they fit");
        let mut learner =
            PpoLearner::new(&config.ppo, &envs, &device, 1).expect("a network that fits");
        let mut updates = |count: usize| {
            for _ in 0..count {
                learner.iterate(&mut envs, 0).expect("an update");
            }
            given(&device)
        };
        let settled = updates(8);
        assert_eq!(updates(12), settled, "{}: bytes and blocks", entry.name);
    }
}
