//! A step of the motion-matching environments, kernel by kernel.

mod advance_and_reward;
mod build_query;
mod episode_stats;
mod hits;
mod move_obstacles;
mod observe;
mod obstacle_collision;
mod paper;
mod rasterize_maps;
mod reset;
mod reward;
mod spawn_obstacles;
