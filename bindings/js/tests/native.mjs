// Compares WebAssembly with the native library on models: node native.mjs NATIVE_PROGRAM LIBATLAS_WASM MODEL.obj ...
import { execFileSync } from "node:child_process";
import { mkdtempSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { basename, join } from "node:path";

import { Library } from "../lib/library.js";
import { fans, readObj } from "../lib/obj.js";

export function native(program, mesh) {
  const folder = mkdtempSync(join(tmpdir(), "libatlas-"));
  try {
    const { positions, indices } = mesh;
    const parts = [Uint32Array.of(positions.length / 3, indices.length), positions, indices];
    writeFileSync(join(folder, "in"), Buffer.concat(parts.map((a) => Buffer.from(a.buffer, a.byteOffset, a.byteLength))));
    const seconds = Number(execFileSync(program, [join(folder, "in"), join(folder, "out")], { encoding: "utf8" }));
    const { buffer } = Uint8Array.from(readFileSync(join(folder, "out")));
    const [chartCount, vertexCount, triangleCount] = new Uint32Array(buffer, 0, 3);
    let at = 12;
    const take = (type, count) => {
      const array = new type(buffer, at, count);
      at += array.byteLength;
      return array;
    };
    return {
      seconds, chartCount,
      vertices: take(Uint32Array, vertexCount), uvs: take(Float32Array, 2 * vertexCount),
      indices: take(Uint32Array, 3 * triangleCount), triangleChart: take(Uint32Array, triangleCount),
    };
  } finally {
    rmSync(folder, { recursive: true });
  }
}

// Whether both have the same charts, and by how much their uvs differ at most.
export function compared(native, { meshes: [mesh] }) {
  const same = ["vertices", "indices", "triangleChart"].every(
    (name) => Buffer.compare(Buffer.from(native[name]), Buffer.from(mesh[name])) === 0 &&
      native[name].every((x, i) => x === mesh[name][i]));
  let apart = same ? 0 : NaN;
  if (same) mesh.uvs.forEach((x, i) => (apart = Math.max(apart, Math.abs(x - native.uvs[i]))));
  return { same, apart };
}

if (import.meta.url === `file://${process.argv[1]}`) {
  const [, , program, wasm, ...models] = process.argv;
  const library = new Library(await WebAssembly.compile(readFileSync(wasm)));
  for (const model of models) {
    const mesh = fans(readObj(readFileSync(model, "utf8")));
    const own = native(program, mesh);
    library.unwrap(mesh);
    const begun = process.cpuUsage();
    const result = library.unwrap(mesh);
    const { user, system } = process.cpuUsage(begun);
    const seconds = (user + system) / 1e6;
    const { same, apart } = compared(own, result);
    console.log([basename(model, ".obj"), mesh.indices.length / 3, own.chartCount, result.chartCount, same ? "same" : "OTHER",
      apart, own.seconds.toFixed(3), seconds.toFixed(3), (seconds / own.seconds).toFixed(2)].join("\t"));
  }
}
