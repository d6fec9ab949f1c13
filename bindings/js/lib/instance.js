// The compiled library with a memory of its own, and calls into it.
import { OutOfMemoryError, errorOf } from "./errors.js";
import { structs } from "./structs.js";

const text = new TextDecoder();

export class Instance {
  #exports;
  #context;
  #listener = null;
  #views = {};

  constructor(module) {
    const imports = {
      javascript: {
        progress: (stage, fraction) => (this.#listener?.progress?.(this.string(stage), fraction) ? 1 : 0),
        warning: (line) => this.#listener?.warning?.(this.string(line)),
        out_of_memory: () => {
          throw new OutOfMemoryError("the mesh needs more memory than WebAssembly can address or the system grants");
        },
      },
      env: { emscripten_notify_memory_growth() {} },
      wasi_snapshot_preview1: {
        proc_exit(code) {
          throw new WebAssembly.RuntimeError(`exit ${code}`);
        },
        // Of any clock: time since some moment, in nanoseconds.
        clock_time_get: (clock, precision, place) => {
          const now = BigInt(Math.round(performance.now() * 1e6));
          new DataView(this.#exports.memory.buffer).setBigUint64(place, now, true);
          return 0;
        },
        environ_sizes_get: (count, size) => {
          this.u32[count >>> 2] = this.u32[size >>> 2] = 0;
          return 0;
        },
        environ_get: () => 0,
      },
    };
    this.#exports = new WebAssembly.Instance(module, imports).exports;
    this.#exports._initialize();
    this.#context = this.#exports.create_context();
  }

  get memoryBytes() {
    return this.#exports.memory.buffer.byteLength;
  }

  // Views of the memory, which is another buffer once it has grown.
  #view(type) {
    const { buffer } = this.#exports.memory;
    if (this.#views[type.name]?.buffer !== buffer) this.#views[type.name] = new type(buffer);
    return this.#views[type.name];
  }
  get u8() {
    return this.#view(Uint8Array);
  }
  get u32() {
    return this.#view(Uint32Array);
  }

  string(place) {
    const start = place >>> 0;
    return text.decode(this.u8.subarray(start, this.u8.indexOf(0, start)));
  }

  // Calls work(call) with an object that frees what the work asked of it.
  run(listener, work) {
    const freed = [];
    this.#listener = listener;
    const result = work(new Call(this, this.#exports, this.#context, freed));
    for (const free of freed.reverse()) free();  // not after errors of WebAssembly: see Library
    return result;
  }
}

class Call {
  #exports;
  #freed;

  constructor(instance, exports, context, freed) {
    this.instance = instance;
    this.context = context;
    this.#exports = exports;
    this.#freed = freed;
  }

  allocate(bytes) {
    const place = this.#exports.allocate(Math.max(bytes, 8)) >>> 0;
    this.#freed.push(() => this.#exports.release(place));
    return place;
  }

  // Copies a typed array; 0 for none.
  put(array) {
    if (!array) return 0;
    const place = this.allocate(array.byteLength);
    this.instance.u8.set(new Uint8Array(array.buffer, array.byteOffset, array.byteLength), place);
    return place;
  }

  // Copies `count` elements out.
  take(type, place, count) {
    if (!count) return new type(0);
    const start = place >>> 0;
    return new type(this.instance.u8.slice(start, start + count * type.BYTES_PER_ELEMENT).buffer);
  }

  version() {
    return this.#exports.libatlas_version();
  }

  // Calls a function of atlas.h that returns a status.
  check(name, ...rest) {
    const status = this.#exports[`libatlas_${name}`](this.context, ...rest);
    if (status) throw errorOf(status, this.instance.string(this.#exports.libatlas_message(this.context)));
  }

  // Likewise, for one that creates an object, with its place as the last argument. Returns the object.
  create(name, destroy, ...rest) {
    const place = this.allocate(4);
    this.check(name, ...rest, place);
    const object = this.instance.u32[place >>> 2];
    this.#freed.push(() => this.#exports[`libatlas_${destroy}`](object));
    return object;
  }

  // A struct with its defaults (if it has any), and with `values`.
  struct(name, values = {}, initialise = `${name}_init`, ...rest) {
    const { bytes, members } = structs[name];
    const place = this.allocate(bytes);
    this.instance.u8.fill(0, place, place + bytes);
    const set = new DataView(this.instance.u8.buffer);
    set.setUint32(place, bytes, true);
    if (this.#exports[`libatlas_${initialise}`]) {
      const status = this.#exports[`libatlas_${initialise}`](place, bytes, ...rest);
      if (status) throw errorOf(status, "these options are out of range");
    }
    for (const [member, value] of Object.entries(values)) {
      const { type, offset } = members[member];
      const at = place + offset;
      if (type === "f64") set.setFloat64(at, value, true);
      else if (type === "f32") set.setFloat32(at, value, true);
      else if (type === "u64") set.setBigUint64(at, BigInt(value), true);
      else set.setInt32(at, value, true);
    }
    return place;
  }

  // Fills a struct by a function of atlas.h and returns its members as numbers.
  ask(name, struct, ...rest) {
    const place = this.struct(struct, {}, "");
    this.check(name, ...rest, place);
    const get = new DataView(this.instance.u8.buffer);
    const values = {};
    for (const [member, { type, offset }] of Object.entries(structs[struct].members)) {
      const at = place + offset;
      if (type === "f64") values[member] = get.getFloat64(at, true);
      else if (type === "f32") values[member] = get.getFloat32(at, true);
      else if (type === "u64") values[member] = Number(get.getBigUint64(at, true));
      else if (type === "i32") values[member] = get.getInt32(at, true);
      else values[member] = get.getUint32(at, true);
    }
    return values;
  }
}
