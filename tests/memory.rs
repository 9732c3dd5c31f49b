//! A training in its steady state asks the device for no memory. In a process of its own: the device's
//! pages are everybody's.

use footwork::gpu::{Choice, Device};
use footwork::motion::database::Database;
use footwork::motion::normalise::Weights;
use footwork::motion::synthetic;
use footwork::rl::rollout;
use footwork::rl::ppo::update::Learner;
use footwork::nn::tensors;
use footwork::train::config::{Config, Kind, Preset};
use footwork::env::locomotion::{Batch, Setup};
use std::sync::Arc;

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
    let (clips, roles) = synthetic::perform(1, 1.0);
    let database = Database::build(&clips, roles, Weights::PAPER).expect("synthetic motion");
    let database = Arc::new(database);
    for kind in [Kind::Plane, Kind::Obstacles] {
        let mut config = Config::preset(kind, Preset::Fast);
        (config.ppo.envs, config.ppo.horizon, config.ppo.minibatch) = (32, 8, 128);
        let (task, ppo) = (config.task, &config.ppo);
        let setup = Setup {
            task,
            envs: ppo.envs,
            horizon: ppo.horizon,
            seed: 1,
            level: 0,
        };
        let mut batch = Batch::open(&device, &database, &setup);
        let mut learner = Learner::new(ppo, task.width(), &device, 1).expect("a network that fits");
        let mut updates = |count: usize| {
            for _ in 0..count {
                let policy = learner.policy();
                let rollout = rollout::collect(&mut batch, &policy, &learner.scale, ppo, &device);
                let losses = learner.update(&rollout.expect("a rollout"), ppo);
                tensors::read(losses).expect("losses");
            }
            given(&device)
        };
        let settled = updates(16);
        assert_eq!(updates(24), settled, "{} bytes and blocks", task.name());
    }
}
