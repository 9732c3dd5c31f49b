//! Policies of simulated bodies: those that act themselves, those that act under a latent, and those that steer a
//! low level, which is then in the same graph.

use super::body_description::{
    BodyPolicyKind, about_body, about_episode, about_latents, conventions, frames, latent_part,
    procedure, target_parts,
};
use super::description::{PolicyDescription, PortDescription};
use super::exported::ExportedPolicy;
use super::graph::{Attribute, Graph};
use super::network::{NetworkDescription, actor};
use crate::env::description::VectorPart;
use crate::env::humanoid::action::action_scale;
use crate::env::humanoid::task::describe::body_parts;
use crate::env::humanoid::task::{DT, HumanoidTask, agents};
use crate::export::format::TrainedRun;
use crate::nn::Policy;
use crate::physics::model::Model;
use crate::rl::ase::{FrozenLowLevel, STEPS_PER_DECISION};
use crate::train::body_episodes::BodyEpisodes;
use serde_json::json;

/// Longest latent without a direction: see [`to_latent`](crate::kernels::learn::low_level_input::to_latent).
const LEAST: f32 = 1e-6;

/// The policy of a run of a simulated body.
pub fn export(
    run: &TrainedRun,
    body: &BodyEpisodes,
    mut about: PolicyDescription,
) -> ExportedPolicy {
    let env = body.open(0);
    let task = env.task();
    let mut export = BodyExport {
        policy: &run.checkpoint.policy,
        task,
        graph: Graph::default(),
        inputs: Vec::new(),
        outputs: Vec::new(),
        networks: Vec::new(),
    };
    about.add("body", about_body(task.model()));
    about.add("episode", about_episode(task.rules()));
    let kind = match (run.task.low_level(), &body.latents) {
        (Some(low_level), _) => {
            export.steering(low_level);
            about.add("decision_steps", json!(STEPS_PER_DECISION));
            BodyPolicyKind::Steering
        }
        (None, Some(draw)) => {
            export.skilled(draw.dim);
            about.add("latents", about_latents(draw, body.recordings.as_deref()));
            BodyPolicyKind::Skilled
        }
        (None, None) => {
            export.acting();
            BodyPolicyKind::Acting
        }
    };
    let description = PolicyDescription {
        step_s: DT,
        conventions: conventions(),
        frames: frames(),
        inputs: export.inputs,
        outputs: export.outputs,
        procedure: procedure(kind),
        networks: export.networks,
        ..about
    };
    ExportedPolicy {
        graph: export.graph,
        description,
    }
}

struct BodyExport<'a> {
    policy: &'a Policy,
    task: &'a dyn HumanoidTask,
    graph: Graph,
    inputs: Vec<PortDescription>,
    outputs: Vec<PortDescription>,
    networks: Vec<NetworkDescription>,
}

impl BodyExport<'_> {
    fn model(&self) -> &Model {
        self.task.model()
    }

    fn acting(&mut self) {
        let observation = self.observation();
        let action = self.actor("actor", self.policy, &observation);
        self.act(&action);
    }

    fn skilled(&mut self, latent: usize) {
        let observation = self.observation();
        let meaning = "the skill that the body is to move by, a unit vector";
        let latent = self.input("latent", meaning, vec![latent_part(latent)]);
        let observed = self.graph.concat(&[&observation, &latent]);
        let action = self.actor("actor", self.policy, &observed);
        self.act(&action);
    }

    fn steering(&mut self, low_level: &FrozenLowLevel) {
        let part = || vec![latent_part(low_level.latent())];
        let observation = self.observation();
        let held = self.input(
            "latent",
            "`next_latent` of the step before; at the first step anything",
            part(),
        );
        let decide = self.input(
            "decide",
            "1 at the steps at which the policy decides on a latent anew, 0 where it keeps the one that is given",
            vec![VectorPart::new("decide", &["decide"], ["1", "none"], "1 or 0")],
        );
        let decision = self.actor("high_level", self.policy, &observation);
        let decided = self.on_sphere(&decision, low_level.latent());
        let decides = self.graph.scalar(0.5);
        let decides = self.graph.node("Greater", &[&decide, &decides]);
        let latent = self.graph.node("Where", &[&decides, &decided, &held]);
        let [own, _] = low_level.widths();
        let seen = self.graph.columns(&observation, 0..own);
        let observed = self.graph.concat(&[&seen, &latent]);
        let action = self.actor("low_level", &low_level.policy, &observed);
        self.act(&action);
        let next = PortDescription::vector(
            "next_latent",
            "the latent that the body moves by: to be given back at the next step",
            part(),
        );
        self.graph.output(next.name, &next.shape, &latent);
        self.outputs.push(next);
    }

    fn actor(&mut self, name: &str, policy: &Policy, vector: &str) -> String {
        let (value, network) = actor(&mut self.graph, name, policy, vector, None);
        self.networks.push(network);
        value
    }

    /// The latent that an action means: see [`to_latent`](crate::kernels::learn::low_level_input::to_latent).
    fn on_sphere(&mut self, action: &str, latent: usize) -> String {
        let graph = &mut self.graph;
        let mut axis = vec![0.0; latent];
        axis[0] = 1.0;
        let first_axis = graph.parameter("first_axis".into(), &[latent], axis);
        let length = |graph: &mut Graph, value: &str| {
            let axes = vec![("axes", Attribute::Ints(vec![1]))];
            graph.node_with("ReduceL2", &[value], axes)
        };
        let within = graph.clip(action, 1.0);
        let least = graph.scalar(LEAST);
        let short = length(graph, &within);
        let short = graph.node("Less", &[&short, &least]);
        let directed = graph.node("Where", &[&short, &first_axis, &within]);
        let long = length(graph, &directed);
        graph.node("Div", &[&directed, &long])
    }

    /// What the environment observes.
    fn observation(&mut self) -> String {
        let mut parts = body_parts(self.model());
        parts.extend(self.task.describe());
        self.input("observation", "the body and what it is to do", parts)
    }

    fn input(&mut self, name: &'static str, meaning: &str, parts: Vec<VectorPart>) -> String {
        let port = PortDescription::vector(name, meaning, parts);
        let value = self.graph.input(port.name, &port.shape);
        self.inputs.push(port);
        value
    }

    /// Puts out actions and the targets that they mean.
    fn act(&mut self, action: &str) {
        let drives = self.model().nu() / agents(self.model());
        let scale = action_scale(self.model());
        let (offset, scale) = scale.split_at(self.model().nu());
        let (offset, scale) = (offset[..drives].to_vec(), scale[..drives].to_vec());
        let targets = target_parts(self.model());
        let actions = VectorPart {
            mean: offset.clone(),
            scale: scale.iter().map(|scale| 1.0 / scale).collect(),
            ..targets.clone()
        };
        let graph = &mut self.graph;
        let offset = graph.parameter("action.offset".into(), &[drives], offset);
        let scale = graph.parameter("action.scale".into(), &[drives], scale);
        let within = graph.clip(action, 1.0);
        let scaled = graph.node("Mul", &[&within, &scale]);
        let target = graph.node("Add", &[&scaled, &offset]);
        let ports = [
            (
                "targets",
                "targets of the drives, to be held for a step",
                targets,
                target,
            ),
            (
                "action",
                "the same before it is scaled, as footwork's environments take it: what is beyond 1 counts as 1",
                actions,
                action.to_string(),
            ),
        ];
        for (name, meaning, part, value) in ports {
            let port = PortDescription::vector(name, meaning, vec![part]);
            self.graph.output(port.name, &port.shape, &value);
            self.outputs.push(port);
        }
    }
}
