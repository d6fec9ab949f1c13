// Makes the playground, one file with everything in it: node playground.mjs PAGE.html LIBATLAS_WASM
import { readFileSync, writeFileSync } from "node:fs";
import { fileURLToPath } from "node:url";
import { gzipSync } from "node:zlib";

import { join } from "./join.mjs";

const [, , page, wasm] = process.argv;
const source = (name) => fileURLToPath(new URL(`../${name}`, import.meta.url));
const alone = (name) => `(() => {\n"use strict";\n${join(source(name)).text}\n})();`.replaceAll("</script", "<\\/script");
const parts = {
  STYLE: readFileSync(source("playground/page.css"), "utf8"),
  WORKER: alone("worker.js"),
  WASM: gzipSync(readFileSync(wasm), { level: 9 }).toString("base64"),
  APP: alone("playground/app.js"),
};
const text = readFileSync(source("playground/page.html"), "utf8");
writeFileSync(page, text.replace(/\/\*(STYLE|WORKER|WASM|APP)\*\//g, (_, name) => parts[name]));
