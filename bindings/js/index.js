// libatlas in browsers; node.js is the same for Node.
import { compile } from "./lib/compile.js";
import { Library } from "./lib/library.js";
import { portOf } from "./lib/web-port.js";
import { WorkerLibrary } from "./lib/worker-library.js";

export { BadInputError, BadOptionError, CancelledError, InternalError, LibatlasError, NoSolutionError, OutOfMemoryError, UnsupportedError } from "./lib/errors.js";
export { gather } from "./lib/gather.js";

const address = () => new URL("./libatlas.wasm", import.meta.url);

export async function load({ wasm = address() } = {}) {
  return new Library(await compile(wasm));
}

// worker(): starts the file worker.js, for pages that have it elsewhere.
export async function startWorker({ wasm = address(), worker } = {}) {
  const start = worker ?? (() => new Worker(new URL("./worker.js", import.meta.url), { type: "module" }));
  return new WorkerLibrary(() => portOf(start()), await compile(wasm));
}
