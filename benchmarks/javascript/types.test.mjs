// The package's types, by TypeScript. After npm ci in this folder: LIBATLAS_PACKAGE=FOLDER node --test types.test.mjs
import assert from "node:assert/strict";
import { cpSync, mkdirSync, mkdtempSync, rmSync, symlinkSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { test } from "node:test";
import { fileURLToPath } from "node:url";

import ts from "typescript";

const module = `
import { NodeIO } from "@gltf-transform/core";
import { BadInputError, gather, load, startWorker, type Unwrapped } from "libatlas";
import { unwrap, unwrapPrimitives } from "libatlas/gltf-transform";
const atlas = await load(), worker = await startWorker();
const mesh = { positions: new Float32Array(9), indices: [0, 1, 2] };
const result: Unwrapped = atlas.unwrap(mesh, { charts: "fast", lightmap: { texelsPerMetre: 3 }, signal: AbortSignal.timeout(5) });
const normals: Float32Array = gather(new Float32Array(9), result.meshes[0].vertices, 3);
const x: number = (await worker.packRects([1, 2], { page: { width: 3, height: 4 } })).x[0] + normals[0];
const document = await new NodeIO().read("x");
await document.transform(unwrap({ texcoord: 1, groupBy: "scene", library: worker }));
const some: Unwrapped | null = await unwrapPrimitives([], { weights: [x] });
try { atlas.packIslands({ uvs: [] }); } catch (error) { if (error instanceof BadInputError) console.log(error.message, some); }
`;
const common = `import libatlas = require("libatlas");
libatlas.load().then((atlas: libatlas.Library) => atlas.version);`;
const wrong = ["atlas.unwrap({ positions: [] }, { paddding: 3 });", "atlas.unwrap({});", 'atlas.unwrap([], { charts: "slow" });', "worker.unwrap([]).meshes;"];

test("TypeScript takes what is right, and nothing else", () => {
  const folder = mkdtempSync(join(tmpdir(), "libatlas-types-"));
  try {
    mkdirSync(join(folder, "node_modules"));
    cpSync(process.env.LIBATLAS_PACKAGE, join(folder, "node_modules/libatlas"), { recursive: true });
    for (const name of ["@gltf-transform", "property-graph"]) symlinkSync(fileURLToPath(new URL(`node_modules/${name}`, import.meta.url)), join(folder, "node_modules", name));
    const texts = { "right.mts": module, "right.cts": common };
    wrong.forEach((line, i) => (texts[`wrong${i}.mts`] = `import { load, startWorker } from "libatlas";\nconst atlas = await load(), worker = await startWorker();\n${line}\n`));
    for (const [name, text] of Object.entries(texts)) writeFileSync(join(folder, name), text);
    const program = ts.createProgram(Object.keys(texts).map((name) => join(folder, name)), {
      noEmit: true, strict: true, skipLibCheck: true, target: ts.ScriptTarget.ES2022, module: ts.ModuleKind.Node16,
      moduleResolution: ts.ModuleResolutionKind.Node16, lib: ["lib.es2023.d.ts", "lib.dom.d.ts"], types: [], preserveSymlinks: true });
    const errors = ts.getPreEmitDiagnostics(program).map(({ file, messageText }) =>
      [file?.fileName.slice(folder.length + 1), ts.flattenDiagnosticMessageText(messageText, " ")]);
    assert.deepEqual(errors.filter(([name]) => !name?.startsWith("wrong")), []);
    wrong.forEach((line, i) => assert.equal(errors.filter(([name]) => name === `wrong${i}.mts`).length, 1, line));
  } finally {
    rmSync(folder, { recursive: true });
  }
});
