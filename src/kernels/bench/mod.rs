//! What a device could do at most: [`bandwidth`] and [`arithmetic`].

pub mod arithmetic;
pub mod bandwidth;
