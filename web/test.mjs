// Opens pages in headless Chromium: they load, a click moves the target, the character arrives, obstacles are dragged,
// bodies stand, and the console has no errors. `node web/test.mjs FOLDER_OF_PAGES FOLDER_OF_PICTURES`; of the pages
// `plane`, `obstacles` and `stand` those are opened that are there. playwright-core must be installed.

import { createServer } from "node:http";
import { createRequire } from "node:module";
import { mkdtemp, readFile, access, rm } from "node:fs/promises";
import { tmpdir } from "node:os";
import { extname, join, normalize, resolve } from "node:path";
import { pathToFileURL } from "node:url";

const { chromium } = createRequire(join(process.cwd(), "package.json"))("playwright-core");
const [pages, pictures] = process.argv.slice(2).map((path) => resolve(path));
const BROWSER = process.env.CHROMIUM ?? "/usr/bin/chromium";
const QUIET = ["--no-sandbox", "--disable-quic", "--no-first-run", "--disable-background-networking",
  "--disable-component-update", "--disable-sync"];
// Without a GPU: searched by WebAssembly, drawn on a plain canvas.
const CPU = ["--disable-gpu"];
// With WebGPU's software adapter, which is good for the search.
const WEBGPU = ["--enable-unsafe-webgpu", "--use-webgpu-adapter=swiftshader", "--enable-features=Vulkan",
  "--disable-gpu-compositing", "--disable-accelerated-2d-canvas"];
// Drawn by WebGL on the processor: slow, but all of it.
const WEBGL = ["--use-angle=swiftshader", "--enable-unsafe-swiftshader"];
const SIZE = { width: 720, height: 405 };
// Frames, thirtieths of a second, in which a character arrives, and seconds in which a processor plays and draws them.
const ARRIVES = 600;
const PATIENCE_MS = 150_000;
const FIRST_STEP_MS = 3000;
const TYPES = { ".html": "text/html", ".js": "text/javascript", ".json": "application/json", ".wasm": "application/wasm" };

const failures = [];

function check(what, holds, found = "") {
  console.log(`${holds ? "ok  " : "FAIL"} ${what}${found === "" ? "" : `: ${found}`}`);
  if (!holds) failures.push(what);
}

// Serves the folder of pages; `missing` files are not there.
async function serve(missing = []) {
  const server = createServer(async (request, response) => {
    const path = normalize(decodeURIComponent(new URL(request.url, "http://localhost").pathname));
    try {
      if (missing.some((name) => path.endsWith(name))) throw new Error("missing");
      const bytes = await readFile(join(pages, path));
      response.writeHead(200, { "Content-Type": TYPES[extname(path)] ?? "application/octet-stream" });
      response.end(bytes);
    } catch {
      response.writeHead(404).end();
    }
  });
  await new Promise((listening) => server.listen(0, "127.0.0.1", listening));
  return { server, url: `http://127.0.0.1:${server.address().port}` };
}

async function browse(flags, visit) {
  const profile = await mkdtemp(join(tmpdir(), "footwork-"));
  const options = { executablePath: BROWSER, headless: true, args: [...QUIET, ...flags], viewport: SIZE };
  const context = await chromium.launchPersistentContext(profile, options);
  try {
    await visit(context);
  } finally {
    await context.close();
    await rm(profile, { recursive: true, force: true });
  }
}

// A page that has made its first step, and what its console says.
async function open(context, url) {
  const page = await context.newPage();
  const errors = [];
  page.on("console", (message) => message.type() === "error" && errors.push(message.text()));
  page.on("pageerror", (error) => errors.push(error.message));
  await page.goto(url);
  const started = () => window.footwork?.firstStep || !document.getElementById("problem").hidden;
  await page.waitForFunction(started, null, { timeout: 60_000 });
  return { page, errors };
}

// Waits until so many more frames have been shown.
const frames = (page, count) => page.evaluate(() => window.footwork.state().frames_shown).then((shown) =>
  page.waitForFunction((last) => window.footwork.state().frames_shown >= last, shown + count, { timeout: PATIENCE_MS }));

const state = (page) => page.evaluate(() => window.footwork.state());

// Where a point on the ground is on the screen.
const onScreen = (page, at) => page.evaluate(([x, z]) => {
  const canvas = document.getElementById("canvas");
  const { views } = window.footwork.module.picture(canvas.clientWidth / canvas.clientHeight);
  const clip = [0, 1, 3].map((row) => views[40 + row] * x + views[48 + row] * z + views[52 + row]);
  return [0.5 * (1 + clip[0] / clip[2]) * canvas.clientWidth, 0.5 * (1 - clip[1] / clip[2]) * canvas.clientHeight];
}, at);

async function paths(page) {
  const text = (id) => page.textContent(`#${id}`);
  return `searched by ${await text("search")}, drawn by ${await text("drawing")}`;
}

async function walks(context, url, name) {
  const { page, errors } = await open(context, url);
  console.log(`-- ${name}: ${await paths(page)}`);
  const first = await page.evaluate(() => window.footwork.firstStep);
  check(`${name}: first step within 3 s`, first !== null && first < FIRST_STEP_MS, `${first?.toFixed(0)} ms`);
  const before = await state(page);
  await page.mouse.click(0.62 * SIZE.width, 0.66 * SIZE.height);
  const after = await state(page);
  const moved = Math.hypot(after.target[0] - before.target[0], after.target[1] - before.target[1]);
  check(`${name}: a click moves the target`, moved > 0.05, `${moved.toFixed(2)} m, now ${after.distance.toFixed(1)} m away`);
  await frames(page, 20);
  await page.screenshot({ path: join(pictures, `${name}.png`) });
  await page.waitForFunction(([count, last]) => {
    const { arrivals, frames_shown } = window.footwork.state();
    return arrivals > count || frames_shown > last;
  }, [after.arrivals, after.frames_shown + ARRIVES], { timeout: PATIENCE_MS });
  const there = await state(page);
  const took = (there.frames_shown - after.frames_shown) / 30;
  check(`${name}: the character arrives`, there.arrivals > after.arrivals, `${took.toFixed(1)} s of its time`);
  await frames(page, 90);
  const rate = await page.evaluate(() => window.footwork.pictures.rate);
  console.log(`     ${rate.toFixed(0)} pictures a second, ${JSON.stringify(await costs(page))}`);
  const { motion } = await state(page);
  await page.screenshot({ path: join(pictures, `${name}-later.png`) });
  check(`${name}: the motion arrives in parts`, motion[0] > 0 && motion[0] <= motion[1], `${motion[0]} of ${motion[1]} frames`);
  check(`${name}: the console has no errors`, errors.length === 0, errors.join("; "));
  return page;
}

// Milliseconds that a frame takes in the module, and a search.
const costs = (page) => page.evaluate(() => {
  const { module } = window.footwork;
  const time = (call) => {
    const began = performance.now();
    for (let turn = 0; turn < 60; turn++) call();
    return +((performance.now() - began) / 60).toFixed(3);
  };
  return {
    advance_ms: time(() => { module.call("advance", 1 / 30); if (module.query()) module.call("search"); }),
    picture_ms: time(() => module.picture(1.6)),
  };
});

async function drags(page, name) {
  const { obstacles, at } = await state(page);
  // One that is in the picture and not at its edge.
  let grabbed = null;
  for (const [slot, centre] of obstacles.entries()) {
    const [x, y] = await onScreen(page, centre);
    const inside = x > 300 && x < SIZE.width - 80 && y > 100 && y < SIZE.height - 60;
    if (inside && Math.hypot(centre[0] - at[0], centre[1] - at[1]) > 2) { grabbed = slot; break; }
  }
  const [x, y] = await onScreen(page, obstacles[grabbed]);
  await page.mouse.move(x, y);
  await page.mouse.down();
  await page.mouse.move(x + 30, y + 10, { steps: 3 });
  await page.mouse.move(x + 60, y + 20, { steps: 3 });
  const now = (await state(page)).obstacles;
  await page.mouse.up();
  const far = Math.max(...now.map((centre, slot) => Math.hypot(centre[0] - obstacles[slot][0], centre[1] - obstacles[slot][1])));
  check(`${name}: an obstacle is dragged`, far > 0.4, `${far.toFixed(2)} m`);
}

async function stands(context, url, name) {
  const { page, errors } = await open(context, url);
  console.log(`-- ${name}: ${await paths(page)}`);
  const first = await page.evaluate(() => window.footwork.firstStep);
  check(`${name}: first step within 3 s`, first !== null && first < FIRST_STEP_MS, `${first?.toFixed(0)} ms`);
  await frames(page, 60);
  const now = await state(page);
  check(`${name}: the body is simulated and stands`, now.height > 1.2,
    `${now.frames_shown} frames, ${now.height.toFixed(2)} m high, episode ${now.episode}`);
  await page.screenshot({ path: join(pictures, `${name}.png`) });
  const rate = await page.evaluate(() => window.footwork.pictures.rate);
  console.log(`     ${rate.toFixed(0)} pictures a second, ${JSON.stringify(await costs(page))}`);
  check(`${name}: the console has no errors`, errors.length === 0, errors.join("; "));
  await page.close();
}

async function problem(context, url, name, words) {
  const page = await context.newPage();
  await page.goto(url);
  await page.waitForSelector("#problem:not([hidden])", { timeout: 20_000 });
  const text = await page.textContent("#problem");
  check(`${name}: the page says what to do`, text.includes(words), text);
  await page.close();
}

const exists = (name) => access(join(pages, name, "page.json")).then(() => true, () => false);
const { server, url } = await serve();
const broken = await serve(["motion-000.footwork"]);
await browse(CPU, async (context) => {
  if (await exists("plane")) {
    const page = await walks(context, `${url}/plane/index.html?gpu=none`, "plane-cpu");
    await page.close();
    await problem(context, `${broken.url}/plane/index.html?gpu=none`, "a missing part", "motion-000.footwork is missing");
    await problem(context, pathToFileURL(join(pages, "plane/index.html")).href, "from disk", "python3 -m http.server");
  }
  if (await exists("obstacles")) {
    const page = await walks(context, `${url}/obstacles/index.html?gpu=none`, "obstacles-cpu");
    await drags(page, "obstacles-cpu");
    await page.close();
  }
  for (const name of ["stand", "imitate"]) {
    if (await exists(name)) await stands(context, `${url}/${name}/index.html?gpu=none`, `${name}-cpu`);
  }
});
if (await exists("plane")) {
  await browse(WEBGL, async (context) => {
    const { page, errors } = await open(context, `${url}/plane/index.html?gpu=none&draw=webgl`);
    console.log(`-- plane-webgl: ${await paths(page)}`);
    await frames(page, 6);
    await page.screenshot({ path: join(pictures, "plane-webgl.png") });
    check("plane-webgl: the console has no errors", errors.length === 0, errors.join("; "));
  });
}
await browse(WEBGPU, async (context) => {
  if (!await exists("plane")) return;
  const page = await context.newPage();
  await page.goto(`${url}/plane/index.html?gpu=none`);
  const adapter = await page.evaluate(async () => Boolean(await navigator.gpu?.requestAdapter()));
  await page.close();
  if (!adapter) {
    console.log("-- this browser has no WebGPU adapter: the page was not tested with one");
    return;
  }
  const tested = await walks(context, `${url}/plane/index.html`, "plane-webgpu");
  const searched = await tested.textContent("#search");
  check("plane-webgpu: WebGPU has searched to the end", searched === "WebGPU", searched);
});
server.close();
broken.server.close();
console.log(failures.length === 0 ? "all hold" : `${failures.length} do not hold`);
process.exit(failures.length === 0 ? 0 : 1);
