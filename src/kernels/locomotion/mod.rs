//! A step of the motion-matching environments, in order: [`observe`] writes what the policy sees,
//! [`hits`] counts the requested positions that lie in obstacles, [`build_query`] completes the query,
//! the search finds the nearest candidate, [`obstacle_collision`] tests the root's path,
//! [`move_obstacles`] advances the obstacles, [`advance_and_reward`] plays the match and rewards it,
//! [`rasterize_maps`] draws the obstacle maps. Where an episode ended, [`spawn_obstacles`] and
//! [`mod@reset`] start another; [`episode_stats`] sums up the finished ones.

pub mod advance_and_reward;
pub mod build_query;
pub mod episode_stats;
pub mod hits;
pub mod locomotion_layout;
pub mod move_obstacles;
pub mod observe;
pub mod obstacle_collision;
pub mod obstacles;
pub mod rasterize_maps;
pub mod reset;
pub mod spawn_obstacles;
