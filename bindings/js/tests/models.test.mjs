// WebAssembly beside the native library: the same charts and uvs, in not much more time.
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { readFileSync, readdirSync } from "node:fs";
import { test } from "node:test";

import { fans, readObj } from "../playground/obj.js";
import { compared, native } from "./native.mjs";
import { inPackage, libatlas, waves } from "./support.mjs";

const program = process.env.LIBATLAS_NATIVE, models = process.env.LIBATLAS_DATA && `${process.env.LIBATLAS_DATA}/models`;
const atlas = await libatlas.load();

function secondsOf(work) {
  const begun = process.cpuUsage();
  work();
  const { user, system } = process.cpuUsage(begun);
  return (user + system) / 1e6;
}

test("the models have the native charts and uvs, within all bounds", { skip: !models && "this needs LIBATLAS_DATA" }, () => {
  const names = readdirSync(models).filter((name) => name.endsWith(".obj"));
  assert.ok(names.length >= 20);
  for (const name of names) {
    const mesh = fans(readObj(readFileSync(`${models}/${name}`, "utf8")));
    const result = atlas.unwrap(mesh);
    const { same, apart } = compared(native(program, mesh), result);
    assert.ok(same, name);
    assert.ok(apart <= 1e-6, `${name}: uvs differ by ${apart}`);
    assert.ok(result.stretch999 <= 1.25 && result.texelsDrawnTwice === 0, name);
  }
});

test("from 100 k triangles on, warm, WebAssembly takes at most 2.5 times the native CPU time", () => {
  for (const n of [224, 448]) {
    const mesh = waves(n);
    atlas.unwrap(mesh);
    const own = Math.min(...[0, 1].map(() => secondsOf(() => atlas.unwrap(mesh))));
    const { seconds } = native(program, mesh);
    console.log(`${mesh.indices.length / 3} triangles: ${own.toFixed(2)} s, native ${seconds.toFixed(2)} s`);
    assert.ok(own <= 2.5 * seconds, `${own} s, native ${seconds} s`);
  }
});

test("a first box is done half a second after the package begins to load", () => {
  const program = `const begun = performance.now();
    const { load } = await import(${JSON.stringify(inPackage("node.js"))});
    const atlas = await load();
    const { box } = await import(${JSON.stringify(new URL("support.mjs", import.meta.url).href)});
    atlas.unwrap(box(6));
    console.log(performance.now() - begun);`;
  const run = () => Number(execFileSync(process.execPath, ["--input-type=module", "-e", program], { encoding: "utf8" }));
  const best = Math.min(...[0, 1, 2].map(run));
  console.log(`${best.toFixed(0)} ms`);
  assert.ok(best <= 500, `${best} ms`);
});
