// Fields of a constraint: constraints[(constraint * CONSTRAINT_DIM + field) * envs + env].

const TARGET = 0u;    // 3: acceleration it asks for along its directions
const REGULARIZATION = 3u;  // regularisation
const FRICTION = 4u;  // of a contact
const ACTIVE = 5u;    // of a limit: 1 if it is past its range
const BLOCK = 6u;     // 6: J M^-1 J^T of its directions, nn nt ns tt ts ss; of a limit the first alone
const CONSTRAINT_DIM = 12u;
