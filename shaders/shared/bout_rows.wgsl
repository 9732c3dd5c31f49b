// Environment e has the rows 2 e and 2 e + 1, one of them the learner's. Its opponent has a place among the rows of
// policies, or follows a script.

const NOBODY = 0xffffffffu;
const SCRIPTED = 0x80000000u; // added to a script's index, so that it is no place
