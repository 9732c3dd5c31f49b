//! What the build script found out about every shader under `shaders/`.

/// One validated compute shader.
#[derive(Debug)]
pub struct Shader {
    /// File stem and entry point.
    pub name: &'static str,
    /// WGSL, imports included.
    pub source: &'static str,
    /// Invocations of a workgroup along x, y and z.
    pub workgroup: [u32; 3],
    /// Storage buffers: bindings `0..buffers` of group 0. The uniform, if any, follows them.
    pub buffers: u32,
    /// Bytes of the uniform; 0 if there is none.
    pub params: usize,
}

/// Workgroups needed for `items` invocations along x.
pub fn groups(shader: &Shader, items: usize) -> [u32; 3] {
    [(items as u32).div_ceil(shader.workgroup[0]), 1, 1]
}

/// Type of a parameter.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ParamKind {
    /// `u32`
    U32,
    /// `i32`
    I32,
    /// `f32`
    F32,
}

/// Place and type of one parameter in the uniform.
#[derive(Clone, Copy, Debug)]
pub struct Field {
    /// Offset in the uniform, bytes.
    pub offset: usize,
    /// Type of the number.
    pub kind: ParamKind,
}

/// A Rust type that may stand in a parameter struct.
pub trait Scalar {
    /// The type in WGSL.
    const KIND: ParamKind;
}

impl Scalar for u32 {
    const KIND: ParamKind = ParamKind::U32;
}
impl Scalar for i32 {
    const KIND: ParamKind = ParamKind::I32;
}
impl Scalar for f32 {
    const KIND: ParamKind = ParamKind::F32;
}

/// Compares at compile time.
pub const fn same_kind(a: ParamKind, b: ParamKind) -> bool {
    a as u8 == b as u8
}

/// Declares a kernel's parameter struct and checks it, at compile time, against the uniform of
/// the shader of that name: same fields, same order, same types, same size.
#[macro_export]
macro_rules! shader_params {
    ($(#[$meta:meta])* pub struct $name:ident for $shader:ident { $($(#[$doc:meta])* pub $field:ident: $kind:ty,)* }) => {
        #[doc = concat!("Parameters of the shader `", stringify!($shader), "`.\n\n")]
        $(#[$meta])*
        #[repr(C)]
        #[derive(Clone, Copy, Debug, bytemuck::Pod, bytemuck::Zeroable)]
        pub struct $name { $($(#[$doc])* pub $field: $kind,)* }

        const _: () = {
            use $crate::gpu::shader::{self, Scalar, $shader::params};
            $(
                assert!(
                    params::$field().offset == std::mem::offset_of!($name, $field)
                        && shader::same_kind(params::$field().kind, <$kind as Scalar>::KIND),
                    concat!("parameter `", stringify!($field), "` differs from the shader's"),
                );
            )*
            assert!(params::SIZE == std::mem::size_of::<$name>(), "sizes differ");
            assert!(params::FIELDS == [$(stringify!($field)),*].len(), "field counts differ");
        };
    };
}

pub use generated::*;

/// What the build script wrote: a [`Shader`] and the layout of its parameters for each file.
#[allow(missing_docs)]
mod generated {
    use super::*;
    include!(concat!(env!("OUT_DIR"), "/shaders.rs"));
}
