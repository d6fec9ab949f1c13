// Prints what Khronos' validator says about the files named: a line for each error and warning, and
// "FILE: valid" for a file without any. Files beside a .gltf are read, too.
const fs = require('fs');
const path = require('path');
const validator = require('gltf-validator');

async function check(file) {
  const report = await validator.validateBytes(new Uint8Array(fs.readFileSync(file)), {
    uri: path.basename(file),
    maxIssues: 0,
    externalResourceFunction: async (uri) =>
      new Uint8Array(fs.readFileSync(path.join(path.dirname(file), decodeURIComponent(uri)))),
  });
  const found = report.issues.messages.filter((message) => message.severity < 2);
  for (const m of found) console.log(`${file}: ${m.code} ${m.message} ${m.pointer}`);
  if (found.length === 0) console.log(`${file}: valid`);
}

(async () => {
  for (const file of process.argv.slice(2)) await check(file);
})();
