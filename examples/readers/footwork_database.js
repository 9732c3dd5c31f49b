// Reads a footwork database of motion, in a browser or in Node. `docs/database.md` documents every field.
//
//     import { parseDatabase, nearest } from "./footwork_database.js";
//     const database = parseDatabase(await (await fetch("motion.footwork")).arrayBuffer());
//     const frame = nearest(database, query);

export const VERSION = 1;
export const RATE = 30;
export const POSE_DIM = 15;
export const FEATURE_DIM = 27;
/** Numbers from one row of `features` to the next. */
export const ROW_STRIDE = 28;
export const MIN_FUTURE_FRAMES = 30;
export const FRAMES_PER_STEP = 6;

/**
 * The database in an ArrayBuffer: all clips joined, a row a frame at 30 Hz; metres and seconds, y up.
 * Arrays are flat, and views of the buffer where it stores them. Throws an Error, with a sentence, for
 * what is none.
 */
export function parseDatabase(buffer) {
  const length = check(buffer);
  const text = new TextDecoder().decode(new Uint8Array(buffer, 32, length));
  const { header, arrays } = JSON.parse(text);
  const stored = {};
  let at = 32 + length;
  for (const [name, count] of arrays) {
    stored[name] = floats(buffer, at, count);
    at += 4 * count;
  }
  const { skeleton, normalisation, clips, roles, frames } = header;
  const { features, path, hips, rotations } = stored;
  const candidates = playable(clips);
  const motion = rootMotion(path, candidates);
  const fingerprint = [features, candidates, motion].reduce((crc, part) => crc32(bytes(part), crc), 0);
  return {
    frames, // their number
    names: skeleton.names, // of the joints; joint 0 is the root
    parents: Int32Array.from(skeleton.parents, (parent) => parent ?? -1), // [joints], -1 for the root
    offsets: Float32Array.from(skeleton.offsets.flat()), // [joints][3], from the parent joint, in its frame
    roles, // joints of hips, left_foot, ...
    clips, // name, first, frames, source, licence, findings
    mean: Float32Array.from(normalisation.mean), // [27]
    scale: Float32Array.from(normalisation.scale), // [27]; normalised = (feature - mean) * scale
    features, // [frames][ROW_STRIDE], normalised: pose (15), trajectory (12), a zero
    path, // [frames][4]: ground position x, z and heading x, z in the clip's world
    hips, // [frames][3], the root joint's position in the clip's world
    rotations, // [frames][joints][4]: x, y, z, w, relative to the parent
    candidates, // Uint32Array, the frames that can be matched and played on from
    motion, // [candidates][5]: moved x, z, turned x, z, length of a step
    fingerprint, // the number by which a policy knows its database
  };
}

/** The features of a frame in metres and m/s, in the character frame: pose (15), trajectory (12). */
export function featuresInMetres({ features, mean, scale }, frame) {
  const row = features.subarray(frame * ROW_STRIDE, frame * ROW_STRIDE + FEATURE_DIM);
  return row.map((value, i) => (scale[i] === 0 ? mean[i] : value / scale[i] + mean[i]));
}

/** The frame nearest to a normalised query of 27 numbers. */
export function nearest({ features, candidates }, query) {
  let [best, least] = [-1, Infinity];
  for (const frame of candidates) {
    let distance = 0;
    for (let i = 0; i < FEATURE_DIM; i++) {
      distance += (features[frame * ROW_STRIDE + i] - query[i]) ** 2;
    }
    if (distance < least) [best, least] = [frame, distance];
  }
  return best;
}

/** Length of the JSON, if the first 32 bytes are those of a whole database of this version. */
function check(buffer) {
  const view = new DataView(buffer);
  const text = (at) => String.fromCharCode(...new Uint8Array(buffer, at, 8)).replace(/\0+$/, "");
  if (buffer.byteLength < 32 || text(0) !== "footwork") throw new Error("this is not a footwork database");
  if (text(8) !== "database") throw new Error(`this is a footwork ${text(8)}, not a database`);
  const version = view.getUint32(16, true);
  if (version !== VERSION) {
    throw new Error(`the database has format version ${version}; this reader reads version ${VERSION}`);
  }
  if (crc32(new Uint8Array(buffer, 24)) !== view.getUint32(20, true)) {
    throw new Error("the database is damaged (its checksum does not match its contents)");
  }
  return Number(view.getBigUint64(24, true));
}

/** Little-endian floats at any place: a view where they are aligned, else a copy. */
function floats(buffer, at, count) {
  return at % 4 === 0
    ? new Float32Array(buffer, at, count)
    : new Float32Array(buffer.slice(at, at + 4 * count));
}

function playable(clips) {
  const frames = ({ first, frames }) =>
    Array.from({ length: frames - MIN_FUTURE_FRAMES }, (_, i) => first + i);
  return Uint32Array.from(clips.flatMap(frames));
}

/** Of each candidate: displacement and new heading after a step, and the path's length, in single precision. */
function rootMotion(path, candidates) {
  const { fround, sqrt } = Math;
  const out = new Float32Array(candidates.length * 5);
  candidates.forEach((frame, row) => {
    const [x, z, hx, hz] = path.subarray(4 * frame, 4 * frame + 4);
    const [x6, z6, hx6, hz6] = path.subarray(4 * (frame + FRAMES_PER_STEP));
    const local = (a, b) => [
      fround(fround(hz * a) - fround(hx * b)),
      fround(fround(hx * a) + fround(hz * b)),
    ];
    let length = 0;
    for (let k = 4 * frame; k < 4 * (frame + FRAMES_PER_STEP); k += 4) {
      const [dx, dz] = [fround(path[k + 4] - path[k]), fround(path[k + 5] - path[k + 1])];
      length = fround(length + fround(sqrt(dx * dx + dz * dz)));
    }
    const moved = local(fround(x6 - x), fround(z6 - z));
    out.set([...moved, ...local(hx6, hz6), length], 5 * row);
  });
  return out;
}

const TABLE = Uint32Array.from({ length: 256 }, (_, byte) => {
  for (let bit = 0; bit < 8; bit++) byte = byte & 1 ? (byte >>> 1) ^ 0xedb88320 : byte >>> 1;
  return byte;
});

/** CRC-32 as zlib has it, going on from that of the bytes before. */
function crc32(bytes, before = 0) {
  let crc = ~before;
  for (const byte of bytes) crc = TABLE[(crc ^ byte) & 255] ^ (crc >>> 8);
  return ~crc >>> 0;
}

function bytes(array) {
  return new Uint8Array(array.buffer, array.byteOffset, array.byteLength);
}
