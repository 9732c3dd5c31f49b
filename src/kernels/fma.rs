//! Multiplication and addition in one.

/// `a * b + c`, rounded once. WebAssembly has no such instruction, and the function of its libraries takes fifty times
/// as long: there it is rounded twice.
#[inline(always)]
pub fn mul_add(a: f32, b: f32, c: f32) -> f32 {
    match cfg!(target_arch = "wasm32") {
        true => a * b + c,
        false => a.mul_add(b, c),
    }
}
