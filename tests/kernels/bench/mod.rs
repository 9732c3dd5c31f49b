//! What measures a device.

mod roofline;
