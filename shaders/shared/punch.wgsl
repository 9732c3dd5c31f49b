// What a world of the tasks `punch` and `joystick` carries (src/kernels/humanoid/punch_state.rs).

const FACING = 0u;       // 2: the wanted facing, a unit vector on the ground
const MOVING = 2u;       // 2: the wanted direction of moving
const HIT_STEPS = 4u;    // steps since the target was hit; 0 before
const FIRST = 5u;        // 1 + the body that touched the target first; 0 before
const FIRST_SPEED = 6u;  // of the faster hand then, m/s
const HAND_SPEED = 7u;   // of the faster hand after the last step, m/s
const PUNCH_STATE = 8u;
