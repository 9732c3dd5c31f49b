// Widths and places that Rust checks against its own (src/kernels/layout.rs).

const POSE = 15u;        // pose feature c
const TRAJECTORY = 12u;  // trajectory feature t, the action
const FEATURE = 27u;     // c then t
const QUADS = 7u;        // vec4s of a padded feature row
const OBSERVATION = 17u; // c, then the target in the character frame
const GOAL_SCALE = 0.2;  // the target in the observation: metres times this

// real[field * envs + env]
const X = 0u;         // root on the ground, m
const Z = 1u;
const HEADING_X = 2u; // unit forward direction
const HEADING_Z = 3u;
const TARGET_X = 4u;  // m
const TARGET_Z = 5u;
const RETURN = 6u;    // rewards of the running episode
const TRAVELLED = 7u; // m walked in the running episode
const RETURNS = 8u;   // summed returns of the episodes ended since the last tally
const REALS = 9u;

// whole[field * envs + env]
const FRAME = 0u;     // database frame now shown
const AGE = 1u;       // steps of the running episode
const EPISODES = 2u;  // ended since the last tally
const SUCCESSES = 3u;
const LENGTHS = 4u;   // their steps
const WHOLES = 5u;

// How a step ends.
const RUNNING = 0u;
const REACHED = 1u;   // terminal
const TRUNCATED = 2u; // out of steps: bootstrapped, not terminal
