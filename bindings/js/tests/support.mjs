// What the tests share: the package under test, and meshes.
import { pathToFileURL } from "node:url";

export const folder = process.env.LIBATLAS_PACKAGE;
if (!folder) throw new Error("set LIBATLAS_PACKAGE to the folder that tools/package.mjs has laid out");
export const inPackage = (name) => pathToFileURL(`${folder}/${name}`).href;
export const libatlas = await import(inPackage("node.js"));

// A closed box of sides 1, n x n squares a side, welded or not.
export function box(n = 4) {
  const positions = [], indices = [];
  for (let side = 0; side < 6; ++side) {
    const axis = side >> 1, first = positions.length / 3;
    for (let i = 0; i <= n; ++i) {
      for (let j = 0; j <= n; ++j) {
        const p = [0, 0, 0];
        p[axis] = side & 1;
        p[(axis + 1) % 3] = i / n;
        p[(axis + 2) % 3] = j / n;
        positions.push(...p);
      }
    }
    for (let i = 0; i < n; ++i) {
      for (let j = 0; j < n; ++j) {
        const a = first + i * (n + 1) + j, b = a + n + 1;
        const corners = side & 1 ? [a, b, b + 1, a, b + 1, a + 1] : [a, b + 1, b, a, a + 1, b + 1];
        indices.push(...corners);
      }
    }
  }
  return { positions: new Float32Array(positions), indices: new Uint32Array(indices) };
}

// A sphere with waves, of about 2 n^2 triangles.
export function waves(n = 40) {
  const positions = [], indices = [];
  for (let i = 0; i <= n; ++i) {
    for (let j = 0; j < n; ++j) {
      const u = (Math.PI * i) / n, v = (2 * Math.PI * j) / n, r = 1 + 0.2 * Math.sin(5 * u) * Math.cos(4 * v);
      positions.push(r * Math.sin(u) * Math.cos(v), r * Math.sin(u) * Math.sin(v), r * Math.cos(u));
      if (i === n) continue;
      const a = i * n + j, b = i * n + ((j + 1) % n);
      indices.push(a, a + n, b + n, a, b + n, b);
    }
  }
  return { positions: new Float32Array(positions), indices: new Uint32Array(indices) };
}

export const uvArea = ({ uvs, indices }, t) => {
  const [a, b, c] = [0, 1, 2].map((k) => 2 * indices[3 * t + k]);
  return ((uvs[b] - uvs[a]) * (uvs[c + 1] - uvs[a + 1]) - (uvs[c] - uvs[a]) * (uvs[b + 1] - uvs[a + 1])) / 2;
};
