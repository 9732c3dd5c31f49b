//! Characters against the environments that their policies were trained in, and against the player.

use super::place::PLACE;
use footwork::env::locomotion::cpu::CpuLocomotion;
use footwork::env::locomotion::{EnvConfig, LEVELS, LocomotionTask, Obstacles};
use footwork::kernels::locomotion::locomotion_layout::{boxes, state_f32, state_u32};
use footwork::motion::features::FRAMES_PER_STEP;
use footwork::runtime::{
    CharacterPolicy, Characters, CharactersError, MovingObstacle, PolicyError,
};
use std::sync::Arc;

/// An environment of one whose character stands where a fresh one does.
fn environment(task: LocomotionTask, target: [f32; 2]) -> CpuLocomotion {
    let matcher = Arc::new(PLACE.motion.matcher.clone());
    let config = EnvConfig {
        task,
        envs: 1,
        seed: 3,
        level: LEVELS - 1,
    };
    let mut env = CpuLocomotion::new(matcher, &config);
    for (field, value) in [
        (state_f32::X, 0.0),
        (state_f32::Z, 0.0),
        (state_f32::HEADING_X, 0.0),
        (state_f32::HEADING_Z, 1.0),
        (state_f32::TARGET_X, target[0]),
        (state_f32::TARGET_Z, target[1]),
    ] {
        env.state_f32[field] = value;
    }
    env.state_u32[state_u32::FRAME] = PLACE.motion.rest as u32;
    if task.has_maps() {
        env.refresh_maps();
    }
    env
}

/// What an environment's obstacles are.
fn obstacles(env: &CpuLocomotion) -> Vec<MovingObstacle> {
    let count = env.params.task.obstacles();
    let of = |slot: usize| {
        let [x, z, half_x, half_z] = env.obstacle(0, slot);
        MovingObstacle {
            centre: [x, z],
            half: [half_x, half_z],
            velocity: [0, 1].map(|axis| env.obstacle_velocity[axis * count + slot]),
        }
    };
    assert_eq!(boxes::FIELDS, 4);
    (0..count).map(of).collect()
}

/// Steps both, decision by decision, and compares what is found and where it leads.
fn compare(mut env: CpuLocomotion, mut characters: Characters, target: [f32; 2], steps: usize) {
    let policy = characters.policy().clone();
    let candidates = &PLACE.motion.database().candidates;
    characters.set_target(0, target);
    for step in 0..steps {
        if env.params.task.has_maps() {
            characters.set_obstacles(0, &obstacles(&env));
        }
        let action = policy.policy.mean(&env.observation());
        env.step_without_reset(&action);
        (0..FRAMES_PER_STEP).for_each(|_| characters.step(0));
        let state = characters.state(0);
        let matched = candidates[env.matched[0] as usize] as usize;
        assert_eq!(state.matched, matched, "step {step}");
        assert_eq!(state.shown.frame, matched + FRAMES_PER_STEP);
        let at = [state_f32::X, state_f32::Z].map(|field| env.field(field, 0));
        let away = (state.shown.at[0] - at[0]).hypot(state.shown.at[1] - at[1]);
        assert!(away < 1e-4, "step {step}: {away} m apart");
    }
}

#[test]
fn on_the_plane_a_character_goes_as_in_training() {
    let target = [3.0, -2.5];
    let characters = PLACE.characters("plane", 1);
    let env = environment(characters.policy().task, target);
    compare(env, characters, target, 60);
}

#[test]
fn among_obstacles_a_character_sees_what_it_saw_in_training() {
    let target = [4.0, 3.0];
    // In the paper's maps the second one is what was seen a step before.
    for (map_history_s, map_edge_width) in [(0.2, 0.375), (0.0, 0.0)] {
        let policy = PLACE.policy("obstacles");
        let LocomotionTask::Obstacles(task) = policy.task else {
            panic!("a policy among obstacles")
        };
        let seen = Obstacles {
            map_history_s,
            map_edge_width,
            ..task
        };
        let policy = CharacterPolicy {
            policy: policy.policy.clone(),
            task: LocomotionTask::Obstacles(seen),
            fingerprint: policy.fingerprint,
        };
        let characters = Characters::new(PLACE.motion.clone(), Arc::new(policy), 1);
        // Walls far away: an arena's bounce obstacles back, those of a game go on.
        let task = LocomotionTask::Obstacles(Obstacles {
            count: 40,
            arena_half_extent: 60.0,
            side_max: 8.0,
            ..seen
        });
        let env = environment(task, target);
        compare(env, characters.unwrap(), target, 40);
    }
}

#[test]
fn characters_decide_in_turn_and_end_at_the_same_place() {
    let mut characters = PLACE.characters("plane", FRAMES_PER_STEP + 1);
    for character in 0..characters.count() {
        characters.place(character, [1.0, 2.0], [1.0, 0.0]);
        characters.set_target(character, [1.0 + character as f32, 5.0]);
        assert_eq!(characters.state(character).shown.at, [1.0, 2.0]);
    }
    let rest = PLACE.motion.rest;
    for frame in 0..FRAMES_PER_STEP {
        characters.step_all();
        for character in 1..FRAMES_PER_STEP {
            let waits = characters.state(character).matched == rest;
            assert_eq!(waits, frame < character, "{character} in {frame}");
        }
    }
    let [first, seventh] = [0, FRAMES_PER_STEP].map(|character| characters.state(character));
    assert_eq!(first.shown.frame, first.matched + FRAMES_PER_STEP);
    assert_eq!(seventh.shown.frame, seventh.matched + FRAMES_PER_STEP);
}

#[test]
fn poses_stand_where_the_state_says() {
    let mut characters = PLACE.characters("plane", 1);
    let skeleton = &PLACE.motion.database().skeleton;
    characters.set_target(0, [-4.0, 4.0]);
    for _ in 0..100 {
        characters.step(0);
        let (state, pose) = (characters.state(0), characters.pose(0));
        let away = (pose.root.x - state.shown.at[0]).hypot(pose.root.z - state.shown.at[1]);
        assert!(away < 0.4, "{away} m from the ground point to the hips");
        let (positions, rotations) = pose.world(skeleton);
        assert_eq!(characters.world(0).positions, positions);
        assert_eq!(characters.world(0).rotations, rotations);
    }
}

#[test]
fn what_does_not_fit_is_refused() {
    let mut other = CharacterPolicy::open(&PLACE.path("plane")).unwrap();
    other.fingerprint ^= 1;
    let refused = Characters::new(PLACE.motion.clone(), Arc::new(other), 1);
    let Err(CharactersError::OtherDatabase { .. }) = refused else {
        panic!("characters of another database")
    };
    let refused = CharacterPolicy::open(&PLACE.path("motion.footwork"));
    let text = refused.err().unwrap().to_string();
    assert!(
        text.contains("is a footwork database, not a checkpoint"),
        "{text}"
    );
    let refused = CharacterPolicy::open(&PLACE.path("nowhere"));
    assert!(matches!(refused, Err(PolicyError::Run(_))));
}
