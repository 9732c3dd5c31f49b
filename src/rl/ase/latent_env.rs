//! Environments around environments, whose agents move under latents.

use super::LatentDraw;
use crate::container::{Section, SectionError};
use crate::env::{EnvSpec, ObservationSpec, Transition, VecEnv};
use crate::gpu::{Array, Device};
use crate::kernels::learn::advance_latents::{Params, draw, launch, twin};
use crate::nn::rows;
use anyhow::Result;

/// Environments whose agents also observe a latent, behind all else. It is drawn anew when its time is over, and
/// when an episode begins.
pub struct LatentEnv {
    inner: Box<dyn VecEnv>,
    spec: EnvSpec,
    draw: LatentDraw,
    device: Device,
    /// Numbers of a latent, of the inner observation, and of centres.
    dims: Array<u32>,
    /// `[centres][1 + latent]`
    centres: Array,
    /// `[rows][latent]`
    latents: Array,
    /// Steps for which they are still kept, `[rows]`.
    steps_left: Array<u32>,
    /// What the inner environments observe, `[rows][inner]`, and observed last, `[final_steps][rows][inner]`.
    observation: Array,
    inner_final: Array,
    seed: u32,
    /// Number of the first row in the whole batch.
    first: u32,
    step_counter: u32,
}

impl LatentEnv {
    /// Latents for environments on `device`, of which the first has the number `first` in the whole batch.
    pub fn new(
        inner: Box<dyn VecEnv>,
        draw: &LatentDraw,
        device: &Device,
        first: usize,
        seed: u32,
    ) -> LatentEnv {
        let (spec, dim) = (*inner.spec(), draw.dim);
        let (rows, width) = (spec.rows(), spec.observation.dim());
        let dims = [dim, width, draw.centres.len() / (1 + dim)].map(|dim| dim as u32);
        let mut env = LatentEnv {
            spec: EnvSpec {
                observation: ObservationSpec {
                    vector: spec.observation.vector + dim,
                    ..spec.observation
                },
                ..spec
            },
            dims: Array::from_slice(device, &dims),
            // An array holds something.
            centres: Array::from_slice(device, &[&draw.centres[..], &[0.0]].concat()),
            latents: Array::zeroed(device, rows * dim),
            steps_left: Array::zeroed(device, rows),
            observation: Array::zeroed(device, rows * width),
            inner_final: Array::zeroed(device, rows * width),
            first: (first * spec.agents) as u32,
            step_counter: 0,
            draw: draw.clone(),
            device: device.clone(),
            inner,
            seed,
        };
        let (none, mut no_row) = (Array::zeroed(device, rows), Array::zeroed(device, 1));
        env.advance(&none, None, &mut no_row);
        env
    }

    /// Parameters of the step of a rollout, or of none.
    fn params(&self, step: Option<usize>) -> Params {
        let rows = self.spec.rows();
        let [least, most] = self.draw.kept_steps;
        Params {
            rows: rows as u32,
            first: self.first,
            seed: self.seed,
            step_counter: self.step_counter,
            at: step.map_or(0, |step| step * rows) as u32,
            final_row: step.map_or(0, |step| self.spec.final_row(step)) as u32,
            least,
            most,
            opening: u32::from(step.is_none()),
            spread: self.draw.spread,
        }
    }

    /// Lets latents grow older by the step of a rollout, or draws all of them.
    fn advance(
        &mut self,
        termination: &Array<u32>,
        step: Option<usize>,
        final_observation: &mut Array,
    ) {
        let params = self.params(step);
        match &self.device {
            Device::Cpu => twin(
                self.dims.host(),
                termination.host(),
                self.centres.host(),
                self.inner_final.host(),
                final_observation.host_mut(),
                self.latents.host_mut(),
                self.steps_left.host_mut(),
                &params,
            ),
            Device::Gpu(gpu) => launch(
                gpu,
                self.dims.buffer(),
                termination.buffer(),
                self.centres.buffer(),
                self.inner_final.buffer(),
                final_observation.buffer(),
                self.latents.buffer(),
                self.steps_left.buffer(),
                &params,
            ),
        }
    }
}

impl VecEnv for LatentEnv {
    fn spec(&self) -> &EnvSpec {
        &self.spec
    }

    fn inner(&self) -> Option<&dyn VecEnv> {
        Some(&*self.inner)
    }

    fn inner_mut(&mut self) -> Option<&mut dyn VecEnv> {
        Some(&mut *self.inner)
    }

    fn observe(&mut self, out: &mut Array, at: usize) {
        self.inner.observe(&mut self.observation, 0);
        let width = self.inner.spec().observation.dim();
        let parts = [(&self.observation, width), (&self.latents, self.draw.dim)];
        let both = rows::beside(&self.device, &parts);
        rows::replace(&self.device, out, at, &both);
    }

    fn step(&mut self, action: &Array, at: usize, out: Transition) {
        let inner = self.inner.spec().observation.dim();
        let finals = out.final_observation.len() / self.spec.observation.dim() * inner;
        if self.inner_final.len() != finals {
            self.inner_final = Array::zeroed(&self.device, finals);
        }
        let step = out.step;
        self.inner.step(
            action,
            at,
            Transition {
                step,
                reward: out.reward,
                style_reward: out.style_reward,
                termination: &mut *out.termination,
                group: out.group,
                final_observation: &mut self.inner_final,
            },
        );
        self.step_counter += 1;
        self.advance(out.termination, Some(step), out.final_observation);
    }

    fn restart(&mut self, which: &[bool]) -> Result<()> {
        self.inner.restart(which)?;
        self.step_counter += 1;
        let params = self.params(None);
        let mut latents = self.latents.read(&self.device)?;
        let mut steps_left = self.steps_left.read(&self.device)?;
        let rows = latents.chunks_exact_mut(self.draw.dim).zip(&mut steps_left);
        for (row, (latent, left)) in rows.enumerate() {
            if which[row / self.spec.agents] {
                *left = draw(self.first + row as u32, &self.draw.centres, latent, &params);
            }
        }
        self.latents = Array::from_slice(&self.device, &latents);
        self.steps_left = Array::from_slice(&self.device, &steps_left);
        Ok(())
    }

    fn stat_names(&self) -> &'static [&'static str] {
        self.inner.stat_names()
    }

    fn stats(&mut self, out: &mut Array) {
        self.inner.stats(out);
    }

    fn save(&self, to: &mut Section) -> Result<()> {
        let mut inner = Section::default();
        self.inner.save(&mut inner)?;
        to.put_section("inner", inner);
        to.put("latent_steps", self.step_counter);
        to.put_array("latents", &self.latents.read(&self.device)?);
        to.put_array("latent_steps_left", &self.steps_left.read(&self.device)?);
        Ok(())
    }

    fn load(&mut self, from: &mut Section) -> Result<(), SectionError> {
        self.inner.load(&mut from.take_section("inner"))?;
        self.step_counter = from.get("latent_steps")?;
        let latents = from.take_finite("latents", self.latents.len())?;
        let steps_left: Vec<u32> = from.take_array("latent_steps_left", self.steps_left.len())?;
        self.latents = Array::from_slice(&self.device, &latents);
        self.steps_left = Array::from_slice(&self.device, &steps_left);
        Ok(())
    }
}
