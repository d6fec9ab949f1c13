// Lays out the npm package: node package.mjs FOLDER LIBATLAS_WASM
import { copyFileSync, cpSync, mkdirSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { join as path } from "node:path";
import { fileURLToPath } from "node:url";

import { commonJs } from "./join.mjs";

const sources = fileURLToPath(new URL("..", import.meta.url));
const [, , folder, wasm] = process.argv;
rmSync(folder, { recursive: true, force: true });
mkdirSync(folder, { recursive: true });
for (const name of ["package.json", "README.md", "index.js", "node.js", "worker.js", "worker-node.js", "gltf-transform.js",
  "index.d.ts", "gltf-transform.d.ts"]) {
  copyFileSync(path(sources, name), path(folder, name));
}
cpSync(path(sources, "lib"), path(folder, "lib"), { recursive: true });
copyFileSync(path(sources, "../../LICENSE"), path(folder, "LICENSE"));
copyFileSync(wasm, path(folder, "libatlas.wasm"));
for (const name of ["index", "gltf-transform"]) {
  writeFileSync(path(folder, `${name}.d.cts`), readFileSync(path(sources, `${name}.d.ts`), "utf8").replace("./index.js", "./index.cjs"));
}
for (const name of ["node", "gltf-transform"]) {
  writeFileSync(path(folder, `${name}.cjs`), commonJs(path(sources, `${name}.js`)));
}
