// Draws with WebGL 2 where there is no WebGPU, by the same shaders in its language.

import { CAPSULE_FLOATS, CUBOID_FLOATS, VIEW_FLOATS } from "./module.js";

const SHADOWS = 1024; // side of the shadow map, pixels
const SKY = [0.86, 0.89, 0.93, 1]; // sRGB

const CAPSULE = [12, 4]; // corners around a capsule, rings from its middle up

// Where only depths count.
const NO_COLOUR = "#version 300 es\nprecision highp float;\nvoid main() {}\n";

export class WebGl {
  name = "WebGL 2";

  constructor(canvas, shaders, module) {
    this.canvas = canvas;
    const gl = canvas.getContext("webgl2", { antialias: true, alpha: false });
    this.gl = gl;
    const meshes = module.meshes(...CAPSULE);
    this.views = [0, 1].map(() => gl.createBuffer());
    this.shapes = {
      capsules: this.shape(shaders.capsule, meshes.capsule, [4], CAPSULE_FLOATS, [4, 4, 3]),
      cuboids: this.shape(shaders.cuboid, meshes.cuboid, [3, 3], CUBOID_FLOATS, [3, 3, 4, 3]),
    };
    this.ground = { program: this.program(shaders.ground), array: gl.createVertexArray() };
    this.cast = this.shadowMap();
    gl.enable(gl.DEPTH_TEST);
    gl.clearColor(...SKY);
  }

  program([vertex, fragment]) {
    const { gl } = this;
    const program = gl.createProgram();
    for (const [type, text] of [[gl.VERTEX_SHADER, vertex], [gl.FRAGMENT_SHADER, fragment]]) {
      const shader = gl.createShader(type);
      gl.shaderSource(shader, text);
      gl.compileShader(shader);
      gl.attachShader(program, shader);
    }
    gl.linkProgram(program);
    if (!gl.getProgramParameter(program, gl.LINK_STATUS)) {
      throw new Error(`WebGL does not take a shader: ${gl.getProgramInfoLog(program)}`);
    }
    // Both stages name the one block in their own way.
    const blocks = gl.getProgramParameter(program, gl.ACTIVE_UNIFORM_BLOCKS);
    for (let block = 0; block < blocks; block++) gl.uniformBlockBinding(program, block, 0);
    return program;
  }

  shape(shaders, mesh, corner, instanceFloats, instance) {
    const { gl } = this;
    const array = gl.createVertexArray();
    gl.bindVertexArray(array);
    const corners = gl.createBuffer();
    gl.bindBuffer(gl.ARRAY_BUFFER, corners);
    gl.bufferData(gl.ARRAY_BUFFER, mesh, gl.STATIC_DRAW);
    this.attributes(corner, 0, 0);
    const instances = gl.createBuffer();
    gl.bindBuffer(gl.ARRAY_BUFFER, instances);
    this.attributes(instance, corner.length, 1);
    const cornerFloats = corner.reduce((sum, count) => sum + count, 0);
    return {
      programs: [this.program([shaders[0], NO_COLOUR]), this.program(shaders)],
      array,
      instances,
      instanceFloats,
      cornerCount: mesh.length / cornerFloats,
      count: 0,
    };
  }

  attributes(counts, first, divisor) {
    const { gl } = this;
    const stride = 4 * counts.reduce((sum, count) => sum + count, 0);
    let offset = 0;
    counts.forEach((count, at) => {
      gl.enableVertexAttribArray(first + at);
      gl.vertexAttribPointer(first + at, count, gl.FLOAT, false, stride, offset);
      gl.vertexAttribDivisor(first + at, divisor);
      offset += 4 * count;
    });
  }

  shadowMap() {
    const { gl } = this;
    const map = gl.createTexture();
    gl.bindTexture(gl.TEXTURE_2D, map);
    gl.texStorage2D(gl.TEXTURE_2D, 1, gl.DEPTH_COMPONENT24, SHADOWS, SHADOWS);
    for (const [name, value] of [
      [gl.TEXTURE_MIN_FILTER, gl.LINEAR],
      [gl.TEXTURE_MAG_FILTER, gl.LINEAR],
      [gl.TEXTURE_WRAP_S, gl.CLAMP_TO_EDGE],
      [gl.TEXTURE_WRAP_T, gl.CLAMP_TO_EDGE],
      [gl.TEXTURE_COMPARE_MODE, gl.COMPARE_REF_TO_TEXTURE],
      [gl.TEXTURE_COMPARE_FUNC, gl.LEQUAL],
    ]) gl.texParameteri(gl.TEXTURE_2D, name, value);
    const frame = gl.createFramebuffer();
    gl.bindFramebuffer(gl.FRAMEBUFFER, frame);
    gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.DEPTH_ATTACHMENT, gl.TEXTURE_2D, map, 0);
    gl.bindFramebuffer(gl.FRAMEBUFFER, null);
    return { map, frame };
  }

  draw(picture) {
    const { gl, canvas } = this;
    this.resize();
    const { views, ...instances } = picture(canvas.width / canvas.height);
    this.setViews(views);
    for (const [name, shape] of Object.entries(this.shapes)) {
      const values = instances[name];
      gl.bindBuffer(gl.ARRAY_BUFFER, shape.instances);
      gl.bufferData(gl.ARRAY_BUFFER, values, gl.DYNAMIC_DRAW);
      shape.count = values.length / shape.instanceFloats;
    }
    gl.bindTexture(gl.TEXTURE_2D, null);
    gl.bindFramebuffer(gl.FRAMEBUFFER, this.cast.frame);
    gl.viewport(0, 0, SHADOWS, SHADOWS);
    gl.enable(gl.POLYGON_OFFSET_FILL);
    gl.polygonOffset(2, 2);
    this.pass(0);
    gl.disable(gl.POLYGON_OFFSET_FILL);
    gl.bindFramebuffer(gl.FRAMEBUFFER, null);
    gl.bindTexture(gl.TEXTURE_2D, this.cast.map);
    gl.viewport(0, 0, canvas.width, canvas.height);
    this.pass(1);
    gl.useProgram(this.ground.program);
    gl.bindVertexArray(this.ground.array);
    gl.drawArrays(gl.TRIANGLE_STRIP, 0, 4);
  }

  pass(view) {
    const { gl } = this;
    gl.clear(view === 0 ? gl.DEPTH_BUFFER_BIT : gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    gl.bindBufferBase(gl.UNIFORM_BUFFER, 0, this.views[view]);
    for (const shape of Object.values(this.shapes)) {
      if (shape.count === 0) continue;
      gl.useProgram(shape.programs[view]);
      gl.bindVertexArray(shape.array);
      gl.drawArraysInstanced(gl.TRIANGLES, 0, shape.cornerCount, shape.count);
    }
  }

  // WebGL's depths go from -1 to 1, and its textures upwards: the sun's view is turned upside down.
  setViews(views) {
    const { gl } = this;
    const own = views.slice();
    for (const view of [0, 1]) {
      for (let column = 0; column < 4; column++) {
        const at = view * VIEW_FLOATS + 4 * column;
        own[at + 2] = 2 * own[at + 2] - own[at + 3];
        if (view === 0) own[at + 1] = -own[at + 1];
      }
      gl.bindBuffer(gl.UNIFORM_BUFFER, this.views[view]);
      gl.bufferData(gl.UNIFORM_BUFFER, own.subarray(view * VIEW_FLOATS, (view + 1) * VIEW_FLOATS), gl.DYNAMIC_DRAW);
    }
  }

  // Fits the picture to the window.
  resize() {
    const { canvas } = this;
    const [width, height] = [canvas.clientWidth, canvas.clientHeight].map((side) =>
      Math.max(1, Math.round(side * devicePixelRatio)));
    if (canvas.width !== width || canvas.height !== height) Object.assign(canvas, { width, height });
  }
}

// Whether there is WebGL 2 on a graphics processor.
export function hasWebGl() {
  const gl = document.createElement("canvas").getContext("webgl2");
  const info = gl?.getExtension("WEBGL_debug_renderer_info");
  const name = info ? gl.getParameter(info.UNMASKED_RENDERER_WEBGL) : "";
  gl?.getExtension("WEBGL_lose_context")?.loseContext();
  return Boolean(gl) && !/swiftshader|llvmpipe|software/i.test(name);
}
