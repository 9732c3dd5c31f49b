// The WebAssembly: Rust's page behind plain functions.

export class Module {
  static async load(response) {
    const { instance } = await instantiate(response);
    return new Module(instance.exports);
  }

  constructor(exports) {
    this.exports = exports;
  }

  // Calls a function; what fails or panics is an error with its message.
  call(name, ...values) {
    let answer;
    try {
      answer = this.exports[name](...values);
    } catch (error) {
      throw new Error(`${name}: ${this.message() || error.message}`);
    }
    if (answer === 0) throw new Error(this.message());
    return answer;
  }

  give(bytes) {
    const place = this.exports.input(bytes.byteLength);
    new Uint8Array(this.exports.memory.buffer, place, bytes.byteLength).set(new Uint8Array(bytes));
  }

  open(bytes) {
    this.give(bytes);
    this.call("open");
  }

  addPart(bytes) {
    this.give(bytes);
    this.call("add_part");
  }

  // The query that the next frame waits for, or null.
  query() {
    const at = this.exports.query();
    if (at === 0) return null;
    const [place, length, candidates] = this.words(at, 3);
    return { features: this.floats(place, length), candidates };
  }

  // Copies of the rows of candidates from a number on.
  searchRows(first) {
    const [place, length] = this.words(this.exports.search_rows(first), 2);
    return this.floats(place, length).slice();
  }

  // What to draw: views into memory, until the next call.
  picture(aspect) {
    const [views, , capsules, capsuleCount, cuboids, cuboidCount] = this.words(this.exports.picture(aspect), 6);
    return {
      views: this.floats(views, 2 * VIEW_FLOATS),
      capsules: this.floats(capsules, capsuleCount * CAPSULE_FLOATS),
      cuboids: this.floats(cuboids, cuboidCount * CUBOID_FLOATS),
    };
  }

  // Corners of the shapes that instances are made of; a capsule has so many around, and rings from its middle up.
  meshes(around, up) {
    const [capsule, capsuleLength, cuboid, cuboidLength] = this.words(this.exports.meshes(around, up), 4);
    return {
      capsule: this.floats(capsule, capsuleLength).slice(),
      cuboid: this.floats(cuboid, cuboidLength).slice(),
    };
  }

  state() {
    return JSON.parse(this.text(this.exports.state()));
  }

  message() {
    return this.text(this.exports.message());
  }

  words(at, length) {
    return new Uint32Array(this.exports.memory.buffer, at, length);
  }

  floats(at, length) {
    return new Float32Array(this.exports.memory.buffer, at, length);
  }

  text(at) {
    const [place, length] = this.words(at, 2);
    return new TextDecoder().decode(new Uint8Array(this.exports.memory.buffer, place, length));
  }
}

// Floats of a view, and of an instance of each shape: `PassView`, `Capsule` and `Cuboid` in Rust.
export const VIEW_FLOATS = 40;
export const CAPSULE_FLOATS = 11;
export const CUBOID_FLOATS = 13;

async function instantiate(response) {
  // Some servers do not know the type of WebAssembly.
  const type = response.headers.get("Content-Type") ?? "";
  return type.startsWith("application/wasm")
    ? WebAssembly.instantiateStreaming(response, {})
    : WebAssembly.instantiate(await response.arrayBuffer(), {});
}
