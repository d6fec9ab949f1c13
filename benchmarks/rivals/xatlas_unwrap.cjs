// Unwraps an OBJ with xatlas compiled to WebAssembly (npm package xatlas-web) under Node:
//   NODE_PATH=FOLDER/node_modules node xatlas_unwrap.cjs IN.obj OUT.obj
// WebAssembly runs slower than native code: say so beside the figures. The package takes 16-bit
// indices, so meshes of more than 65536 vertices are refused here; xatlas_unwrap.cpp has no such limit.
const fs = require('fs');
const path = require('path');

const [source, target] = process.argv.slice(2);
const positions = [], indices = [];
for (const line of fs.readFileSync(source, 'utf8').split('\n')) {
  const words = line.trim().split(/\s+/);
  if (words[0] === 'v') positions.push(+words[1], +words[2], +words[3]);
  if (words[0] === 'f') for (const w of words.slice(1, 4)) indices.push(parseInt(w) - 1);
}

if (positions.length / 3 > 65536) {
  console.error('xatlas-web takes 16-bit indices: at most 65536 vertices');
  process.exit(3);
}

// The package is built for browsers only; it asks for a window and no Node process when it starts.
const library = require.resolve('xatlas-web');
const wasmBinary = fs.readFileSync(path.join(path.dirname(library), 'xatlas-web.wasm'));
const node = globalThis.process;
globalThis.window = globalThis;
globalThis.document = {currentScript: {src: 'file:///xatlas-web.js'}};
const create = require(library);
globalThis.process = undefined;
const xatlas = create({wasmBinary});
globalThis.process = node;

function unwrap() {
  xatlas.createAtlas();
  const mesh = xatlas.createMesh(positions.length / 3, indices.length, false, false);
  xatlas.HEAPU16.set(indices, mesh.indexOffset / 2);
  xatlas.HEAPF32.set(positions, mesh.positionOffset / 4);
  if (xatlas.addMesh() !== 0) throw new Error('xatlas refuses the mesh');
  xatlas.generateAtlas();
  const out = xatlas.getMeshData(mesh.meshId);
  const lines = [];
  for (let i = 0; i < positions.length; i += 3)
    lines.push(`v ${positions[i]} ${positions[i + 1]} ${positions[i + 2]}`);
  const uv = xatlas.HEAPF32.subarray(out.uvOffset / 4, out.uvOffset / 4 + 2 * out.newVertexCount);
  for (let i = 0; i < uv.length; i += 2) lines.push(`vt ${uv[i]} ${uv[i + 1]}`);
  const index = xatlas.HEAPU32.subarray(out.indexOffset / 4, out.indexOffset / 4 + out.newIndexCount);
  const original = xatlas.HEAPU32.subarray(
      out.originalIndexOffset / 4, out.originalIndexOffset / 4 + out.newVertexCount);
  for (let i = 0; i < index.length; i += 3) {
    const corner = (k) => `${original[index[i + k]] + 1}/${index[i + k] + 1}`;
    lines.push(`f ${corner(0)} ${corner(1)} ${corner(2)}`);
  }
  fs.writeFileSync(target, lines.join('\n') + '\n');
}

const wait = setInterval(() => {
  if (!xatlas.createAtlas) return;
  clearInterval(wait);
  unwrap();
}, 10);
