//! Policies of motion matching.

use super::description::{PolicyDescription, PortDescription};
use super::exported::ExportedPolicy;
use super::graph::Graph;
use super::network::actor;
use crate::env::locomotion::describe::{action_parts, observation_parts, trajectory_parts};
use crate::env::locomotion::{LEVELS, LocomotionTask, Obstacles};
use crate::export::format::TrainedRun;
use crate::kernels::locomotion::locomotion_layout::{CELL, CELLS, FULL, MAPS};
use crate::kernels::locomotion::rasterize_maps::centre;
use crate::motion::RATE;
use crate::motion::features::{
    FEATURE_DIM, FRAMES_PER_STEP, MIN_FUTURE_FRAMES, POSE_DIM, TRAJECTORY_DIM,
};
use crate::train::locomotion::Locomotion;
use serde_json::{Value, json};

/// The policy of a run of motion matching.
pub fn export(
    run: &TrainedRun,
    locomotion: &Locomotion,
    about: PolicyDescription,
) -> ExportedPolicy {
    let policy = &run.checkpoint.policy;
    let normalisation = &locomotion.matcher.database.normalisation;
    let mut graph = Graph::default();
    let observation = PortDescription::vector(
        "observation",
        "the pose of the frame that is shown, and the target",
        observation_parts(normalisation),
    );
    let vector = graph.input(observation.name, &observation.shape);
    let mut inputs = vec![observation];
    let mut maps = None;
    if let LocomotionTask::Obstacles(obstacles) = &locomotion.task {
        let shape = [MAPS, CELLS, CELLS];
        let meaning = "obstacles around the character, [map][row][column]";
        let port = PortDescription::maps("maps", meaning, shape, maps_description(obstacles));
        maps = Some(graph.input(port.name, &port.shape));
        inputs.push(port);
    }
    let (action, network) = actor(&mut graph, "actor", policy, &vector, maps.as_deref());
    let outputs = vec![
        PortDescription::vector(
            "action",
            "the trajectory that is asked for, as the database's features have it: the second part of a query",
            action_parts(normalisation),
        ),
        PortDescription::vector(
            "trajectory",
            "the same in metres, for a search of another kind",
            trajectory_parts(),
        ),
    ];
    let [mean, scale] =
        [&normalisation.mean, &normalisation.scale].map(|numbers| numbers[POSE_DIM..].to_vec());
    let [mean, scale] = [("trajectory.mean", mean), ("trajectory.scale", scale)]
        .map(|(name, numbers)| graph.parameter(name.into(), &[TRAJECTORY_DIM], numbers));
    let unscaled = graph.node("Div", &[&action, &scale]);
    let trajectory = graph.node("Add", &[&unscaled, &mean]);
    for (port, value) in outputs.iter().zip([action, trajectory]) {
        graph.output(port.name, &port.shape, &value);
    }
    let mut description = PolicyDescription {
        conventions: vec![
            "metres, seconds, radians",
            "the world is right-handed with y up; the ground is the plane of x and z at y = 0",
            "inputs and outputs are batches of rows, float32",
            "a number of a part is (quantity - mean) * scale; without `mean` and `scale` it is the quantity",
        ],
        frames: [(
            "character",
            "on the ground below the root: x to the character's left, y up, z forward. With the unit heading (hx, hz) \
             of the character in the world, a ground vector (x, z) of the world is (hz x - hx z, hx x + hz z) in it, \
             and a vector (l, f) of it is (hz l + hx f, hz f - hx l) in the world",
        )]
        .into(),
        inputs,
        outputs,
        procedure: procedure(&locomotion.task),
        networks: vec![network],
        ..about
    };
    description.add("matching", matching());
    description.add("episode", episode(&locomotion.task));
    ExportedPolicy { graph, description }
}

/// What a program does with the database by a policy's action.
fn matching() -> Value {
    json!({
        "frame_rate": RATE,
        "frames_per_step": FRAMES_PER_STEP,
        "features": FEATURE_DIM,
        "pose_columns": [0, POSE_DIM],
        "trajectory_columns": [POSE_DIM, FEATURE_DIM],
        "frames_behind_a_candidate": MIN_FUTURE_FRAMES,
        "distance": "squared Euclidean, of normalised features",
    })
}

fn episode(task: &LocomotionTask) -> Value {
    json!({
        "success_radius_m": task.success_radius(),
        "target_extent_m": task.target_extent(LEVELS - 1),
        "max_steps": task.max_steps(),
    })
}

fn procedure(task: &LocomotionTask) -> Vec<String> {
    let mut steps = vec![
        "The state of a character is a frame of the database, a position on the ground and a heading, a unit vector. It \
         begins at a candidate: a frame with at least `matching.frames_behind_a_candidate` frames behind it in its clip."
            .to_string(),
        format!(
            "At every step, of {FRAMES_PER_STEP} frames, write the observation: of the frame's normalised features in \
             the database the columns `matching.pose_columns`, then the target in the character frame, scaled. Targets \
             were drawn within `episode.target_extent_m` of the start along each axis."
        ),
        "Evaluate. The query is the same pose columns, then `action`.".to_string(),
        "Find the candidate whose normalised features are nearest to the query; of equal ones the first.".to_string(),
        format!(
            "Play the {FRAMES_PER_STEP} frames behind it: the last of them is the frame that is shown then. The \
             character moves and turns on the ground as the database's path does from the candidate to that frame, \
             taken in the candidate's character frame and applied in the character's own."
        ),
        "The target is reached within `episode.success_radius_m`.".to_string(),
    ];
    if task.has_maps() {
        steps.insert(
            2,
            "Write the maps, as the input's `maps` says, of the obstacles as they are then.".into(),
        );
    }
    steps
}

fn maps_description(obstacles: &Obstacles) -> Value {
    let centres: Vec<f32> = (0..CELLS).map(centre).collect();
    let edge = obstacles.map_edge_width;
    let value = match edge > 0.0 {
        true => format!(
            "floor({FULL} clamp(0.5 + depth / {edge}, 0, 1) + 0.5) / {FULL}, where depth is how far the cell's centre \
             lies inside an obstacle, an axis-aligned box of the world: the least of half its side less the distance of \
             the centres, along x and along z, m, negative outside; of the deepest obstacle"
        ),
        false => "1 if the cell's centre lies in an obstacle or on its border, else 0".to_string(),
    };
    let (age, before) = match obstacles.map_history_s > 0.0 {
        true => (
            Some(obstacles.map_history_s),
            format!(
                "obstacles where they were {} s ago, seen from where the character is now",
                obstacles.map_history_s
            ),
        ),
        false => (
            None,
            "the first map of the step before, as it was seen then; at the first step that of now"
                .to_string(),
        ),
    };
    json!({
        "frame": "character",
        "layout": "[map][row][column]",
        "cell_m": CELL,
        "row_centres_m": centres,
        "rows": "z of a row's centres: from behind to ahead",
        "column_centres_m": centres,
        "columns": "x of a column's centres: from right to left",
        "channels": [
            { "name": "now", "age_s": 0.0, "meaning": "obstacles where they are" },
            { "name": "before", "age_s": age, "meaning": before },
        ],
        "value": value,
    })
}
