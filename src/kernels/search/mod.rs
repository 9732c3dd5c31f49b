//! The exact nearest-candidate search: by the index ([`search_seed`], [`search_prune`],
//! [`search_leaves`], [`search_argmin`]) or over all rows ([`search_score_lanes`] or
//! [`search_score_tiled`], then [`search_exact`]).

pub mod search_argmin;
pub mod search_exact;
pub mod search_index;
pub mod search_leaves;
pub mod search_one;
pub mod search_prune;
pub mod search_score_lanes;
pub mod search_score_tiled;
pub mod search_seed;
