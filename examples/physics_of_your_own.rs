//! Physics of your own model: a pendulum on a motor, and a ball that it kicks.
//!
//! You learn to read MJCF, MuJoCo's format, and to step a world of it. Models that need more than the simulator has
//! are refused, with the lines and reasons.
//!
//! `cargo run --release --no-default-features --example physics_of_your_own [-- MODEL.xml]`

use footwork::physics::mjcf::MjcfOptions;
use footwork::physics::spatial::Spatial;
use footwork::prelude::*;
use std::path::Path;
use std::sync::Arc;

const MODEL: &str = r#"
<mujoco model="kick">
  <default><geom friction=".1"/></default>
  <worldbody>
    <geom type="plane" size="5 5 .1"/>
    <body name="leg" pos="0 0 .6">
      <joint name="hip" type="hinge" axis="0 1 0" damping=".05"/>
      <geom type="capsule" fromto="0 0 0 0 0 -.45" size=".05"/>
    </body>
    <body name="ball" pos="-.17 0 .1">
      <freejoint/>
      <geom type="sphere" size=".1" mass=".4"/>
    </body>
  </worldbody>
  <actuator>
    <motor joint="hip" gear="1" ctrllimited="true" ctrlrange="-20 20"/>
  </actuator>
</mujoco>"#;

fn main() -> anyhow::Result<()> {
    let model = match std::env::args_os().nth(1) {
        Some(path) => mjcf::read(Path::new(&path), MjcfOptions::default())?.model,
        None => mjcf::parse(MODEL, Path::new("kick.xml"))?,
    };
    let model = Arc::new(model);
    let mut state = SimulatorState::new(&model);
    let mut simulator = Simulator::new(model.clone(), SolverOptions::fast(&model));
    let forces = vec![Spatial::ZERO; model.bodies.len()];
    println!("{} positions, {} actuators", state.q.len(), model.nu());

    let steps = (1.0 / simulator.options.dt) as usize;
    for step in 0..=steps {
        // The motor's torque, Nm: a kick of a tenth of a second.
        let torque = if step < steps / 10 { 15.0 } else { 0.0 };
        let targets = vec![torque; model.nu()];
        simulator.step(&mut state, &targets, &forces);
        if step % (steps / 10) == 0 {
            // The poses are those that the step began with.
            let time = step as f32 * simulator.options.dt;
            print!("{time:.1} s, {} contacts", simulator.contacts.points.len());
            for (body, pose) in model.bodies.iter().zip(&simulator.poses) {
                print!(", {} at {:5.2}", body.name, pose.at(body.com));
            }
            println!();
        }
    }
    Ok(())
}
