// What a world of the task `box` carries (src/kernels/humanoid/boxing_state.rs). Two numbers are those of the two
// fighters.

const DAMAGE = 0u;                // 2: impulse of its hands on the other's head and torso in this bout, N s
const KNOCKDOWNS = 2u;            // 2: knock-downs by it in this bout
const DOWN = 4u;                  // 2: 1 if it lay after the last step
const SQUARED_ACCELERATION = 6u;  // 2: squared accelerations of all joints in the last step, rad^2/s^4
const CLINCH_STEPS = 8u;          // for which both have been in a clinch
const STAGGER_STEPS = 9u;         // 2: left in which a fall of the other is its doing
const JOINT_SPEEDS = 11u;         // of one fighter's joints and then the other's after the last step, rad/s

const ROOT_DOFS = 6u;
