// What a world of the task `track` carries (src/kernels/humanoid/track_state.rs).

const ROW = 0u;   // of the references: where the body should be now
const LAST = 1u;  // row of the motion
const TRACK_STATE = 2u;
