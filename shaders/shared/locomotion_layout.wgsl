// Widths and places that Rust checks against its own (src/kernels/locomotion/locomotion_layout.rs).

#import termination

const POSE_DIM = 15u;        // pose feature c
const TRAJECTORY_DIM = 12u;  // trajectory feature t, the action
const FEATURE_DIM = 27u;     // c then t
const QUADS = 7u;        // vec4s of a padded feature row
const BASE_OBS_DIM = 17u;        // c, then the target in the character frame: what every task observes
const CELLS = 16u;       // an obstacle map is CELLS x CELLS cells
const MAPS = 2u;         // now, and before
const ROW = 4u;          // words of a row of a map, four cells each
const TARGET_SCALE = 0.2;  // the target in the observation: metres times this

// state_f32[field * envs + env]
const X = 0u;         // root on the ground, m
const Z = 1u;
const HEADING_X = 2u; // unit forward direction
const HEADING_Z = 3u;
const TARGET_X = 4u;  // m
const TARGET_Z = 5u;
const RETURN = 6u;    // rewards of the running episode
const TRAVELLED = 7u; // m walked in the running episode
const RETURNS = 8u;   // summed returns of the episodes ended since the last tally
const STATE_F32_FIELDS = 9u;

// state_u32[field * envs + env]
const FRAME = 0u;     // database frame now shown
const EPISODE_STEP = 1u;       // steps of the running episode
const EPISODE_LIMIT = 2u;     // steps after which the running episode is truncated
const HITS = 3u;      // asked-for positions of this step that lie in an obstacle
const HAS_COLLIDED = 4u;    // 1 if this step ran into an obstacle
const EPISODES = 5u;  // ended since the last tally, and how
const SUCCESSES = 6u;
const COLLISIONS = 7u;
const TRUNCATIONS = 8u;
const LENGTHS = 9u;   // their steps
const STATE_U32_FIELDS = 10u;

// boxes[(env * BOX + field) * count + slot], the obstacles' axis-aligned boxes
const BOX_X = 0u;     // centre, m
const BOX_Z = 1u;
const HALF_X = 2u;    // half sides, m
const HALF_Z = 3u;
const BOX = 4u;
// drift[(env * VELOCITY_DIM + axis) * count + slot], their velocities, m/s
const VELOCITY_DIM = 2u;
