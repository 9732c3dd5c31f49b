//! Rewards, measures and end of a step of the task `box`, for both fighters. Shader:
//! `shaders/humanoid/boxing_reward.wgsl`.

use super::approach::approach;
use super::boxing_state::{
    CLINCH_STEPS, DAMAGE, DOWN, KNOCKDOWNS, SQUARED_ACCELERATION, STAGGER_STEPS,
};
use super::boxing_terms as terms;
use super::fallen::{FallRules, has_fallen};
use super::fighters::{FIGHTERS, FighterBodies, Fighters};
use crate::gpu::{Buffer, Gpu, groups, shader};
use crate::kernels::physics::collision::poses_of;
use crate::kernels::physics::proprioception::unit;
use crate::kernels::physics::smooth_dynamics::spatial;
use crate::kernels::physics::strided::{gather, scatter};
use crate::kernels::termination::{FAILED, LEADS, RUNNING, SUCCESS, TRUNCATED};
use crate::physics::spatial::Spatial;
use glam::{Vec2, Vec3};

crate::shader_params! {
    pub struct Params for boxing_reward {
        /// Environments of the batch.
        pub envs: u32,
        /// Index of the step's first reward.
        pub at: u32,
        /// Index of the velocities in what `smooth_dynamics` leaves.
        pub velocities_at: u32,
        /// Bodies of a fighter.
        pub bodies: u32,
        /// Index of the first fighter's head.
        pub head: u32,
        /// Index of the first fighter's pelvis.
        pub pelvis: u32,
        /// Index of the first fighter's torso.
        pub torso: u32,
        /// Index of the first fighter's right hand.
        pub right_hand: u32,
        /// Index of the first fighter's left hand.
        pub left_hand: u32,
        /// Index of the first fighter's right foot.
        pub right_foot: u32,
        /// Index of the first fighter's left foot.
        pub left_foot: u32,
        /// How far the torso's centre is up its z axis, m.
        pub torso_up: f32,
        /// How far the head's centre is up its z axis, m.
        pub head_up: f32,
        /// Height of the head below which a fighter has fallen, m.
        pub min_head: f32,
        /// Height of the pelvis below which a fighter has fallen, m.
        pub min_pelvis: f32,
        /// Height of any body but the feet below which a fighter has fallen, m.
        pub min_body: f32,
        /// 1 if a fall ends the bout.
        pub fall_ends: u32,
        /// 1 if facing is rewarded, and required for the reward of an opponent that is about to fall.
        pub facing: u32,
        /// 1 if the way to a far opponent is rewarded by a sum with a slope everywhere.
        pub additive: u32,
        /// Steps after a blow in which a fall is a knock-down; 0 if every fall is one.
        pub stagger_steps: u32,
        /// Force of the hands above which a touch is a blow, N.
        pub blow_force: f32,
        /// Steps within `clinch` after which fighters are in one.
        pub clinch_steps: u32,
        /// Distance of a clinch, m.
        pub clinch: f32,
        /// Half the width of the arena, m.
        pub arena: f32,
        /// Distance below which fighters are near, m.
        pub near: f32,
        /// Wanted speed toward an opponent that is far, m/s.
        pub speed: f32,
        /// Length of a step, s.
        pub dt: f32,
        /// Factor of the forces in the reward.
        pub damage_scale: f32,
        /// Weight of the forces taken against those given.
        pub damage_taken: f32,
        /// Weight of what is neither damage nor penalty nor a knock-down.
        pub dense: f32,
        /// Reward of a step that knocks the opponent down.
        pub knockdown_bonus: f32,
        /// Weight of the reward for an opponent that is far.
        pub far_weight: f32,
        /// Weight of the damage in table 3.
        pub damage_weight: f32,
        /// Weight of being close in table 3.
        pub close_weight: f32,
        /// Weight of facing each other in table 3.
        pub facing_weight: f32,
        /// Weight of the opponent's fall in table 3.
        pub fall_weight: f32,
        /// Weight of the energy in table 3.
        pub energy_weight: f32,
        /// Weight of the penalties in table 3.
        pub penalty_weight: f32,
    }
}

/// What is measured of a step for a fighter: the impulse of its hands on the opponent's torso and head, N s; that
/// part of it done from behind; 1 for a knock-down; for being out of the arena; for being near; for the beginning of
/// a clinch.
pub const MEASURES: usize = 6;
/// Pairs of a hand and what it is to hit whose forces are wanted, of each fighter.
pub const PAIRS: usize = 4;

/// Queues the shader on `gpu`.
///
/// Rows are fighters, those of an environment side by side. `poses` is `[bodies * 7][envs]`, `dynamics` as
/// `smooth_dynamics` leaves it, both of the state after the step; `forces` `[(bodies + 2 * PAIRS) * 3][envs]`: on
/// bodies, then of each fighter's right and left hand on the other's torso and head. `task_state` is
/// `[state_dim][envs]`, see [`state_dim`](super::boxing_state::state_dim); `reward` and `group` take `[rows]` from
/// `params.at` on, `measures` `[MEASURES][rows]`, `task_end` `[rows]`.
pub fn launch(
    gpu: &Gpu,
    poses: &Buffer<f32>,
    dynamics: &Buffer<f32>,
    forces: &Buffer<f32>,
    task_state: &Buffer<f32>,
    reward: &Buffer<f32>,
    measures: &Buffer<f32>,
    task_end: &Buffer<u32>,
    group: &Buffer<u32>,
    params: &Params,
) {
    gpu.launch(
        &shader::BOXING_REWARD,
        groups(&shader::BOXING_REWARD, params.envs as usize),
        &[
            poses, dynamics, forces, task_state, reward, measures, task_end, group,
        ],
        params,
    );
}

/// The shader's computation on the host.
pub fn twin(
    poses: &[f32],
    dynamics: &[f32],
    forces: &[f32],
    task_state: &mut [f32],
    reward: &mut [f32],
    measures: &mut [f32],
    task_end: &mut [u32],
    group: &mut [u32],
    params: &Params,
) {
    let envs = params.envs as usize;
    let (rows, bodies) = (FIGHTERS * envs, FIGHTERS * params.bodies as usize);
    let mut velocities = vec![0.0; 6 * bodies];
    let mut touching = vec![0.0; 3 * FIGHTERS * PAIRS];
    let mut state = vec![0.0; task_state.len() / envs];
    for env in 0..envs {
        let velocities_at = params.velocities_at as usize;
        gather(dynamics, envs, env, velocities_at, &mut velocities);
        gather(forces, envs, env, 3 * bodies, &mut touching);
        gather(task_state, envs, env, 0, &mut state);
        let velocities: Vec<Spatial> = velocities.chunks_exact(6).map(spatial).collect();
        let touching: Vec<Vec3> = touching.chunks_exact(3).map(Vec3::from_slice).collect();
        let fighters = Fighters {
            bodies: params.fighter_bodies(),
            poses: &poses_of(poses, envs, env),
            velocities: &velocities,
        };
        let mut measured = [0.0; FIGHTERS * MEASURES];
        let steps = step(&fighters, &touching, &mut state, &mut measured, params);
        scatter(task_state, envs, env, 0, &state);
        for (me, step) in steps.iter().enumerate() {
            let row = FIGHTERS * env + me;
            scatter(
                measures,
                rows,
                row,
                0,
                &measured[me * MEASURES..][..MEASURES],
            );
            reward[params.at as usize + row] = step.reward;
            group[params.at as usize + row] = step.group;
            task_end[row] = step.end;
        }
    }
}

/// What a step comes to for a fighter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FighterStep {
    /// Its reward.
    pub reward: f32,
    /// How it ends: [`FAILED`] for who has fallen or left the arena; for who remains [`SUCCESS`] by a knock-down, and
    /// else [`TRUNCATED`]; [`LEADS`] added for who would win if the bout ended now: who remains alone, or has knocked
    /// the other down more often, or, that being equal, done more damage.
    pub end: u32,
    /// 0 if the opponent is far, 1 if it is near.
    pub group: u32,
}

/// How fighters are placed to each other, and what happened to them in a step. Two numbers are those of the two.
struct Exchange<'a> {
    fighters: &'a Fighters<'a>,
    params: &'a Params,
    /// Over the ground, m.
    distance: f32,
    /// To the other, unit vectors on the ground.
    toward: [Vec2; FIGHTERS],
    /// Cosines between headings and directions to the other.
    ahead: [f32; FIGHTERS],
    mutual: bool,
    alignment: f32,
    fallen: [bool; FIGHTERS],
    out: [bool; FIGHTERS],
    /// Forces of the hands on the other's torso and head, N.
    given: [f32; FIGHTERS],
    /// Steps that are left in which a fall of the other is this one's doing.
    stagger: [f32; FIGHTERS],
    /// A fall together is nobody's knock-down, and a fall long after the last blow is the own fault of who falls.
    knocks_down: [bool; FIGHTERS],
}

/// What a step comes to for both fighters, `touching` being the forces of hands, `[2 * PAIRS]`, N. `measures` takes
/// `[fighters][MEASURES]`.
pub fn step(
    fighters: &Fighters,
    touching: &[Vec3],
    state: &mut [f32],
    measures: &mut [f32],
    params: &Params,
) -> [FighterStep; FIGHTERS] {
    let exchange = Exchange::new(fighters, touching, state, params);
    let near = exchange.distance < params.near;
    let in_clinch = exchange.distance < params.clinch;
    state[CLINCH_STEPS] = if in_clinch {
        state[CLINCH_STEPS] + 1.0
    } else {
        0.0
    };
    let clinches = state[CLINCH_STEPS] == params.clinch_steps as f32;
    let rewards = [0, 1].map(|me| match (exchange.knocks_down[me], near) {
        (true, _) => params.knockdown_bonus,
        (false, true) => exchange.near_reward(me, state[SQUARED_ACCELERATION + me]),
        (false, false) => exchange.far_reward(me),
    });
    for (me, measures) in measures.chunks_exact_mut(MEASURES).enumerate() {
        measures.copy_from_slice(&exchange.measures(me, clinches));
        state[DAMAGE + me] += params.dt * exchange.given[me];
        state[KNOCKDOWNS + me] += is(exchange.knocks_down[me]);
        state[DOWN + me] = is(exchange.fallen[me]);
        state[STAGGER_STEPS + me] = exchange.stagger[me];
    }
    [0, 1].map(|me| {
        let wins = exchange.outlasts(me) || has_lead(me, state);
        FighterStep {
            reward: rewards[me],
            end: exchange.end(me) + if wins { LEADS } else { 0 },
            group: u32::from(near),
        }
    })
}

impl<'a> Exchange<'a> {
    fn new(
        fighters: &'a Fighters<'a>,
        touching: &[Vec3],
        state: &[f32],
        params: &'a Params,
    ) -> Exchange<'a> {
        let roots = [0, 1].map(|me| fighters.poses[fighters.root(me)].position.truncate());
        let (gap, headings) = (roots[1] - roots[0], [0, 1].map(|me| fighters.heading(me)));
        let toward = [unit(gap), -unit(gap)];
        let ahead = [0, 1].map(|me| headings[me].dot(toward[me]));
        let rules = params.fall_rules();
        let fallen = [0, 1].map(|me| has_fallen(&fighters.poses[fighters.root(me)..], &rules));
        let stood = |me: usize| state[DOWN + me] == 0.0;
        let given = [0, 1].map(|me| {
            let pairs = touching[me * PAIRS..][..PAIRS].iter();
            pairs.map(|force| force.length()).sum()
        });
        let stagger = [0, 1].map(|me| match given[me] > params.blow_force {
            true => params.stagger_steps as f32,
            false => (state[STAGGER_STEPS + me] - 1.0).max(0.0),
        });
        let caused = |me: usize| params.stagger_steps == 0 || stagger[me] > 0.0;
        Exchange {
            distance: gap.length(),
            mutual: terms::face_each_other(ahead[0], ahead[1]),
            alignment: -headings[0].dot(headings[1]),
            out: roots.map(|root| root.abs().max_element() > params.arena),
            knocks_down: [0, 1]
                .map(|me| fallen[1 - me] && stood(1 - me) && !fallen[me] && caused(me)),
            given,
            stagger,
            fighters,
            params,
            toward,
            ahead,
            fallen,
        }
    }

    fn far_reward(&self, me: usize) -> f32 {
        let velocity = self.fighters.velocities[self.fighters.root(me)].linear;
        let along = self.toward[me].dot(velocity.truncate());
        let (params, ahead, distance) = (self.params, self.ahead[me], self.distance);
        let faces = |facing: f32| if params.facing == 1 { facing } else { 0.0 };
        let far = match params.additive {
            1 => approach(along, faces(0.5 * (1.0 + ahead)), distance),
            _ => {
                let velocity = terms::velocity(along, params.speed);
                let facing = faces(terms::facing_from_afar(ahead));
                terms::far(terms::position(distance), velocity, facing)
            }
        };
        params.dense * params.far_weight * far
    }

    /// Table 3's sum for a fighter with such a sum of squared joint accelerations.
    fn near_reward(&self, me: usize, squared_acceleration: f32) -> f32 {
        let (params, other) = (self.params, 1 - me);
        let root = self.fighters.poses[self.fighters.root(other)];
        let up = (root.rotation * Vec3::Z).z;
        let facing = match params.facing {
            1 => terms::facing(self.alignment, self.mutual),
            _ => 0.0,
        };
        let fall = match self.mutual || params.facing == 0 {
            true => terms::fall(up),
            false => 0.0,
        };
        let dense = params.close_weight * self.close(me)
            + params.facing_weight * facing
            + params.fall_weight * fall
            - params.energy_weight * terms::energy(self.distance, squared_acceleration);
        let damage = terms::damage(self.given[me], self.given[other], params.damage_taken);
        params.damage_weight * params.damage_scale * damage + params.dense * dense
            - params.penalty_weight * terms::penalty(self.fallen[me], self.out[me])
    }

    /// The reward of the hand that does best.
    fn close(&self, me: usize) -> f32 {
        let of_hand = |hand: usize| {
            let own = self.fighters.hand(me, hand);
            let targets = [0, 1].map(|part| self.fighters.target(1 - me, part).position);
            let [torso, head] = targets.map(|target| target - own.position);
            let nearer = torso.length_squared() < head.length_squared();
            let apart = if nearer { torso } else { head };
            terms::close(apart, self.toward[me].dot(own.velocity.truncate()))
        };
        of_hand(0).max(of_hand(1))
    }

    /// Whether a fighter has lost by falling or by leaving the arena.
    fn is_over(&self, fighter: usize) -> bool {
        (self.fallen[fighter] && self.params.fall_ends == 1) || self.out[fighter]
    }

    /// Whether only the other has fallen or left the arena.
    fn outlasts(&self, me: usize) -> bool {
        self.is_over(1 - me) && !self.is_over(me)
    }

    fn end(&self, me: usize) -> u32 {
        match (self.is_over(me), self.is_over(1 - me)) {
            (true, _) => FAILED,
            (false, true) if self.knocks_down[me] => SUCCESS,
            (false, true) => TRUNCATED,
            (false, false) => RUNNING,
        }
    }

    fn measures(&self, me: usize, clinches: bool) -> [f32; MEASURES] {
        let impulse = self.params.dt * self.given[me];
        let from_behind = self.ahead[1 - me] < 0.0;
        [
            impulse,
            if from_behind { impulse } else { 0.0 },
            is(self.knocks_down[me]),
            is(self.out[me]),
            is(self.distance < self.params.near),
            is(clinches),
        ]
    }
}

fn has_lead(me: usize, state: &[f32]) -> bool {
    let both = |field: usize| [state[field], state[field + 1]];
    leads(me, both(KNOCKDOWNS), both(DAMAGE))
}

/// Whether a fighter would win if time were up now, after so many knock-downs by each and so much damage.
pub fn leads(me: usize, knockdowns: [f32; FIGHTERS], damage: [f32; FIGHTERS]) -> bool {
    let lead = |of: [f32; FIGHTERS]| of[me] - of[1 - me];
    lead(knockdowns) > 0.0 || (lead(knockdowns) == 0.0 && lead(damage) > 0.0)
}

fn is(fact: bool) -> f32 {
    f32::from(u8::from(fact))
}

impl Params {
    /// Which body of a fighter is which.
    pub fn fighter_bodies(&self) -> FighterBodies {
        FighterBodies {
            count: self.bodies,
            hands: [self.right_hand, self.left_hand],
            targets: [self.torso, self.head],
            up: [self.torso_up, self.head_up],
        }
    }

    fn fall_rules(&self) -> FallRules {
        FallRules {
            bodies: self.bodies,
            head: self.head,
            pelvis: self.pelvis,
            feet: [self.right_foot, self.left_foot],
            min_head: self.min_head,
            min_pelvis: self.min_pelvis,
            min_body: self.min_body,
        }
    }
}
