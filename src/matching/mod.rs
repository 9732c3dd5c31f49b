//! Motion matching: the exact search for the database frame nearest to a query.
//!
//! On the CPU all cores share the queries, sixteen rows are compared at a time, and most rows are left
//! unread because a lower bound says that they cannot be nearest ([`search`]). The bound of a leaf is
//! the least distance of its poses to the query's, which is known beforehand ([`pose_distance_table`]),
//! and the distance of the query's trajectory to the box around the leaf's along the principal axes
//! ([`pca`], [`tree`], [`quantised_boxes`]). Bounds are widened by more than rounding can do, and
//! distances are those of [`crate::kernels::search::search_exact::squared`]: the result is, bit for
//! bit, that of [`crate::kernels::search::search_exact::twin`], the lowest index of equals included.
//!
//! ```
//! use footwork::matching::MotionMatcher;
//! use footwork::motion::{database::Database, normalise::Weights, synthetic};
//! use std::sync::Arc;
//!
//! let (clips, roles) = synthetic::perform(1, 0.5);
//! let database = Database::build(&clips, roles, Weights::PAPER)?;
//! let matcher = MotionMatcher::new(Arc::new(database));
//!
//! // The features of a candidate are nearest to themselves.
//! let frame = matcher.database.candidates[40];
//! let mut query = matcher.database.features[frame as usize];
//! query[27] = 1.0; // the last number of a query's row
//! let nearest = matcher.nearest(frame, &query);
//! assert_eq!((nearest.index, nearest.distance), (40, 0.0));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

pub mod gpu;
mod index;
mod motion_matcher;
mod pca;
mod pose_distance_table;
mod quantised_boxes;
mod search;
mod tree;

pub use index::{DEFAULT_TABLE_BYTES, Index};
pub use motion_matcher::MotionMatcher;
pub use search::{Nearest, SearchScratch};
