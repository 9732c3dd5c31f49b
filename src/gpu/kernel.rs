//! The only launch: a validated WGSL shader on burn's own stream, so that kernels and tensor
//! operations run in program order on one queue without copies or waits.

use super::adapter::Gpu;
use super::buffer::Argument;
use super::shader::Shader;
pub use super::shader::groups;
use bytemuck::Pod;
use cubecl::ir::settings::{Dim3, KernelSettings};
use cubecl::ir::{AddressType, ElemType, Scope, UIntKind, metadata::Info};
use cubecl::prelude::{
    CubeCount, CubeKernel, ExecutionMode, KernelDefinition, KernelId, KernelMetadata,
    PrecompiledSource,
};
use cubecl::server::{KernelArguments, MetadataBindingInfo};

/// A shader in the shape cubecl launches.
struct Text(&'static Shader);

impl Text {
    fn dim(&self) -> Dim3 {
        let [x, y, z] = self.0.workgroup;
        Dim3 { x, y, z }
    }
}

impl KernelMetadata for Text {
    fn name(&self) -> &'static str {
        self.0.name
    }

    // Compiled kernels are cached by this: it covers the text, as cubecl asks.
    fn id(&self) -> KernelId {
        KernelId::new::<Self>()
            .cube_dim(self.dim())
            .info((self.0.name, self.0.source))
    }

    fn address_type(&self) -> ElemType {
        UIntKind::U32.into()
    }
}

impl CubeKernel for Text {
    fn define(&self) -> KernelDefinition {
        let settings = KernelSettings::new(self.dim(), ExecutionMode::Unchecked, AddressType::U32);
        KernelDefinition {
            body: Scope::root(settings.clone()),
            settings,
            info: Info::default(),
        }
    }

    fn source(&self) -> Option<PrecompiledSource> {
        Some(PrecompiledSource {
            source: self.0.source.to_string(),
            entrypoint_name: self.0.name.to_string(),
            lang: "wgsl",
        })
    }
}

impl Gpu {
    /// Queues `shader` over `groups` workgroups. `buffers` are bound in order from 0, `params`
    /// follow as the uniform.
    ///
    /// # Panics
    /// If the number of buffers or the size of the parameters is not the shader's: a mistake
    /// in this program, never in its input.
    pub fn launch<P: Pod>(
        &self,
        shader: &'static Shader,
        groups: [u32; 3],
        buffers: &[&dyn Argument],
        params: &P,
    ) {
        let bytes = bytemuck::bytes_of(params);
        assert_eq!(
            buffers.len(),
            shader.buffers as usize,
            "buffers of `{}`",
            shader.name
        );
        assert_eq!(
            bytes.len(),
            shader.params,
            "parameters of `{}`",
            shader.name
        );
        if groups.contains(&0) {
            return;
        }
        let words = bytes
            .chunks(8)
            .map(|chunk| {
                let mut word = [0; 8];
                word[..chunk.len()].copy_from_slice(chunk);
                u64::from_le_bytes(word)
            })
            .collect();
        let bindings = buffers
            .iter()
            .map(|buffer| buffer.handle().binding())
            .collect();
        let arguments = KernelArguments::new()
            .with_buffers(bindings)
            .with_info(MetadataBindingInfo::custom(words));
        let [x, y, z] = groups;
        self.client.launch(
            Box::new(Text(shader)),
            CubeCount::Static(x, y, z),
            arguments,
        );
    }
}
