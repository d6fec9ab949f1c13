// libatlas in Node; index.js is the same for browsers.
import { readFile } from "node:fs/promises";
import { Worker } from "node:worker_threads";

import { compile } from "./lib/compile.js";
import { Library } from "./lib/library.js";
import { WorkerLibrary } from "./lib/worker-library.js";

export { BadInputError, BadOptionError, CancelledError, InternalError, LibatlasError, NoSolutionError, OutOfMemoryError, UnsupportedError } from "./lib/errors.js";
export { gather } from "./lib/gather.js";

const besides = (name) => new URL(name, import.meta.url);
const compiled = async (wasm) => compile(wasm ?? (await readFile(besides("./libatlas.wasm"))));

export async function load({ wasm } = {}) {
  return new Library(await compiled(wasm));
}

export async function startWorker({ wasm, worker } = {}) {
  const start = worker ?? (() => new Worker(besides("./worker-node.js"), { execArgv: [] }));  // some options fail there
  return new WorkerLibrary(() => portOf(start()), await compiled(wasm));
}

function portOf(worker) {
  worker.unref();  // an idle worker does not keep the program running
  return {
    post: (message) => worker.postMessage(message),
    listen: (callback) => worker.removeAllListeners("message").on("message", callback),
    fail: (callback) => worker.removeAllListeners("error").on("error", callback),
    busy: (busy) => (busy ? worker.ref() : worker.unref()),
    terminate: () => worker.terminate(),
  };
}
