//! The roofline: what a device can do at most.

/// Bytes and operations that an item costs at least; 0 where that is no fixed number.
#[derive(Clone, Copy, Default)]
pub struct ItemCost {
    /// Bytes read and written.
    pub bytes: f64,
    /// Multiplications and additions.
    pub operations: f64,
}

/// Peak rates of a device.
pub struct Roofline {
    pub bytes_per_s: f64,
    pub operations_per_s: f64,
}

impl Roofline {
    /// The fraction of what memory or arithmetic allow, whichever is nearer; none if an item has no fixed
    /// cost.
    pub fn fraction(&self, cost: ItemCost, per_s: f64) -> Option<f64> {
        let bytes = cost.bytes * per_s / self.bytes_per_s;
        let operations = cost.operations * per_s / self.operations_per_s;
        Some(bytes.max(operations)).filter(|&fraction| fraction > 0.0)
    }
}
