//! What a policy depends on besides the choices of its run, by checksum.

use serde::{Deserialize, Serialize};

/// Checksums of what a policy was trained with: it is of no use with anything else.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Fingerprint {
    /// Checksum of the data; 0 if there is none.
    #[serde(rename = "fingerprint")]
    pub data: u32,
    /// Checksum of the low level that it steers; 0 if it steers none.
    #[serde(rename = "low_level_fingerprint")]
    pub low_level: u32,
}

/// A policy that steers no low level depends on data alone.
impl From<u32> for Fingerprint {
    fn from(data: u32) -> Self {
        Fingerprint { data, low_level: 0 }
    }
}
