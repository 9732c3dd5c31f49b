//! Environments that play under given actions, and what they write, of all parts together.

use crate::support::database::{DATABASE, MATCHER};
use crate::support::inputs::{Draw, POISON, gpu};
use footwork::container::{Section, SectionError};
use footwork::env::locomotion::gpu::GpuLocomotion;
use footwork::env::locomotion::{CpuLocomotion, EnvConfig, EnvState};
use footwork::env::{EnvBatch, EnvSpec, Stats, Transition, VecEnv};
use footwork::gpu::{Array, Device};
use footwork::kernels::locomotion::locomotion_layout::{state_f32, state_u32};
use footwork::rl::rollout::Rollout;
use footwork::train::controller::{Controller, Scripted};

pub struct Player {
    device: Device,
    pub envs: EnvBatch,
    obstacles: usize,
    /// The columns of every part, poisoned when a rollout begins.
    rollouts: Vec<Rollout>,
    /// The next step of the rollout.
    step: usize,
}

/// Both devices.
pub fn devices() -> [Device; 2] {
    [Device::Cpu, Device::from(gpu())]
}

impl Player {
    /// As trainings open them: on the CPU in parts.
    pub fn open(device: &Device, config: &EnvConfig, steps: usize) -> Self {
        let envs = config.open(device, &MATCHER).expect("they fit");
        Self::new(device, envs, config, steps)
    }

    /// All in one part, whose first episodes are as long as all others.
    pub fn together(device: &Device, config: &EnvConfig, steps: usize) -> Self {
        let part: Box<dyn VecEnv> = match device {
            Device::Cpu => Box::new(CpuLocomotion::new(MATCHER.clone(), config)),
            Device::Gpu(gpu) => Box::new(GpuLocomotion::new(gpu, &MATCHER, config, 0, 0)),
        };
        let envs = EnvBatch::new(vec![part], None);
        Self::new(device, envs, config, steps)
    }

    /// Rollouts of so many steps.
    pub fn new(device: &Device, envs: EnvBatch, config: &EnvConfig, steps: usize) -> Self {
        let specs = envs.parts.iter().map(|part| part.spec());
        Player {
            rollouts: specs
                .map(|spec| Rollout::new(device, spec, steps, 1))
                .collect(),
            device: device.clone(),
            obstacles: config.task.obstacles(),
            step: 0,
            envs,
        }
    }

    pub fn spec(&self) -> EnvSpec {
        self.envs.spec()
    }

    /// Steps of a rollout.
    pub fn steps(&self) -> usize {
        self.rollouts[0].steps
    }

    /// Straight to the target at a brisk pace, with a new policy's noise.
    pub fn actions(&mut self, draw: &mut Draw) -> Vec<f32> {
        let scripted = Scripted {
            database: &DATABASE,
            speed: 2.0,
        };
        let seen = self.observation();
        let action = scripted.act(&seen, self.spec().observation.dim());
        let action = action.expect("actions").into_iter();
        action.map(|value| value + 0.5 * draw.normal()).collect()
    }

    /// `[rows][observation]`
    pub fn observation(&mut self) -> Vec<f32> {
        let mut seen = Vec::new();
        for part in &mut self.envs.parts {
            let numbers = part.spec().rows() * part.spec().observation.dim();
            let mut row = Array::from_slice(&self.device, &vec![POISON; 3 * numbers]);
            part.observe(&mut row, numbers);
            let row = row.read(&self.device).expect("observations");
            let (before, row) = row.split_at(numbers);
            let (row, behind) = row.split_at(numbers);
            assert!(before.iter().chain(behind).all(|&value| value == POISON));
            seen.extend_from_slice(row);
        }
        seen
    }

    /// Plays a step under actions `[rows][action]`.
    pub fn step(&mut self, action: &[f32]) {
        if self.step == self.steps() {
            self.step = 0;
        }
        let mut first = 0;
        for (part, rollout) in self.envs.parts.iter_mut().zip(&mut self.rollouts) {
            if self.step == 0 {
                let poison = vec![POISON; rollout.final_observation.len()];
                rollout.final_observation = Array::from_slice(&self.device, &poison);
            }
            let numbers = part.spec().rows() * part.spec().action;
            // Actions begin somewhere in the column.
            let at = self.step * numbers;
            let mut column = vec![f32::NAN; at];
            column.extend_from_slice(&action[first..][..numbers]);
            let column = Array::from_slice(&self.device, &column);
            let transition = Transition {
                step: self.step,
                reward: &mut rollout.reward,
                style_reward: &mut rollout.style_reward,
                termination: &mut rollout.termination,
                group: &mut rollout.group,
                final_observation: &mut rollout.final_observation,
            };
            part.step(&column, at, transition);
            first += numbers;
        }
        self.step += 1;
    }

    /// A column `[steps][rows][width]` of all parts.
    fn column<T: bytemuck::Pod>(&self, of: impl Fn(&Rollout) -> &Array<T>, steps: usize) -> Vec<T> {
        let read = |rollout| of(rollout).read(&self.device).expect("a column");
        let parts: Vec<Vec<T>> = self.rollouts.iter().map(read).collect();
        joined(steps, &parts)
    }

    /// `[steps][rows]`
    pub fn rewards(&self) -> Vec<f32> {
        self.column(|rollout| &rollout.reward, self.steps())
    }

    /// `[steps][rows]`
    pub fn terminations(&self) -> Vec<u32> {
        self.column(|rollout| &rollout.termination, self.steps())
    }

    /// `[final_steps][rows][observation]`
    pub fn final_observations(&self) -> Vec<f32> {
        let steps = self.spec().final_steps(self.steps());
        self.column(|rollout| &rollout.final_observation, steps)
    }

    pub fn stats(&mut self) -> Stats {
        let names = self.envs.stat_names();
        let mut sums = Array::from_slice(&self.device, &vec![POISON; names.len()]);
        self.envs.stats(&mut sums);
        Stats::new(names, &sums.read(&self.device).expect("sums"))
    }

    /// The state of all environments.
    pub fn state(&self) -> EnvState {
        let state = |part: &dyn VecEnv| {
            let (envs, mut section) = (part.spec().envs, Section::default());
            part.save(&mut section).expect("a section");
            let state = EnvState::load(&mut section, envs, self.obstacles, DATABASE.frames());
            state.expect("the state of such environments")
        };
        let parts: Vec<EnvState> = self.envs.parts.iter().map(|part| state(&**part)).collect();
        let of = |values: fn(&EnvState) -> &Vec<f32>, count| {
            let parts: Vec<_> = parts.iter().map(|part| values(part).clone()).collect();
            joined(count, &parts)
        };
        let words = |values: fn(&EnvState) -> &Vec<u32>, count| {
            let parts: Vec<_> = parts.iter().map(|part| values(part).clone()).collect();
            joined(count, &parts)
        };
        EnvState {
            step_counter: parts[0].step_counter,
            level: parts[0].level,
            state_f32: of(|part| &part.state_f32, state_f32::FIELDS),
            state_u32: words(|part| &part.state_u32, state_u32::FIELDS),
            boxes: of(|part| &part.boxes, 1),
            obstacle_velocity: of(|part| &part.obstacle_velocity, 1),
            maps: words(|part| &part.maps, 1),
        }
    }

    pub fn save(&self) -> Vec<(String, Section)> {
        self.envs.save().expect("sections")
    }

    /// Puts back what another player saved.
    pub fn load(&mut self, mut saved: Vec<(String, Section)>) -> Result<(), SectionError> {
        self.envs.load(|name| {
            let at = saved.iter().position(|(other, _)| other == name);
            let at = at.ok_or_else(|| SectionError(format!("no section `{name}`")))?;
            Ok(saved.swap_remove(at).1)
        })
    }
}

/// `[count][all rows]` from the `[count][rows]` of parts.
fn joined<T: Copy>(count: usize, parts: &[Vec<T>]) -> Vec<T> {
    let of = |number: usize| {
        let rows = parts.iter().map(move |part| {
            let length = part.len() / count;
            &part[number * length..][..length]
        });
        rows.flatten().copied()
    };
    (0..count).flat_map(of).collect()
}
