// libatlas beside watlas (xatlas as WebAssembly): the table of docs/javascript.md.
// After npm ci in this folder: node compare.mjs FOLDER_OF_THE_PACKAGE MODEL.obj ... > table.md
// Each unwraps each mesh in a process of its own, warm (it was unwrapped before; of more than 50 k triangles: another
// one was), on one thread, with a page of 2048 texels and 2 texels of padding. Both results are measured by the same function. A process may take 5 minutes.
import { execFileSync } from "node:child_process";
import { readFileSync } from "node:fs";
import { basename } from "node:path";
import { fileURLToPath, pathToFileURL } from "node:url";

import { fans, readObj } from "../../bindings/js/playground/obj.js";

const limit = 300;
const [, self, folder, ...rest] = process.argv;
process.env.LIBATLAS_PACKAGE = folder;
const { waves } = await import("../../bindings/js/tests/support.mjs");

const engines = {
  async libatlas() {
    const { load } = await import(pathToFileURL(`${folder}/node.js`));
    const atlas = await load();
    return (mesh) => {
      const { meshes: [{ vertices, uvs, indices }], pages: [page], chartCount } = atlas.unwrap(mesh);
      return { vertices, uvs, indices, chartCount, ...page };
    };
  },
  async watlas() {
    const watlas = await import("watlas");
    await watlas.Initialize();
    return ({ positions, indices }) => {
      const atlas = new watlas.Atlas();
      atlas.addMesh({ vertexPositionData: positions, vertexCount: positions.length / 3, vertexPositionStride: 12,
        indexData: indices, indexCount: indices.length });
      atlas.generate({}, { padding: 2, resolution: 2048 });
      const mesh = atlas.getMesh(0), count = mesh.vertexCount;
      const result = { vertices: new Uint32Array(count), uvs: new Float64Array(2 * count), indices: new Uint32Array(mesh.indexCount),
        chartCount: atlas.chartCount, width: atlas.width, height: atlas.height, pages: atlas.atlasCount };
      for (let v = 0; v < count; ++v) {
        const { xref, uv } = mesh.getVertex(v);
        result.vertices[v] = xref;
        result.uvs.set([uv[0] / atlas.width, uv[1] / atlas.height], 2 * v);
      }
      mesh.getIndexArray(result.indices);
      return result;
    };
  },
};

// L2 stretch (Sander et al. 2001), seams over the square root of the area, use of the page, triangles turned over.
function measured({ positions }, { vertices, uvs, indices, width, height }) {
  const point = (v) => positions.subarray(3 * vertices[v], 3 * vertices[v] + 3);
  let area3 = 0, area2 = 0, squares = 0;
  const chart = chartsOf(indices, vertices.length), sides = new Map();  // of each chart: triangles this and that way up
  for (let t = 0; t < indices.length; t += 3) {
    const corners = [0, 1, 2].map((k) => indices[t + k]), [p, q, r] = corners.map(point);
    const [s, u] = [q, r].map((x) => x.map((value, k) => value - p[k]));
    const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    const area = Math.sqrt(Math.max(0, dot(s, s) * dot(u, u) - dot(s, u) ** 2)) / 2;
    const [[ax, ay], [bx, by], [cx, cy]] = corners.map((v) => [uvs[2 * v] * width, uvs[2 * v + 1] * height]);
    const signed = ((bx - ax) * (cy - ay) - (cx - ax) * (by - ay)) / 2;
    area3 += area;
    area2 += Math.abs(signed);
    if (area <= 0) continue;
    if (signed === 0) continue;
    const own = chart(indices[t]);
    if (!sides.has(own)) sides.set(own, [0, 0]);
    ++sides.get(own)[signed < 0 ? 1 : 0];
    const du = p.map((_, k) => (p[k] * (by - cy) + q[k] * (cy - ay) + r[k] * (ay - by)) / (2 * signed));
    const dv = p.map((_, k) => (p[k] * (cx - bx) + q[k] * (ax - cx) + r[k] * (bx - ax)) / (2 * signed));
    squares += (area * (dot(du, du) + dot(dv, dv))) / 2;
  }
  return { l2: Math.sqrt((squares / area3) * (area2 / area3)), seams: seamLength(positions, vertices, indices) / Math.sqrt(area3),
    use: area2 / (width * height), over: [...sides.values()].reduce((sum, both) => sum + Math.min(...both), 0) };
}

// Triangles that share a vertex are one chart. Returns a function from vertices to charts.
function chartsOf(indices, count) {
  const parent = Uint32Array.from({ length: count }, (_, v) => v);
  const root = (v) => {
    while (parent[v] !== v) v = parent[v] = parent[parent[v]];
    return v;
  };
  for (let t = 0; t < indices.length; t += 3) for (const k of [1, 2]) parent[root(indices[t + k])] = root(indices[t]);
  return root;
}

// Of edges that two triangles share in space, but not in uv.
function seamLength(positions, vertices, indices) {
  const places = new Map(), place = Uint32Array.from({ length: positions.length / 3 }, (_, v) => {
    const key = positions.subarray(3 * v, 3 * v + 3).join();
    return places.get(key) ?? (places.set(key, v), v);
  });
  const edges = new Map(), count = positions.length / 3;
  let length = 0;
  indices.forEach((v, i) => {
    const w = indices[i % 3 === 2 ? i - 2 : i + 1], [a, b] = [place[vertices[v]], place[vertices[w]]];
    const key = Math.min(a, b) * count + Math.max(a, b), uvKey = `${Math.min(v, w)},${Math.max(v, w)}`;
    if (edges.has(key) && edges.get(key) !== uvKey) length += Math.hypot(...[0, 1, 2].map((k) => positions[3 * a + k] - positions[3 * b + k]));
    edges.set(key, uvKey);
  });
  return length;
}

const meshOf = (name) => (name.startsWith("waves") ? waves(Number(name.slice(5))) : fans(readObj(readFileSync(name, "utf8"))));

async function one(engine, name) {
  const unwrap = await engines[engine](), mesh = meshOf(name);
  unwrap(mesh.indices.length > 150000 ? waves(60) : mesh);
  const begun = process.cpuUsage(), result = unwrap(mesh), { user, system } = process.cpuUsage(begun);
  return { seconds: (user + system) / 1e6, charts: result.chartCount, ...measured(mesh, result) };
}

function asked(engine, name) {
  try {
    return JSON.parse(execFileSync(process.execPath, [self, folder, "--one", engine, name],
      { encoding: "utf8", timeout: limit * 1000, stdio: ["ignore", "pipe", "ignore"] }));
  } catch {
    return null;
  }
}

if (rest[0] === "--one") {
  console.log(JSON.stringify(await one(rest[1], rest[2])));
} else {
  const row = (r) => (r ? [r.charts, r.l2.toFixed(4), r.seams.toFixed(1), r.use.toFixed(2), r.over, r.seconds.toFixed(2)] : Array(5).fill("–").concat(`over ${limit}`));
  console.log(`| mesh | triangles | charts | L2 | seams | page use | turned over | CPU s | charts | L2 | seams | page use | turned over | CPU s |`);
  console.log(`|---|---|${"---|".repeat(12)}`);
  for (const name of [...rest, "waves224", "waves448"]) {
    const triangles = meshOf(name).indices.length / 3;
    console.log(`| ${[basename(name, ".obj"), triangles, ...row(asked("libatlas", name)), ...row(asked("watlas", name))].join(" | ")} |`);
  }
}
