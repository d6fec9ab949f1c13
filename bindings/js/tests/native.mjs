// Calls the native library, by tests/native.c, and compares results.
import { execFileSync } from "node:child_process";
import { mkdtempSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";

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
    (name) => native[name].length === mesh[name].length && native[name].every((x, i) => x === mesh[name][i]));
  let apart = same ? 0 : NaN;
  if (same) mesh.uvs.forEach((x, i) => (apart = Math.max(apart, Math.abs(x - native.uvs[i]))));
  return { same, apart };
}
