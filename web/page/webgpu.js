// Draws with WebGPU, as src/view/renderer.rs does, by the same shaders.

import { CAPSULE_FLOATS, CUBOID_FLOATS, VIEW_FLOATS } from "./module.js";

const SHADOWS = 2048; // side of the shadow map, pixels
const SAMPLES = 4;
const CAPSULE = [18, 5]; // corners around a capsule, rings from its middle up
const DEPTH = "depth32float";
const SKY = { r: 0.855, g: 0.894, b: 0.929, a: 1 }; // sRGB
// Not every driver encodes what is written through another view of a canvas: the shaders do.
const ENCODES = ["const ENCODES = false;", "const ENCODES = true;"];

export class WebGpu {
  name = "WebGPU";

  constructor(canvas, device, shaders, module) {
    Object.assign(this, { canvas, device });
    this.context = canvas.getContext("webgpu");
    this.format = navigator.gpu.getPreferredCanvasFormat();
    this.context.configure({ device, format: this.format });
    this.layouts();
    const vertices = (formats, stepMode, first) => {
      let offset = 0;
      const attributes = formats.map((count, at) => {
        const attribute = { format: `float32x${count}`, offset, shaderLocation: first + at };
        offset += 4 * count;
        return attribute;
      });
      return { arrayStride: offset, stepMode, attributes };
    };
    const meshes = module.meshes(...CAPSULE);
    this.shapes = {
      capsules: this.shape(shaders.capsule, meshes.capsule, 4, CAPSULE_FLOATS, [
        vertices([4], "vertex", 0),
        vertices([4, 4, 3], "instance", 1),
      ]),
      cuboids: this.shape(shaders.cuboid, meshes.cuboid, 6, CUBOID_FLOATS, [
        vertices([3, 3], "vertex", 0),
        vertices([3, 3, 4, 3], "instance", 2),
      ]),
    };
    this.ground = this.pipeline(shaders.ground, [], "paint");
  }

  layouts() {
    const { device } = this;
    const { VERTEX, FRAGMENT } = GPUShaderStage;
    this.viewLayout = device.createBindGroupLayout({
      entries: [{ binding: 0, visibility: VERTEX | FRAGMENT, buffer: { type: "uniform" } }],
    });
    this.shadowLayout = device.createBindGroupLayout({
      entries: [
        { binding: 0, visibility: FRAGMENT, texture: { sampleType: "depth" } },
        { binding: 1, visibility: FRAGMENT, sampler: { type: "comparison" } },
      ],
    });
    const { RENDER_ATTACHMENT, TEXTURE_BINDING } = GPUTextureUsage;
    const map = device.createTexture({ size: [SHADOWS, SHADOWS], format: DEPTH, usage: RENDER_ATTACHMENT | TEXTURE_BINDING });
    this.depths = map.createView();
    const compare = device.createSampler({ compare: "less-equal", magFilter: "linear", minFilter: "linear" });
    this.shadows = device.createBindGroup({
      layout: this.shadowLayout,
      entries: [{ binding: 0, resource: this.depths }, { binding: 1, resource: compare }],
    });
    const { UNIFORM, COPY_DST } = GPUBufferUsage;
    this.views = [0, 1].map(() => {
      const buffer = device.createBuffer({ size: 4 * VIEW_FLOATS, usage: UNIFORM | COPY_DST });
      const group = device.createBindGroup({ layout: this.viewLayout, entries: [{ binding: 0, resource: { buffer } }] });
      return { buffer, group };
    });
  }

  pipeline(code, buffers, pass) {
    const { device } = this;
    const module = device.createShaderModule({ code: code.replace(...ENCODES) });
    const paints = pass === "paint";
    const bias = paints ? 0 : 2;
    return device.createRenderPipeline({
      layout: device.createPipelineLayout({
        bindGroupLayouts: paints ? [this.viewLayout, this.shadowLayout] : [this.viewLayout],
      }),
      vertex: { module, entryPoint: "place", buffers },
      fragment: paints ? { module, entryPoint: "paint", targets: [{ format: this.format }] } : undefined,
      primitive: { topology: buffers.length > 0 ? "triangle-list" : "triangle-strip" },
      depthStencil: { format: DEPTH, depthWriteEnabled: true, depthCompare: "less", depthBias: bias, depthBiasSlopeScale: bias },
      multisample: { count: paints ? SAMPLES : 1 },
    });
  }

  shape(code, mesh, cornerFloats, instanceFloats, buffers) {
    const corners = this.vertices(mesh.byteLength);
    this.device.queue.writeBuffer(corners, 0, mesh);
    return {
      cast: this.pipeline(code, buffers, "cast"),
      paint: this.pipeline(code, buffers, "paint"),
      corners,
      cornerCount: mesh.length / cornerFloats,
      instanceFloats,
      instances: this.vertices(1 << 14),
      count: 0,
    };
  }

  vertices(size) {
    return this.device.createBuffer({ size, usage: GPUBufferUsage.VERTEX | GPUBufferUsage.COPY_DST });
  }

  draw(picture) {
    this.resize();
    const { views, ...instances } = picture(this.canvas.width / this.canvas.height);
    this.views.forEach(({ buffer }, at) => {
      this.device.queue.writeBuffer(buffer, 0, views, at * VIEW_FLOATS, VIEW_FLOATS);
    });
    for (const [name, shape] of Object.entries(this.shapes)) this.set(shape, instances[name]);
    const encoder = this.device.createCommandEncoder();
    const cast = encoder.beginRenderPass({ colorAttachments: [], depthStencilAttachment: cleared(this.depths, "store") });
    cast.setBindGroup(0, this.views[0].group);
    this.drawShapes(cast, "cast");
    cast.end();
    const paint = encoder.beginRenderPass({
      colorAttachments: [{
        view: this.samples,
        resolveTarget: this.context.getCurrentTexture().createView(),
        clearValue: SKY,
        loadOp: "clear",
        storeOp: "discard",
      }],
      depthStencilAttachment: cleared(this.depth, "discard"),
    });
    paint.setBindGroup(0, this.views[1].group);
    paint.setBindGroup(1, this.shadows);
    this.drawShapes(paint, "paint");
    paint.setPipeline(this.ground);
    paint.draw(4);
    paint.end();
    this.device.queue.submit([encoder.finish()]);
  }

  set(shape, values) {
    if (shape.instances.size < values.byteLength) {
      shape.instances.destroy();
      shape.instances = this.vertices(2 * values.byteLength);
    }
    this.device.queue.writeBuffer(shape.instances, 0, values);
    shape.count = values.length / shape.instanceFloats;
  }

  drawShapes(pass, name) {
    for (const shape of Object.values(this.shapes)) {
      if (shape.count === 0) continue;
      pass.setPipeline(shape[name]);
      pass.setVertexBuffer(0, shape.corners);
      pass.setVertexBuffer(1, shape.instances);
      pass.draw(shape.cornerCount, shape.count);
    }
  }

  // Fits the picture to the window.
  resize() {
    const { canvas, device } = this;
    const [width, height] = [canvas.clientWidth, canvas.clientHeight].map((side) =>
      Math.max(1, Math.round(side * devicePixelRatio)));
    if (this.samples && canvas.width === width && canvas.height === height) return;
    Object.assign(canvas, { width, height });
    this.targets?.forEach((texture) => texture.destroy());
    const target = (format) => device.createTexture({
      size: [width, height],
      format,
      sampleCount: SAMPLES,
      usage: GPUTextureUsage.RENDER_ATTACHMENT,
    });
    this.targets = [target(this.format), target(DEPTH)];
    [this.samples, this.depth] = this.targets.map((texture) => texture.createView());
  }
}

function cleared(view, depthStoreOp) {
  return { view, depthClearValue: 1, depthLoadOp: "clear", depthStoreOp };
}
