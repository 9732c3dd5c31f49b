//! The search: whole, and kernel by kernel.

mod search_by_index;
mod search_exact;
mod search_one;
mod search_score_lanes;
mod search_score_tiled;
mod whole_search;
