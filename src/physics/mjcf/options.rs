//! How a file is to be read where programs differ.

/// How a file is to be read where programs differ.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct MjcfOptions {
    /// A motor is a drive to a position, as Isaac Gym reads it: the stiffness and damping of its joint are
    /// its gains, its gear the largest torque. To MuJoCo it is a torque, and they are a passive spring.
    pub pd_motors: bool,
}
