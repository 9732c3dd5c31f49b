// How a step ends for an agent (src/kernels/termination.rs).

const RUNNING = 0u;
const SUCCESS = 1u;   // the task is done
const TRUNCATED = 2u; // out of steps
const FAILED = 3u;    // a collision, a fall
const LEADS = 4u;     // added to it for an agent whose episode would be won if it ended now
