// What a world counts: tallies[tally * envs + env].

const CONTACTS = 0u;      // of all steps
const MOST_CONTACTS = 1u; // of one step
const OVERFLOW = 2u;      // contacts that found no room
const BROKEN = 3u;        // times that it lost all sense and was started anew
const TALLIES = 4u;
