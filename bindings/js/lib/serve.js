// The side of a worker: does what its WorkerLibrary asks for.
import { packedError } from "./errors.js";
import { Library } from "./library.js";

// The buffers of a result, which are handed over instead of copied.
function buffersOf(value, found = new Set()) {
  if (ArrayBuffer.isView(value)) found.add(value.buffer);
  else if (value && typeof value === "object") Object.values(value).forEach((inner) => buffersOf(inner, found));
  return [...found];
}

// port: { post(message, buffers), listen(callback) }
export function serve(port) {
  let library;
  port.listen(({ module, call, given, options }) => {
    if (module) {
      library = new Library(module);
      return;
    }
    const listener = {
      onProgress: (stage, fraction) => port.post({ stage, fraction }),
      onWarning: (warning) => port.post({ warning }),
    };
    try {
      const result = library[call](given, { ...options, ...listener });
      port.post({ result }, buffersOf(result));
    } catch (error) {
      port.post({ error: packedError(error) });
    }
  });
}
