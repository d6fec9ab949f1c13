// The calls of a Library, made in a worker. They return promises, and wait for each other.
import { CancelledError, InternalError, unpackedError } from "./errors.js";
import { tightMesh } from "./library.js";

// Clones of a view have the whole of its buffer.
function withOwnBuffers(object) {
  const own = (value) =>
    ArrayBuffer.isView(value) && value.byteLength < value.buffer.byteLength ? value.slice() : value;
  return Object.fromEntries(Object.entries(object).map(([name, value]) => [name, own(value)]));
}

export class WorkerLibrary {
  #start;
  #module;
  #port = null;
  #last = Promise.resolve();
  #ended = false;
  #stop = null;  // of the call that runs: ends it with an error

  // start(): a new worker as { post(message), listen(callback), fail(callback), busy(boolean), terminate() }
  constructor(start, module) {
    this.#start = start;
    this.#module = module;
    this.#worker();
  }

  async unwrap(meshes, options) {
    const list = (Array.isArray(meshes) ? meshes : [meshes]).map(tightMesh).map(withOwnBuffers);
    return this.#queue("unwrap", list, options);
  }

  async packRects(rects, options) {
    return this.#queue("packRects", rects, options);
  }

  async packIslands(islands, options) {
    return this.#queue("packIslands", islands, options);
  }

  // Ends the worker. Calls that have not ended are rejected.
  terminate() {
    this.#ended = true;
    this.#stop?.(new CancelledError("the worker was terminated"));
    this.#port?.terminate();
    this.#port = null;
  }

  #worker() {
    if (this.#port) return this.#port;
    this.#port = this.#start();
    this.#port.post({ module: this.#module });
    return this.#port;
  }

  #queue(call, given, options = {}) {
    const result = this.#last.then(() => this.#send(call, given, options));
    this.#last = result.catch(() => {});
    return result;
  }

  // WebAssembly hears no messages while it runs: whoever gives up ends the worker, and the next call
  // starts another.
  #send(call, given, { onProgress, onWarning, signal, ...options }) {
    signal?.throwIfAborted();
    if (this.#ended) throw new CancelledError("the worker was terminated");
    const port = this.#worker();
    return new Promise((resolve, reject) => {
      const settle = (finish, value) => {
        signal?.removeEventListener("abort", abort);
        this.#stop = null;
        port.busy(false);
        finish(value);
      };
      this.#stop = (error) => {
        port.terminate();
        this.#port = null;
        settle(reject, error);
      };
      const abort = () => this.#stop?.(signal.reason);
      signal?.addEventListener("abort", abort);
      port.listen((message) => this.#hear(message, { onProgress, onWarning }, resolve, reject, settle));
      port.fail((error) => this.#stop?.(new InternalError(`the worker failed: ${error?.message ?? "no reason given"}`)));
      port.busy(true);
      try {
        port.post({ call, given, options });
      } catch (error) {  // what cannot be cloned
        settle(reject, error);
      }
    });
  }

  #hear(message, { onProgress, onWarning }, resolve, reject, settle) {
    if (!this.#stop) return;
    if ("result" in message) settle(resolve, message.result);
    else if (message.error) settle(reject, unpackedError(message.error));
    else {
      try {
        if ("warning" in message) onWarning?.(message.warning);
        else onProgress?.(message.stage, message.fraction);
      } catch (error) {
        this.#stop?.(error);
      }
    }
  }
}
