// The page: loads a run, lets it go on, draws it, and takes the pointer.

import { Canvas2d } from "./canvas.js";
import { Module } from "./module.js";
import { Search } from "./search.js";
import { WebGl, hasWebGl } from "./webgl.js";
import { WebGpu } from "./webgpu.js";

const options = new URLSearchParams(location.search);
const element = (id) => document.getElementById(id);

// Names of what a run's task is, and what the pointer does there.
const HINTS = {
  plane: "Click the ground: the character goes there.",
  obstacles: "Click the ground: the character goes there. Drag obstacles out of its way, or into it.",
  punch: "Click the ground to put the box there; drag the body to push it.",
  joystick: "Click the ground to put the box there; drag the body to push it.",
};
const BODY_HINT = "Drag the body to push it.";
const CPU_SEARCH = "CPU (WebAssembly)";
const CAMERA_HINT = " Drag elsewhere to turn, scroll to come nearer.";

async function main() {
  const began = performance.now();
  const manifest = await (await file("page.json")).json();
  element("title").textContent = `footwork: ${manifest.task}`;
  element("hint").textContent = (HINTS[manifest.task] ?? BODY_HINT) + CAMERA_HINT;
  const [module, run, part, shaders, gpu] = await Promise.all([
    file(manifest.module.file).then(Module.load),
    contents(manifest.run.file),
    manifest.parts.length > 0 ? contents(manifest.parts[0].file) : null,
    file("shaders.json").then((response) => response.json()),
    device(),
  ]);
  module.open(run);
  if (part) module.addPart(part);
  const renderer = rendererOn(gpu, shaders, module);
  const matches = manifest.parts.length > 0;
  const search = gpu && matches && options.get("search") !== "cpu" ? new Search(gpu, shaders.search, module) : null;
  element("search").textContent = matches ? (search ? "WebGPU" : CPU_SEARCH) : "none: a simulated body";
  element("drawing").textContent = renderer.name;
  const page = new Page(module, renderer, search, began);
  window.footwork = page;
  page.takePointer();
  page.run();
  gpu?.lost.then(() => page.goOnWithout(shaders));
  for (const { file } of manifest.parts.slice(1)) {
    module.addPart(await contents(file));
  }
}

// What draws: WebGPU or WebGL on a graphics processor, a plain canvas without one.
function rendererOn(gpu, shaders, module) {
  const canvas = element("canvas");
  const wanted = options.get("draw") ?? (gpu && !gpu.isSoftware ? "webgpu" : hasWebGl() ? "webgl" : "canvas");
  if (wanted === "webgpu" && gpu) return new WebGpu(canvas, gpu, shaders, module);
  return wanted === "webgl" ? new WebGl(canvas, shaders.glsl, module) : new Canvas2d(canvas);
}

// A WebGPU device, or null where there is none.
async function device() {
  if (!navigator.gpu || options.get("gpu") === "none") return null;
  try {
    const adapter = await navigator.gpu.requestAdapter();
    if (!adapter) return null;
    const { architecture, isFallbackAdapter } = adapter.info;
    // Rows of the largest databases need more than the default.
    const { maxStorageBufferBindingSize, maxBufferSize } = adapter.limits;
    const device = await adapter.requestDevice({ requiredLimits: { maxStorageBufferBindingSize, maxBufferSize } });
    device.isSoftware = Boolean(isFallbackAdapter) || architecture === "swiftshader";
    return device;
  } catch {
    return null;
  }
}

// A file of the folder; a missing one is said by its name.
async function file(name) {
  let response;
  try {
    response = await fetch(name);
  } catch {
    throw new Error(`${name} cannot be loaded: is the folder still being served?`);
  }
  if (!response.ok) {
    throw new Error(`${name} is missing (${response.status}): serve the whole folder that footwork web has written, or write it anew`);
  }
  return response;
}

async function contents(name) {
  return (await file(name)).arrayBuffer();
}

class Page {
  constructor(module, renderer, search, began) {
    Object.assign(this, { module, renderer, search, began });
    this.pictures = { count: 0, since: performance.now(), rate: 0 };
    this.firstStep = null; // ms after the page began to load
    this.problem = null;
  }

  // Goes on without the WebGPU device, which is lost: drivers are updated, and processes die.
  goOnWithout(shaders) {
    this.search = null;
    if (element("search").textContent === "WebGPU") element("search").textContent = CPU_SEARCH;
    if (!(this.renderer instanceof WebGpu)) return;
    // A canvas serves one kind of drawing for good.
    const canvas = element("canvas");
    canvas.replaceWith(canvas.cloneNode());
    this.renderer = rendererOn(null, shaders, this.module);
    element("drawing").textContent = this.renderer.name;
    this.takePointer();
  }

  run() {
    let last = performance.now();
    const next = (now) => {
      try {
        this.step((now - last) / 1000);
        last = now;
        requestAnimationFrame(next);
      } catch (error) {
        this.fail(error);
      }
    };
    requestAnimationFrame(next);
  }

  step(seconds) {
    this.module.call("advance", Math.max(0, seconds));
    this.answer();
    this.renderer.draw((aspect) => this.module.picture(aspect));
    if (this.firstStep === null && this.state().frames_shown > 0) {
      this.firstStep = performance.now() - this.began;
    }
    this.count();
  }

  // Lets the query be answered on the GPU, or here and now.
  answer() {
    if (this.search?.busy) return;
    const query = this.module.query();
    if (!query) return;
    if (!this.search) {
      this.module.call("search");
      return;
    }
    const { search } = this;
    search.nearest(query).then(
      (candidate) => this.module.call("set_match", candidate),
      // Of a lost device: see goOnWithout.
      () => { search.busy = true; },
    );
  }

  state() {
    return this.module.state();
  }

  count() {
    const pictures = this.pictures;
    pictures.count += 1;
    const now = performance.now();
    if (now - pictures.since < 500) return;
    pictures.rate = (1000 * pictures.count) / (now - pictures.since);
    Object.assign(pictures, { count: 0, since: now });
    const { motion: [there, all], distance, arrivals, height, target } = this.state();
    element("rate").textContent = `${pictures.rate.toFixed(0)} a second`;
    element("motion").textContent = all === 0 ? "simulated" : `${(there / 1800).toFixed(1)} of ${(all / 1800).toFixed(1)} minutes`;
    element("target").textContent = target
      ? `${distance.toFixed(1)} m away${all > 0 ? `, ${arrivals} reached` : ""}`
      : `none; ${height.toFixed(2)} m high`;
  }

  fail(error) {
    this.problem = error.message;
    showProblem(error.message);
    console.error(error);
  }

  takePointer() {
    const canvas = element("canvas");
    const place = (event) => {
      const { width, height } = canvas.getBoundingClientRect();
      return [(2 * event.offsetX) / width - 1, 1 - (2 * event.offsetY) / height];
    };
    canvas.addEventListener("pointerdown", (event) => {
      canvas.setPointerCapture(event.pointerId);
      this.module.call("press", ...place(event));
    });
    canvas.addEventListener("pointermove", (event) => this.module.call("drag", ...place(event)));
    for (const end of ["pointerup", "pointercancel"]) {
      canvas.addEventListener(end, () => {
        try {
          this.module.call("release");
        } catch (error) {
          this.fail(error);
        }
      });
    }
    canvas.addEventListener("wheel", (event) => {
      event.preventDefault();
      this.module.call("zoom", Math.exp(0.001 * event.deltaY));
    }, { passive: false });
  }
}

main().catch((error) => {
  if (location.protocol !== "file:") showProblem(error.message);
  console.error(error);
});
