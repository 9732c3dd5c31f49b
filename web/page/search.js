// The search for the nearest candidate on the GPU, by shaders/search/search_one.wgsl.

const ROW_BYTES = 4 * 28;
const WORKGROUPS = 64;
const NEAREST_BYTES = 8 * WORKGROUPS;

export class Search {
  constructor(device, shader, module) {
    this.device = device;
    this.module = module;
    this.busy = false;
    this.candidates = 0; // in `rows`
    this.pipeline = device.createComputePipeline({
      layout: "auto",
      compute: { module: device.createShaderModule({ code: shader }), entryPoint: "search_one" },
    });
    const { STORAGE, COPY_DST, COPY_SRC, UNIFORM, MAP_READ } = GPUBufferUsage;
    const buffer = (size, usage) => device.createBuffer({ size, usage });
    this.query = buffer(ROW_BYTES, STORAGE | COPY_DST);
    this.params = buffer(16, UNIFORM | COPY_DST);
    this.found = buffer(NEAREST_BYTES, STORAGE | COPY_SRC);
    this.read = buffer(NEAREST_BYTES, MAP_READ | COPY_DST);
    this.rows = null;
  }

  // The candidate nearest to a query, of equals the lowest.
  async nearest({ features, candidates }) {
    this.busy = true;
    try {
      // Rows are fetched from the same memory.
      const query = features.slice();
      this.takeRows(candidates);
      const { queue } = this.device;
      queue.writeBuffer(this.query, 0, query);
      queue.writeBuffer(this.params, 0, new Uint32Array([candidates, WORKGROUPS]));
      const encoder = this.device.createCommandEncoder();
      const pass = encoder.beginComputePass();
      pass.setPipeline(this.pipeline);
      pass.setBindGroup(0, this.group);
      pass.dispatchWorkgroups(WORKGROUPS);
      pass.end();
      encoder.copyBufferToBuffer(this.found, 0, this.read, 0, NEAREST_BYTES);
      queue.submit([encoder.finish()]);
      await this.read.mapAsync(GPUMapMode.READ);
      const found = new Uint32Array(this.read.getMappedRange().slice(0));
      this.read.unmap();
      return least(found);
    } finally {
      this.busy = false;
    }
  }

  // Copies the rows that have arrived since the last query to the GPU.
  takeRows(candidates) {
    if (candidates === this.candidates) return;
    const bytes = candidates * ROW_BYTES;
    if (!this.rows || this.rows.size < bytes) {
      const most = this.device.limits.maxStorageBufferBindingSize;
      const size = Math.min(Math.max(2 * bytes, 1 << 20), most - (most % ROW_BYTES));
      this.rows?.destroy();
      this.rows = this.device.createBuffer({ size, usage: GPUBufferUsage.STORAGE | GPUBufferUsage.COPY_DST });
      this.candidates = 0;
      const buffers = [this.rows, this.query, this.found, this.params];
      this.group = this.device.createBindGroup({
        layout: this.pipeline.getBindGroupLayout(0),
        entries: buffers.map((buffer, binding) => ({ binding, resource: { buffer } })),
      });
    }
    const rows = this.module.searchRows(this.candidates);
    this.device.queue.writeBuffer(this.rows, this.candidates * ROW_BYTES, rows);
    this.candidates = candidates;
  }
}

// Of pairs of a distance's bits and a row, the row of the least.
function least(found) {
  let [bits, row] = found;
  for (let at = 2; at < found.length; at += 2) {
    if (found[at] < bits || (found[at] === bits && found[at + 1] < row)) {
      bits = found[at];
      row = found[at + 1];
    }
  }
  return row;
}
