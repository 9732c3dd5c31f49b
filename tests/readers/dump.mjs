// Writes every field of a database, as the reader in JavaScript has it, into a file of its name.

import { readFileSync, writeFileSync } from "node:fs";
import { FEATURE_DIM, ROW_STRIDE, parseDatabase } from "../../examples/readers/footwork_database.js";

const [path, out] = process.argv.slice(2);
const file = readFileSync(path);
const database = parseDatabase(file.buffer.slice(file.byteOffset, file.byteOffset + file.byteLength));
const { names, roles, clips, fingerprint, frames, ...arrays } = database;
arrays.features = arrays.features.filter((_, i) => i % ROW_STRIDE < FEATURE_DIM);
for (const [name, array] of Object.entries(arrays)) {
  writeFileSync(`${out}/${name}`, new Uint8Array(array.buffer, array.byteOffset, array.byteLength));
}
writeFileSync(`${out}/header.json`, JSON.stringify({ names, roles, clips, fingerprint }));
