// What the Khronos validator finds in a glTF file: `NODE_PATH=FOLDER/node_modules node validate.js FILE.glb`, where
// `npm install gltf-validator` was run in FOLDER. Exits with 1 if that is an error, a warning or a remark.
const fs = require('fs');
const validator = require('gltf-validator');

validator.validateBytes(new Uint8Array(fs.readFileSync(process.argv[2]))).then((report) => {
  const { numErrors, numWarnings, numInfos, numHints, messages } = report.issues;
  console.log(JSON.stringify({ ...report.info, numErrors, numWarnings, numInfos, numHints, messages }, null, 1));
  process.exit(numErrors + numWarnings + numInfos + numHints > 0 ? 1 : 0);
});
