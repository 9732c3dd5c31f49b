// The compiled model and its settings in words (src/physics/model_table.rs writes them): a header of section starts and
// counts, then bodies, joints, degrees of freedom, columns of the packed mass matrix, trees, pairs of geoms. Real
// numbers are bit casts. The importing shader binds `model_table`.
//
// Bounds of loops are read from here, not from the uniform: lavapipe compiles a shader anew for every launch
// in which a uniform decides how often a loop runs.

// Degrees of freedom of a world, a multiple of four; Rust refuses more.
const WORLD_DOF_BOUND = 80u;

const NONE = 0xffffffffu;

// Header.
const BODIES_AT = 0u;
const JOINTS_AT = 1u;
const DOFS_AT = 2u;
const COLUMNS_AT = 3u;
const TREES_AT = 4u;
const BODY_COUNT = 5u;
const JOINT_COUNT = 6u;
const DOF_COUNT = 7u;
const NM = 8u;       // entries of the mass matrix
const NQ = 9u;    // of q
const TREE_COUNT = 10u;
const PAIRS_AT = 11u;    // of geoms: their bodies, friction, softness
const MAX_CONTACTS = 12u;        // contacts a world has room for
const ITERATIONS = 13u;       // rounds of projected Gauss-Seidel
const QUADS = 14u;        // fours of degrees of freedom
const GEOM_COUNT = 15u;
const PLANE_CAPSULE = 16u;  // where each family of pairs ends
const PLANE_BOX = 17u;
const CAPSULE_CAPSULE = 18u;
const CAPSULE_BOX = 19u;
const BOX_BOX = 20u;
const HEADER = 21u;

// A body.
const BODY_PARENT = 0u;
const BODY_POSITION = 1u;      // 3
const BODY_ROTATION = 4u;       // 4, x y z w
const BODY_MASS = 8u;
const BODY_COM = 9u;     // 3
const BODY_INERTIA = 12u;   // xx yy zz xy xz yz
const BODY_JOINT = 18u;     // first
const BODY_JOINTS = 19u;    // number
const BODY_DOF = 20u;
const BODY_DOFS = 21u;
const BODY_DOF_MASK = 22u;    // 3: a bit for each degree of freedom that moves it
const BODY = 25u;

// A joint.
const JOINT_KIND = 0u;
const JOINT_Q = 1u;
const JOINT_V = 2u;
const JOINT_POSITION = 3u;     // 3
const JOINT_AXIS = 6u;      // 3
const JOINT_LIMITED = 9u;
const JOINT_RANGE = 10u;    // 2
const JOINT_SOLVER_PARAMS = 12u; // 7
const JOINT = 19u;

const FREE = 0u;
const BALL = 1u;
const HINGE = 2u;

// A degree of freedom.
const DOF_DEPTH = 0u;
const DOF_ROW = 1u;         // of the packed mass matrix
const DOF_END = 2u;         // of that row: the entry of an ancestor stands as far before it as that is deep
const DOF_LAST = 3u;        // one past those that it moves
const DOF_ARMATURE = 4u;
const DOF_TARGET = 5u;      // place among the drives' targets, NONE without a drive
const DOF_STIFFNESS = 6u;
const DOF_DAMPING = 7u;
const DOF_LIMIT = 8u;
const DOF_TORQUE = 9u;      // of a unit of the control
const DOF_CONTROL = 10u;    // 2: least and largest
const DOF_SPRING = 12u;     // 3: stiffness, damping, rest
const DOF_INVWEIGHT0 = 15u;
const DOF_BODY = 16u;
const DOF = 17u;

// A tree.
const TREE_BODY = 0u;       // first
const TREE_BODIES = 1u;     // number
const TREE_DOF = 2u;
const TREE_DOFS = 3u;
const TREE_FREE = 4u;       // 1 if its first joint is free
const TREE = 5u;

// A pair of geoms.
const PAIR_BODIES = 0u;     // 2, NONE for what stands still
const PAIR_FRICTION = 2u;
const PAIR_INVWEIGHT0 = 3u;  // of both bodies
const PAIR_SOLVER_PARAMS = 4u;   // 7
const PAIR_GEOMS = 11u;     // 2
const PAIR = 13u;

// Softness: spring time constant and damping ratio, impedance at depth 0 and at the width, width,
// midpoint, power.

fn real(at: u32) -> f32 { return bitcast<f32>(model_table[at]); }
fn real3(at: u32) -> vec3f { return vec3f(real(at), real(at + 1u), real(at + 2u)); }
fn real4(at: u32) -> vec4f { return vec4f(real3(at), real(at + 3u)); }
