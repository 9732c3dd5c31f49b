// What a world counts: counters[tally * envs + env].

const CONTACTS = 0u;      // of all steps
const PEAK_CONTACTS = 1u; // of one step
const OVERFLOW = 2u;      // contacts that found no room
const DIVERGED = 3u;        // times that it lost all sense and was started anew
const COUNTERS = 4u;
