//! What files carry of a policy.

use super::description::PolicyDescription;
use super::graph::Graph;

/// A policy as files carry it.
pub struct ExportedPolicy {
    /// What it computes: the mean of its actions, without exploration.
    pub graph: Graph,
    /// All that must be known to run it.
    pub description: PolicyDescription,
}
