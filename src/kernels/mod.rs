//! One file a shader: its parameters, its launch and its CPU twin, all of one name and one
//! order of arguments. The twin is the shader's oracle and the CPU backend's kernel.
//!
//! A step of the world, in order:
//! [`observe`] what the policy sees, [`act`] draw its action, [`hits`] count what it asks for in
//! obstacles, [`query`] put the question to the database, find the nearest candidate (by the index:
//! [`search_near`], [`search_reach`], [`search_leaves`], [`search_pick`]; among all rows:
//! [`search_wide`] or [`search_tile`], and [`search_exact`]), [`collide`] see what is in its way,
//! [`wander`] move the obstacles, [`mod@step`] play it and reward, [`sense`] map the obstacles; where
//! an episode ended [`scatter`] draws new obstacles and [`reset`] starts another. After a rollout
//! [`gae`] judges the actions and [`tally`] sums up the episodes. [`bandwidth`] and [`arithmetic`] measure
//! what a device could do.
//!
//! A gradient step of networks of dense layers, in order: [`forward`] through the layers, [`mod@loss`] what is wrong
//! with the answers, [`backward`] through the layers, [`mod@gradient`] of the parameters, [`total`] of its pieces, and
//! [`adam`] steps against it. [`network`] says how they lie in memory.
//!
//! A step of the simulated bodies, in order: [`articulate`] poses, masses and what the drives do, [`contact`] find what
//! touches, [`constrain`] say how contacts and joint limits resist, [`solve`] find their forces and move on, [`blows`]
//! sum up who hit whom. Before an action [`explore`] draws random targets; after it [`restart`] begins the worlds anew
//! that ask for it or broke. [`proprioception`] says what a character feels of its body, of the poses and velocities
//! that [`articulate`], launched on the state as it is then, has found.

pub mod act;
pub mod adam;
pub mod arithmetic;
pub mod articulate;
pub mod backward;
pub mod bandwidth;
pub mod blows;
pub mod collide;
pub mod columns;
pub mod constrain;
pub mod contact;
pub mod explore;
pub mod forward;
pub mod gae;
pub mod gradient;
pub mod hits;
pub mod index;
pub mod layout;
pub mod loss;
pub mod network;
pub mod observe;
pub mod obstacles;
pub mod proprioception;
pub mod query;
pub mod reset;
pub mod restart;
pub mod rng;
pub mod scatter;
pub mod search_exact;
pub mod search_leaves;
pub mod search_near;
pub mod search_pick;
pub mod search_reach;
pub mod search_tile;
pub mod search_wide;
pub mod sense;
pub mod solve;
pub mod step;
pub mod tally;
pub mod total;
pub mod wander;
