//! A glTF document under construction, and the file of it: chunks of JSON and of plain numbers.

use anyhow::Result;
use bytemuck::Pod;
use gltf_json::accessor::{Accessor, ComponentType, GenericComponentType, Type};
use gltf_json::buffer::{Buffer, Target, View};
use gltf_json::validation::Checked::Valid;
use gltf_json::validation::USize64;
use gltf_json::{Asset, Index, Root};

/// What accessors hold.
pub trait AccessorElement: Pod {
    const COMPONENT: ComponentType;
    const TYPE: Type;
}

macro_rules! elements {
    ($($element:ty: $component:ident $kind:ident;)*) => {
        $(impl AccessorElement for $element {
            const COMPONENT: ComponentType = ComponentType::$component;
            const TYPE: Type = Type::$kind;
        })*
    };
}

elements! {
    f32: F32 Scalar;
    [f32; 3]: F32 Vec3;
    [f32; 4]: F32 Vec4;
    [f32; 16]: F32 Mat4;
    [u16; 4]: U16 Vec4;
    u32: U32 Scalar;
}

/// A document and its one buffer.
pub struct Document {
    pub root: Root,
    bytes: Vec<u8>,
}

impl Document {
    pub fn new() -> Document {
        let asset = Asset {
            generator: Some(concat!("footwork ", env!("CARGO_PKG_VERSION")).to_string()),
            ..Asset::default()
        };
        Document {
            root: Root {
                asset,
                ..Root::default()
            },
            bytes: Vec::new(),
        }
    }

    /// Adds elements; `target` says what a mesh uses them for.
    pub fn accessor<T: AccessorElement>(
        &mut self,
        elements: &[T],
        target: Option<Target>,
    ) -> Index<Accessor> {
        let bytes: &[u8] = bytemuck::cast_slice(elements);
        let view = View {
            buffer: Index::new(0),
            byte_length: USize64::from(bytes.len()),
            byte_offset: Some(USize64::from(self.bytes.len())),
            byte_stride: None,
            name: None,
            target: target.map(Valid),
            extensions: None,
            extras: Default::default(),
        };
        // All of them are whole words.
        self.bytes.extend_from_slice(bytes);
        let buffer_view = Some(self.root.push(view));
        self.root.push(Accessor {
            buffer_view,
            byte_offset: None,
            count: USize64::from(elements.len()),
            component_type: Valid(GenericComponentType(T::COMPONENT)),
            type_: Valid(T::TYPE),
            min: None,
            max: None,
            name: None,
            normalized: false,
            sparse: None,
            extensions: None,
            extras: Default::default(),
        })
    }

    /// Adds elements of real numbers with the bounds of each.
    pub fn bounded<T: AccessorElement>(
        &mut self,
        elements: &[T],
        target: Option<Target>,
    ) -> Index<Accessor> {
        let numbers: &[f32] = bytemuck::cast_slice(elements);
        let width = size_of::<T>() / size_of::<f32>();
        let bound = |pick: fn(f32, f32) -> f32| {
            let column = |at: usize| numbers[at..].iter().step_by(width);
            let bounds = (0..width).map(|at| column(at).copied().reduce(pick));
            bounds.collect::<serde_json::Value>()
        };
        let (min, max) = (bound(f32::min), bound(f32::max));
        let index = self.accessor(elements, target);
        let accessor = &mut self.root.accessors[index.value()];
        (accessor.min, accessor.max) = (Some(min), Some(max));
        index
    }

    /// The file: a header, the document, the numbers.
    pub fn into_glb(mut self) -> Result<Vec<u8>> {
        const VERSION: u32 = 2;
        self.root.push(Buffer {
            byte_length: USize64::from(self.bytes.len()),
            name: None,
            uri: None,
            extensions: None,
            extras: Default::default(),
        });
        let mut json = self.root.to_vec()?;
        json.resize(json.len().next_multiple_of(4), b' ');
        let length = 12 + 8 + json.len() + 8 + self.bytes.len();
        let mut file = b"glTF".to_vec();
        file.extend(VERSION.to_le_bytes());
        file.extend(u32::try_from(length)?.to_le_bytes());
        for (kind, chunk) in [(b"JSON", &json), (b"BIN\0", &self.bytes)] {
            file.extend((chunk.len() as u32).to_le_bytes());
            file.extend(kind);
            file.extend(chunk);
        }
        Ok(file)
    }
}
