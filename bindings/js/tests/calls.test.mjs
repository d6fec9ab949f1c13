// The calls, in this thread.
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { test } from "node:test";

import { box, folder, libatlas, uvArea, waves } from "./support.mjs";

const { BadInputError, BadOptionError, LibatlasError, NoSolutionError, OutOfMemoryError, gather, load } = libatlas;
const atlas = await load();
const mesh = waves();

test("a mesh becomes charts whose triangles keep their places and lie face up in 0..1", () => {
  const { meshes: [result], pages, ...figures } = atlas.unwrap(mesh);
  assert.equal(result.indices.length, mesh.indices.length);
  result.indices.forEach((v, i) => assert.equal(result.vertices[v], mesh.indices[i]));
  assert.ok(result.uvs.every((x) => x >= 0 && x <= 1));
  const up = Array.from(result.triangleChart, (_, t) => uvArea(result, t)).filter((area) => area > 0).length;
  assert.ok(up >= result.triangleChart.length - 80, `${up} triangles`);  // 80 at the poles have no area
  assert.equal(figures.flippedTriangles, 0);
  assert.equal(figures.chartCount, Math.max(...result.triangleChart) + 1);
  assert.equal(figures.charts.area.length, figures.chartCount);
  assert.ok(figures.stretchL2 >= 1 && figures.stretchL2 < 1.05);
  assert.ok(pages.length === 1 && Math.max(pages[0].width, pages[0].height) <= 2048);
});

test("options reach the library, by their names here", () => {
  const { pages, stretch999 } = atlas.unwrap(mesh, { pageSize: 256, square: true, maxStretch: 1.1, charts: "fast", packing: "fast" });
  assert.deepEqual(pages, [{ width: 256, height: 256 }]);
  assert.ok(stretch999 <= 1.1);
  const padded = atlas.unwrap(box(), { padding: 40, pageSize: 256 }), plain = atlas.unwrap(box(), { pageSize: 256 });
  assert.ok(padded.texelsPerUnit < plain.texelsPerUnit);
  const sized = atlas.unwrap(box(), { texelsPerUnit: 50 });
  assert.equal(sized.texelsPerUnit, 50);
  const lightmap = atlas.unwrap(box(), { lightmap: { texelsPerMetre: 32 } });
  assert.equal(lightmap.texelsPerUnit, 32);
  assert.equal(lightmap.pages[0].width, lightmap.pages[0].height);
});

test("several meshes share an atlas, in which density counts", () => {
  const { meshes, charts } = atlas.unwrap([box(), { ...box(), density: 2 }]);
  assert.equal(meshes.length, 2);
  const size = (m) => m.triangleChart.reduce((sum, _, t) => sum + uvArea(m, t), 0);
  assert.ok(Math.abs(size(meshes[1]) / size(meshes[0]) - 4) < 0.1);
  assert.deepEqual([...new Set(charts.mesh)], [0, 1]);
});

test("arrays of any type, interleaved ones, and none of indices", () => {
  const wanted = atlas.unwrap(mesh).meshes[0];
  const same = (given) => assert.deepEqual(atlas.unwrap(given).meshes[0], wanted);
  const vertices = mesh.positions.length / 3;
  const interleaved = new Float32Array(8 * vertices).fill(7);
  for (let v = 0; v < vertices; ++v) interleaved.set(mesh.positions.subarray(3 * v, 3 * v + 3), 8 * v + 5);
  same({ ...mesh, positions: { array: interleaved, offset: 5, stride: 8 } });
  same({ ...mesh, positions: { array: interleaved, offset: 5, stride: 8, count: vertices } });
  same({ positions: [...mesh.positions], indices: [...mesh.indices] });
  same({ positions: Float64Array.from(mesh.positions), indices: Uint16Array.from(mesh.indices) });
  same({ ...mesh, indices: Int32Array.from(mesh.indices) });
  const longer = new Float32Array(mesh.positions.length + 9);
  longer.set(mesh.positions, 6);
  same({ ...mesh, positions: longer.subarray(6, 6 + mesh.positions.length) });
  const soup = gather(mesh.positions, mesh.indices, 3);
  assert.deepEqual(atlas.unwrap({ positions: soup }).meshes[0].uvs.length, 2 * atlas.unwrap({ positions: soup }).meshes[0].vertices.length);
});

test("given uvs are kept", () => {
  const first = atlas.unwrap(mesh).meshes[0];
  const texcoords = { texcoords: first.uvs, texcoordIndices: first.indices };
  const { keptCharts, reflattenedCharts } = atlas.unwrap({ ...mesh, ...texcoords }, { keepUvs: true });
  assert.ok(keptCharts > 0);
  assert.equal(reflattenedCharts, 0);
  assert.equal(atlas.unwrap({ ...mesh, ...texcoords }).keptCharts, 0);
});

test("charts stay like those of an earlier result, and what was edited is named", () => {
  const { meshes: [before], pages } = atlas.unwrap(mesh), removed = 3 * 1500;
  const { uvs, indices: uvIndices, trianglePage } = before;
  const like = { ...mesh, uvs, uvIndices, trianglePage, pages };
  const indices = mesh.indices.filter((_, i) => i < removed || i >= removed + 3);
  const { meshes: [now], charts, pages: grown } = atlas.unwrap({ ...mesh, indices }, { like });
  const side = ["width", "height"], kept = 2;
  let same = 0;
  now.indices.forEach((v, i) => {
    if (charts.origins[now.triangleChart[Math.floor(i / 3)]] !== kept) return;
    const was = before.indices[i < removed ? i : i + 3];
    for (const k of [0, 1]) {
      const texels = [now.uvs[2 * v + k] * grown[0][side[k]], before.uvs[2 * was + k] * pages[0][side[k]]];
      assert.ok(Math.abs(texels[0] - texels[1]) < 0.01, texels);
    }
    ++same;
  });
  assert.ok(same > now.indices.length / 4 && same < now.indices.length);
  assert.equal(atlas.unwrap(mesh).charts.origins.length, 0);
  const refused = (wrong, message) =>
    assert.throws(() => atlas.unwrap(mesh, { like: { ...like, ...wrong } }), { name: "BadInputError", message });
  refused({ uvIndices: [0, 1, 2] }, /^like: uvIndices has 3 numbers instead of/);
  refused({ trianglePage: [0] }, /^like: trianglePage has 1 numbers/);
  refused({ positions: null }, /^like: positions are missing/);
  refused({ pages: [] }, /no page/);
  refused({ positions: Float32Array.from(mesh.positions).fill(NaN, 15, 16) }, /position 5 is not finite/);
});

test("edges that are marked become seams, and seams are returned", () => {
  const flat = { positions: [0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0], indices: [0, 1, 2, 0, 2, 3] };
  const { chartCount, meshes: [whole] } = atlas.unwrap(flat, { seams: true });
  assert.equal(chartCount, 1);
  assert.deepEqual([...whole.seams], [0, 0, 0, 0, 0, 0]);
  const cut = atlas.unwrap({ ...flat, seams: [0, 0, 1, 0, 0, 0] }, { seams: true });
  assert.equal(cut.chartCount, 2);
  assert.deepEqual([...cut.meshes[0].seams], [0, 0, 1, 1, 0, 0]);
  assert.equal(atlas.unwrap({ ...flat, materials: [0, 1] }).chartCount, 2);
  assert.equal(atlas.unwrap({ ...flat, materials: [0, 1] }, { splitAtMaterials: false }).chartCount, 1);
});

test("polygons stay whole, and each corner has a uv", () => {
  const cube = { positions: [0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0, 0, 0, 1, 1, 0, 1, 1, 1, 1, 0, 1, 1],
    indices: [3, 2, 1, 0, 4, 5, 6, 7, 0, 1, 5, 4, 1, 2, 6, 5, 2, 3, 7, 6, 3, 0, 4, 7], polygonSizes: [4, 4, 4, 4, 4, 4] };
  const { meshes: [result] } = atlas.unwrap(cube, { seams: true });
  assert.equal(result.indices.length, 36);
  assert.equal(result.seams.length, 24);
  assert.deepEqual(Array.from(result.corners, (v) => result.vertices[v]), cube.indices);
  assert.deepEqual([...result.trianglePolygon], [0, 0, 1, 1, 2, 2, 3, 3, 4, 4, 5, 5]);
  assert.equal(result.cutPolygons.length, 0);
});

test("instances are unwrapped once, and have places apart by density", () => {
  const { meshes: [result, other], pages } = atlas.unwrap([{ ...mesh, instances: [1, 2, 1] }, box()], { pageSize: 1024 });
  const { page, scale, offset } = result.instances;
  assert.deepEqual([...page], [0, 0, 0]);
  assert.ok(Math.abs(scale[2] / scale[0] - 2) < 0.05);
  const places = [0, 1, 2].map((i) => [0, 1].map((k) => [offset[2 * i + k], offset[2 * i + k] + scale[2 * i + k]]));
  for (const sides of places) assert.ok(sides.every(([low, high]) => low >= 0 && high <= 1 + 1e-6));  // of floats
  const apart = (a, b) => [0, 1].some((k) => a[k][1] <= b[k][0] || b[k][1] <= a[k][0]);
  assert.ok(apart(places[0], places[1]) && apart(places[0], places[2]) && apart(places[1], places[2]));
  assert.equal(other.instances, undefined);
  assert.equal(pages.length, 1);
  assert.throws(() => atlas.unwrap({ ...mesh, instances: [1, 0] }), BadInputError);
  assert.throws(() => atlas.unwrap({ ...mesh, instances: [] }), BadInputError);
});

test("values at vertices become a texture that shows them", () => {
  const grid = waves(), values = Float32Array.from(grid.positions, (x, i) => 0.5 + 0.3 * x + (i % 3) / 10);
  const { meshes: [result], pages: [page], textures } = atlas.unwrap({ ...grid, values }, { pageSize: 512 });
  assert.equal(textures.length, 1);
  assert.equal(textures[0].length, 3 * page.width * page.height);
  let worst = 0, sum = 0, count = 0;
  for (let v = 0; v < result.vertices.length; v += 7) {
    const x = result.uvs[2 * v] * page.width - 0.5, y = result.uvs[2 * v + 1] * page.height - 0.5;
    const left = Math.floor(x), low = Math.floor(y);
    for (let k = 0; k < 3; ++k) {
      let shown = 0;
      for (const [i, j] of [[0, 0], [1, 0], [0, 1], [1, 1]]) {
        const weight = (i ? x - left : 1 - x + left) * (j ? y - low : 1 - y + low);
        shown += weight * textures[0][3 * ((low + j) * page.width + left + i) + k];
      }
      const error = Math.abs(shown - values[3 * result.vertices[v] + k]);
      worst = Math.max(worst, error);
      sum += error;
      ++count;
    }
  }
  assert.ok(worst < 0.03 && sum / count < 0.001, `${worst}, in the mean ${sum / count}`);  // of 0.2 to 0.9
  assert.equal(atlas.unwrap(grid).textures, undefined);
  assert.throws(() => atlas.unwrap([{ ...box(), values: new Float32Array(box().positions.length) }, box()]), /mesh 1: values are missing/);
  assert.throws(() => atlas.unwrap({ ...box(), values: [1, 2, 3] }), /mesh 0: values has 3 numbers instead of/);
  assert.throws(() => atlas.unwrap({ ...grid, values }, { shifts: 65 }), BadOptionError);
  assert.throws(() => atlas.unwrap({ ...grid, values: values.map(() => NaN) }), BadInputError);
});

test("progress rises to 1 in each stage, and an aborted signal ends the call", () => {
  const stages = new Map();
  atlas.unwrap(mesh, { onProgress: (stage, fraction) => stages.set(stage, fraction) });
  assert.ok(stages.size >= 2);
  for (const fraction of stages.values()) assert.equal(fraction, 1);
  const controller = new AbortController();
  let told = 0;
  const options = { signal: controller.signal, onProgress: () => ++told === 3 && controller.abort(new Error("enough")) };
  assert.throws(() => atlas.unwrap(mesh, options), /enough/);
  assert.ok(told < 10, `told ${told} times`);
  assert.throws(() => atlas.unwrap(mesh, { signal: AbortSignal.abort() }), { name: "AbortError" });
  assert.throws(() => atlas.unwrap(mesh, { onProgress: () => { throw new TypeError("mine"); } }), /mine/);
  assert.equal(atlas.unwrap(mesh).meshes.length, 1);  // as if nothing had been
});

test("callbacks cannot call the library", () => {
  assert.throws(() => atlas.unwrap(mesh, { onProgress: () => atlas.unwrap(mesh) }), /callbacks cannot/);
  assert.equal(atlas.unwrap(box()).meshes.length, 1);
});

test("wrong input is an error that names the mesh and the element", () => {
  const cases = [
    [{ indices: [0, 1, 2] }, /mesh 0: positions are missing/],
    [{ positions: [0, 0, 0, 1] }, /mesh 0: positions has 4 numbers/],
    [{ positions: [0, 0, NaN, 1, 0, 0, 0, 1, 0] }, /mesh 0.*position/],
    [{ ...box(), indices: [0, 1, 5000] }, /mesh 0: triangle 0: vertex index 5000/],
    [{ ...box(), indices: [0, 1, -1] }, /mesh 0: indices\[2\] is -1/],
    [{ ...box(), indices: [0, 1, 1.5] }, /mesh 0: indices\[2\] is 1.5/],
    [{ ...box(), indices: [0, 1, 2, 0] }, /4 indices/],
    [{ ...box(), materials: [1] }, /materials has 1 numbers instead of 192/],
    [{ ...box(), normals: [1, 0, 0] }, /normals has 3 numbers/],
    [{ ...box(), positions: "abc" }, /positions is neither/],
    [{ ...box(), positions: new BigInt64Array(9) }, /BigInt/],
    [{ ...box(), positions: { array: new Float32Array(9), stride: 4, count: 3 } }, /reach beyond/],
    [{ ...box(), density: 0 }, /density/],
    [{ positions: [], indices: [] }, /./],
  ];
  for (const [given, message] of cases) assert.throws(() => atlas.unwrap(given), (e) => e instanceof LibatlasError && message.test(e.message), String(message));
  assert.throws(() => atlas.unwrap([box(), { ...box(), indices: [0, 1, 999] }]), /mesh 1/);
  assert.throws(() => atlas.unwrap([]), BadInputError);
});

test("wrong options are errors that name the option", () => {
  const cases = [{ paddding: 3 }, { padding: 1.5 }, { padding: "2" }, { padding: -1 }, { pageSize: 1 }, { maxStretch: NaN },
    { maxStretch: 0.5 }, { square: 1 }, { charts: "slow" }, { pages: -1 }, { mipLevels: 99 }, { lightmap: { texelsPerMetre: -1 } }];
  for (const options of cases) assert.throws(() => atlas.unwrap(box(), options), BadOptionError, JSON.stringify(options));
  assert.throws(() => atlas.unwrap(box(), { paddding: 3 }), /paddding.*padding/);
  const soup = gather(mesh.positions, mesh.indices, 3).map((x, i) => x + 10 * Math.floor(i / 9));  // triangles apart
  assert.throws(() => atlas.unwrap({ positions: soup }, { pageSize: 64, padding: 2 }), NoSolutionError);
  assert.equal(atlas.unwrap(box(), { padding: undefined }).meshes.length, 1);
});

// The library with a smaller limit of memory: 384 pages of 64 KiB instead of 65536.
function withLittleMemory() {
  const wasm = readFileSync(`${folder}/libatlas.wasm`), memorySection = 5;
  let at = 8;
  const number = () => {
    let value = 0;
    for (let shift = 0; ; shift += 7) {
      value += (wasm[at] & 0x7f) * 2 ** shift;
      if (wasm[at++] < 0x80) return value;
    }
  };
  for (let section; (section = wasm[at++]) !== memorySection;) {
    const length = number();
    at += length;
  }
  number();
  assert.deepEqual([...wasm.subarray(at, at + 2)], [1, 1]);  // one memory, with a limit
  at += 2;
  assert.ok(number() < 384);
  const limit = at;
  assert.equal(number(), 65536);
  for (let place = limit; place < at; ++place) wasm[place] = 0x80;
  wasm[limit + 1] |= 3;
  wasm[at - 1] &= 0x7f;
  return wasm;
}

test("what memory does not hold is an error, after which the library works", async () => {
  const small = await load({ wasm: withLittleMemory() });
  for (let i = 0; i < 3; ++i) {
    assert.throws(() => small.unwrap(waves(300)), OutOfMemoryError);
    assert.deepEqual(small.unwrap(waves(60)), atlas.unwrap(waves(60)));  // which little more than fits
  }
});

test("memory is used again", async () => {
  const small = await load({ wasm: withLittleMemory() });
  const rects = new Int32Array(40000).fill(3);
  for (let i = 0; i < 150; ++i) small.packRects(rects, { preset: "fast" });
});

test("rectangles are packed", () => {
  const rects = Int32Array.from({ length: 200 }, (_, i) => 5 + ((i * 7919) % 40));
  const packed = atlas.packRects(rects, { page: { width: 200, height: 200 }, padding: 1, allowRotation: true });
  assert.equal(packed.unplacedCount, 0);
  const seen = new Set();
  for (let i = 0; i < 100; ++i) {
    const [w, h] = packed.rotated[i] ? [rects[2 * i + 1], rects[2 * i]] : [rects[2 * i], rects[2 * i + 1]];
    assert.ok(packed.x[i] >= 0 && packed.x[i] + w <= 200 && packed.y[i] + h <= 200);
    for (let y = packed.y[i]; y < packed.y[i] + h; ++y) {
      for (let x = packed.x[i]; x < packed.x[i] + w; ++x) {
        const texel = (packed.page[i] * 200 + y) * 200 + x;
        assert.ok(!seen.has(texel));
        seen.add(texel);
      }
    }
  }
  const { page, unplacedCount } = atlas.packRects([300, 10, 10, 10], { page: { width: 200, height: 200 } });
  assert.deepEqual([...page, unplacedCount], [-1, 0, 1]);
  assert.throws(() => atlas.packRects([-1, 2]), BadInputError);
  assert.throws(() => atlas.packRects([1, 2, 3]), BadInputError);
});

test("islands are packed", () => {
  const { meshes: [{ uvs, indices }], chartCount } = atlas.unwrap(mesh);
  const packed = atlas.packIslands({ uvs, indices }, { pageSize: 512, padding: 4 });
  assert.equal(packed.islandPage.length, chartCount);
  assert.equal(packed.uvs.length, uvs.length);
  const sides = packed.pages[0];
  assert.ok(Math.max(sides.width, sides.height) <= 512 && packed.uvs.every((x) => x >= 0 && x <= 1));
  assert.throws(() => atlas.packIslands({ uvs, indices: [0, 1, 1e6] }), BadInputError);
});

test("a cleared library gives the same again", () => {
  const first = atlas.unwrap(mesh);
  atlas.unwrap(waves(60));
  assert.deepEqual(atlas.unwrap(mesh), first);
});
