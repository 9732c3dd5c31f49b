//! Narrow dense networks by custom WGSL kernels: one launch for all layers of all networks, and a gradient
//! in four and the objective's.

use super::dims::dims;
use crate::gpu::{Array, Buffer, Device, Gpu};
use crate::kernels::learn::network::{BatchLayout, IDENTITY, MAX_ROWS, RELU, TANH};
use crate::kernels::learn::{backward, forward, gradient, reduce_grads};
use crate::nn::extent::{EngineSize, Samples};
use crate::nn::layer::Activation;
use crate::nn::network::{LayerParams, Network};
use crate::nn::objective::{GpuBatch, Objective};

/// The widest layer; wider ones are quicker as products of matrices.
const MAX_WIDTH: usize = 128;
/// The most rows evaluated at once: 13 MB in networks like the presets'.
const AT_ONCE: usize = 1 << 14;

/// What dense networks need on the device, made once.
pub struct Fused {
    gpu: Gpu,
    networks: usize,
    dims: Buffer<u32>,
    /// To evaluate with.
    forward: Layout,
    /// To learn with, one for each size of a minibatch that there was.
    minibatch: Vec<Layout>,
    /// Number of the copy of the parameters, for every block: the only one's.
    only_copy: Buffer<u32>,
    /// Activations of a minibatch, laid out as [`BatchLayout::at`] says.
    rows: Buffer<f32>,
    grads: Buffer<f32>,
    /// `[rows][outputs]` of each network, and the gradients with respect to them.
    outputs: Buffer<f32>,
    output_grads: Buffer<f32>,
    /// `[rows][extras]`
    extras: Buffer<f32>,
    /// `[splits][parameters + sums]`
    partials: Buffer<f32>,
}

/// A layout on the host and on the device.
pub(super) struct Layout {
    pub host: BatchLayout,
    pub table: Buffer<u32>,
}

impl Layout {
    pub fn new(gpu: &Gpu, host: BatchLayout) -> Self {
        let table = Buffer::from_slice(gpu, &host.words());
        Layout { host, table }
    }
}

impl Fused {
    /// None if a layer is not dense or too wide, or what a minibatch needs too large for the device.
    pub fn new(gpu: &Gpu, networks: &[Network], size: EngineSize) -> Option<Self> {
        let narrow = |network| dense(network).filter(|layers| layers.iter().all(is_narrow));
        let layers = networks.iter().map(narrow).collect::<Option<Vec<_>>>()?;
        let sums = size.extras - size.others(networks);
        let layout = BatchLayout::new(&layers, size.parameters, sums, size.minibatch)?;
        let forward = layout.clone().with_rows(size.max_rows.clamp(1, AT_ONCE));
        let device = Device::from(gpu.clone());
        let rows = forward.numbers().max(layout.numbers());
        device.holds("rows", rows).ok()?;
        if size.minibatch > MAX_ROWS {
            return None;
        }
        let empty = |length: usize| Buffer::empty(gpu, length.max(1));
        let outputs = size.minibatch * layout.outputs(0, networks.len());
        Some(Fused {
            networks: networks.len(),
            dims: dims(gpu, networks, size),
            only_copy: Buffer::zeroed(gpu, forward.blocks().max(layout.blocks()).max(1)),
            rows: empty(rows),
            grads: empty(layout.numbers()),
            outputs: empty(outputs),
            output_grads: empty(outputs),
            extras: empty(size.minibatch * layout.extras().outputs as usize),
            partials: empty(layout.partials()),
            forward: Layout::new(gpu, forward),
            minibatch: vec![Layout::new(gpu, layout)],
            gpu: gpu.clone(),
        })
    }

    pub fn forward(
        &self,
        network: usize,
        parameters: &Array,
        batch: Samples,
        out: &mut Array,
        out_at: usize,
    ) {
        let outputs = self.forward.host.outputs(network, network + 1);
        let most = self.forward.host.head.rows as usize;
        for start in (0..batch.count).step_by(most) {
            let params = forward::Params {
                rows: most.min(batch.count - start) as u32,
                start: (batch.first + start) as u32,
                width: batch.width as u32,
                network: network as u32,
                out_at: (out_at + start * outputs) as u32,
            };
            forward::launch(
                &self.gpu,
                1,
                &self.forward.table,
                batch.values.buffer(),
                parameters.buffer(),
                &self.only_copy,
                &self.rows,
                out.buffer(),
                &params,
            );
        }
    }

    pub fn gradient(
        &mut self,
        parameters: &Array,
        batch: Samples,
        objective: &dyn Objective,
        gradient: &mut Array,
        sums: &mut Array,
    ) {
        let number = self.layout(batch.count);
        let (gpu, table) = (&self.gpu, &self.minibatch[number].table);
        let (samples, parameters) = (batch.values.buffer(), parameters.buffer());
        let params = forward::Params {
            rows: batch.count as u32,
            start: batch.first as u32,
            width: batch.width as u32,
            network: 0,
            out_at: 0,
        };
        let (activations, outputs) = (&self.rows, &self.outputs);
        forward::launch(
            gpu,
            self.networks,
            table,
            samples,
            parameters,
            &self.only_copy,
            activations,
            outputs,
            &params,
        );
        let buffers = GpuBatch {
            dims: &self.dims,
            samples,
            width: batch.width,
            first: batch.first,
            rows: batch.count,
            parameters,
            outputs,
            output_grads: &self.output_grads,
            extras: &self.extras,
        };
        objective.launch(gpu, &buffers);
        let params = backward::Params {
            rows: batch.count as u32,
        };
        backward::launch(
            gpu,
            self.networks,
            table,
            parameters,
            activations,
            &self.output_grads,
            &self.extras,
            &self.grads,
            &params,
        );
        let groups = gradient::groups(&self.minibatch[number].host);
        gradient::launch(gpu, groups, table, activations, &self.grads, &self.partials);
        let (gradient, sums) = (gradient.buffer(), sums.buffer());
        reduce_grads::launch(gpu, table, &self.partials, gradient, sums);
    }

    /// Number of the layout for so many rows.
    fn layout(&mut self, rows: usize) -> usize {
        let of_size = |layout: &Layout| layout.host.head.rows as usize == rows;
        self.minibatch.iter().position(of_size).unwrap_or_else(|| {
            let host = self.minibatch[0].host.clone().with_rows(rows);
            self.minibatch.push(Layout::new(&self.gpu, host));
            self.minibatch.len() - 1
        })
    }
}

/// Inputs, outputs and activation of a layer.
pub(super) type DenseLayer = (usize, usize, u32);

fn is_narrow(&(inputs, outputs, _): &DenseLayer) -> bool {
    inputs.max(outputs) <= MAX_WIDTH
}

/// All layers, if they are dense.
pub(super) fn dense(network: &Network) -> Option<Vec<DenseLayer>> {
    let layer = |params: &LayerParams| {
        let layer = &params.layer;
        let activation = match layer.activation() {
            Activation::Relu => RELU,
            Activation::Tanh => TANH,
            Activation::Identity => IDENTITY,
        };
        let sizes = (layer.patch(), layer.filters(), activation);
        layer.is_dense().then_some(sizes)
    };
    // An encoder's layers do not follow each other: the vector joins in between.
    let layers = network.layers().iter().map(layer);
    (!network.has_map_encoder()).then(|| layers.collect())?
}
