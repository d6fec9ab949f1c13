// The code in docs/javascript.md and of the READMEs runs.
import assert from "node:assert/strict";
import { cpSync, existsSync, mkdirSync, mkdtempSync, readFileSync, rmSync, symlinkSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { after, test } from "node:test";
import { fileURLToPath, pathToFileURL } from "node:url";

import { folder, libatlas, waves } from "./support.mjs";

const repository = fileURLToPath(new URL("../../..", import.meta.url));
const others = join(repository, "benchmarks/javascript/node_modules");
const text = [join(repository, "docs/javascript.md"), join(repository, "README.md"), `${folder}/README.md`].map((page) => readFileSync(page, "utf8")).join("\n");
const snippets = [...text.matchAll(/^```js\n([^]*?)^```$/gm)].map(([, code]) => code);

// What the snippets take for granted.
const mesh = waves(20);
const { meshes: [{ uvs, indices: uvIndices }] } = (await libatlas.load()).unwrap(mesh);
const used = [];
Object.assign(globalThis, {
  ...mesh, normals: mesh.positions, uvs, uvIndices,
  interleaved: Float32Array.from({ length: (8 * mesh.positions.length) / 3 }, (_, i) => (i % 8 < 3 ? mesh.positions[3 * Math.floor(i / 8) + (i % 8)] : 0)),
  use: (...values) => used.push(...values), show: () => {},
});

const place = mkdtempSync(join(tmpdir(), "libatlas-"));
mkdirSync(join(place, "node_modules"));
cpSync(folder, join(place, "node_modules/libatlas"), { recursive: true });
if (existsSync(others)) {
  for (const name of ["@gltf-transform", "property-graph"]) symlinkSync(join(others, name), join(place, "node_modules", name));
  const { Document, NodeIO } = await import(pathToFileURL(join(others, "@gltf-transform/core/dist/index.js")));
  const document = new Document();
  document.createBuffer();
  const primitive = document.createPrimitive().setAttribute("POSITION", document.createAccessor().setType("VEC3").setArray(mesh.positions));
  primitive.setIndices(document.createAccessor().setType("SCALAR").setArray(mesh.indices));
  document.createScene().addChild(document.createNode().setMesh(document.createMesh().addPrimitive(primitive)));
  globalThis.path = join(place, "scene.glb");
  await new NodeIO().write(globalThis.path, document);
}

after(() => rmSync(place, { recursive: true }));
assert.ok(snippets.length >= 8);
snippets.forEach((code, i) => {
  const skip = code.includes("@gltf-transform") && !existsSync(others) && "npm ci has not run in benchmarks/javascript";
  test(`snippet ${i + 1}: ${code.split("\n")[0]}`, { skip }, async () => {
    const file = join(place, `snippet${i}.mjs`);
    writeFileSync(file, code);
    await import(pathToFileURL(file));
    for (const value of used.splice(0)) assert.ok(value && (value.length ?? 1) > 0);
  });
});
