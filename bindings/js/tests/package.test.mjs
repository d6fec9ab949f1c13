// The package: what is in it, and that it works as ES module, as CommonJS and in workers.
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { readFileSync, readdirSync, statSync } from "node:fs";
import { createRequire } from "node:module";
import { test } from "node:test";
import { gzipSync } from "node:zlib";

import { structs } from "../lib/structs.js";
import { box, folder, inPackage, libatlas, waves } from "./support.mjs";

const { load, startWorker } = libatlas;

test("the structs are those of atlas.h", () => {
  const header = readFileSync(new URL("../../../libatlas/c/atlas.h", import.meta.url), "utf8").replace(/\/\/.*/g, "");
  const types = { size_t: "size", uint32_t: "u32", int32_t: "i32", libatlas_preset: "i32", float: "f32", double: "f64", uint64_t: "u64" };
  for (const [name, { members }] of Object.entries(structs)) {
    const body = header.match(new RegExp(`struct libatlas_${name} \\{([^}]*)\\}`))[1];
    const declared = [];
    for (const line of body.split(";").map((part) => part.trim()).filter(Boolean)) {
      const [, type, names] = line.match(/^(?:const )?(\w+\*?)\s+([^]*)$/);
      for (const member of names.split(",").map((word) => word.trim())) {
        if (type === "libatlas_extent") declared.push(["page_width", "i32"], ["page_height", "i32"]);
        else declared.push([member, type.endsWith("*") ? "pointer" : types[type]]);
      }
    }
    assert.deepEqual(Object.entries(members).map(([member, { type }]) => [member, type]), declared, name);
  }
});

test("the types name every option, error and result", () => {
  const types = readFileSync(`${folder}/index.d.ts`, "utf8");
  const camel = (name) => name.replace(/_([a-z0-9])/g, (_, c) => c.toUpperCase());
  for (const struct of ["unwrap_options", "island_options", "atlas_info", "charts"]) {
    for (const member of Object.keys(structs[struct].members)) {
      if (["size", "mesh_count", "page_count"].includes(member)) continue;
      assert.match(types, new RegExp(`\\b${camel(member)}\\??:`), member);
    }
  }
  for (const name of Object.keys(libatlas)) assert.match(types, new RegExp(`export (class|function) ${name}\\b`));
});

test("sizes", () => {
  const wasm = readFileSync(`${folder}/libatlas.wasm`);
  assert.ok(gzipSync(wasm, { level: 9 }).length <= 1e6);
  const all = readdirSync(folder, { recursive: true }).map((name) => `${folder}/${name}`).filter((name) => statSync(name).isFile());
  const packed = gzipSync(Buffer.concat(all.map((name) => readFileSync(name))), { level: 9 });
  assert.ok(packed.length <= 2.5e6, `${packed.length} bytes`);
});

test("CommonJS has the same calls", async () => {
  const common = createRequire(import.meta.url)(`${folder}/node.cjs`);
  assert.deepEqual(Object.keys(common).sort(), Object.keys(libatlas).sort());
  const atlas = await common.load();
  assert.deepEqual(atlas.unwrap(box()), (await load()).unwrap(box()));
  assert.throws(() => atlas.unwrap({}), common.BadInputError);
  const worker = await common.startWorker();
  assert.equal((await worker.unwrap(box())).meshes.length, 1);
  worker.terminate();
});

test("the package's version is the library's", async () => {
  const { version } = JSON.parse(readFileSync(`${folder}/package.json`, "utf8"));
  assert.equal((await load()).version, version);
});

test("what browsers load needs nothing of Node", async () => {
  const source = readFileSync(`${folder}/index.js`, "utf8");
  assert.doesNotMatch(source, /node:|process|Buffer/);
  for (const name of readdirSync(`${folder}/lib`)) {
    assert.doesNotMatch(readFileSync(`${folder}/lib/${name}`, "utf8"), /node:|\bprocess\.|\bBuffer\b/, name);
  }
  const web = await import(inPackage("index.js"));
  assert.deepEqual(Object.keys(web).sort(), Object.keys(libatlas).sort());
  const atlas = await web.load({ wasm: readFileSync(`${folder}/libatlas.wasm`) });
  assert.equal(atlas.unwrap(box()).meshes.length, 1);
});

test("a worker gives what the calls give, one after the other", async () => {
  const atlas = await load(), worker = await startWorker();
  const big = waves(), positions = new Float32Array([9, ...big.positions]).subarray(1);
  const [first, rects, islands] = await Promise.all([
    worker.unwrap({ ...big, positions }, { pageSize: 512 }),
    worker.packRects([10, 20, 30, 40]),
    worker.packIslands({ uvs: [0, 0, 1, 0, 1, 1] }),
  ]);
  assert.deepEqual(first, atlas.unwrap(big, { pageSize: 512 }));
  assert.deepEqual(rects, atlas.packRects([10, 20, 30, 40]));
  assert.deepEqual(islands, atlas.packIslands({ uvs: [0, 0, 1, 0, 1, 1] }));
  await assert.rejects(worker.unwrap({ ...box(), indices: [0, 1, 999] }), (e) => e instanceof libatlas.BadInputError && /index 999/.test(e.message));
  await assert.rejects(worker.unwrap(box(), { padding: -1 }), libatlas.BadOptionError);
  const stages = new Set();
  await worker.unwrap(big, { onProgress: (stage) => stages.add(stage) });
  assert.ok(stages.size >= 2);
  worker.terminate();
  await assert.rejects(worker.unwrap(box()), libatlas.CancelledError);
});

test("a signal ends a call in a worker at once, and later ones run", async () => {
  const worker = await startWorker(), big = waves(300);
  for (const delay of [0, 20, 60]) {
    const controller = new AbortController();
    const call = worker.unwrap(big, { signal: controller.signal }), next = worker.unwrap(box());
    await new Promise((done) => setTimeout(done, delay));
    const asked = performance.now();
    controller.abort();
    await assert.rejects(call, { name: "AbortError" });
    assert.ok(performance.now() - asked < 100);
    assert.equal((await next).meshes.length, 1);
    const before = process.cpuUsage();
    await new Promise((done) => setTimeout(done, 300));
    const { user, system } = process.cpuUsage(before);
    assert.ok(user + system < 100000, `something goes on: ${user + system} us`);
  }
  await assert.rejects(worker.unwrap(big, { onProgress: () => { throw new TypeError("mine"); } }), /mine/);
  const running = worker.unwrap(big);
  setTimeout(() => worker.terminate(), 20);
  await assert.rejects(running, libatlas.CancelledError);
});

test("an idle worker lets the program end", () => {
  const program = `import { startWorker } from ${JSON.stringify(inPackage("node.js"))};
    const worker = await startWorker();
    console.log((await worker.packRects([1, 2])).pages.length);`;
  assert.equal(execFileSync(process.execPath, ["--input-type=module", "-e", program], { encoding: "utf8", timeout: 20000 }).trim(), "1");
});
