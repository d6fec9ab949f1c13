// What users pass in, as tight typed arrays.
import { BadInputError, BadOptionError } from "./errors.js";
import { camelCase, flags, presetMembers, presets, structs } from "./structs.js";

const isTyped = (array) => ArrayBuffer.isView(array) && !(array instanceof DataView);

// Splits what may be an array or { array, offset, stride, count } into its parts, in elements.
function parts(data, width, what) {
  const whole = isTyped(data) || Array.isArray(data);
  const array = whole ? data : data?.array;
  if (!isTyped(array) && !Array.isArray(array)) {
    throw new BadInputError(`${what} is neither an array nor { array, offset, stride, count }`);
  }
  if (array instanceof BigInt64Array || array instanceof BigUint64Array) {
    throw new BadInputError(`${what} is an array of BigInt: pass one of numbers`);
  }
  const { offset = 0, stride = width } = whole ? {} : data;
  const room = array.length - offset - width;
  const { count = room < 0 ? 0 : Math.floor(room / stride) + 1 } = whole ? {} : data;
  const integers = [offset, stride, count].every((x) => Number.isSafeInteger(x) && x >= 0);
  if (!integers || stride < 1 || (count > 0 && (count - 1) * stride > room)) {
    throw new BadInputError(`${what}: offset, stride or count reach beyond the array`);
  }
  if (whole && array.length % width) {
    throw new BadInputError(`${what} has ${array.length} numbers, which is no multiple of ${width}`);
  }
  return { array, offset, stride, count };
}

function tight({ array, offset, stride, count }, width, type) {
  const { length } = array;
  if (stride === width) {
    if (offset === 0 && count * width === length) return array instanceof type ? array : type.from(array);
    return type.from(array.slice(offset, offset + count * width));
  }
  const result = new type(count * width);
  for (let i = 0; i < count; ++i) {
    for (let k = 0; k < width; ++k) result[i * width + k] = array[offset + i * stride + k];
  }
  return result;
}

// Typed arrays of the type are returned as they are.
export function numbers(type, data, width, what) {
  return data == null ? null : tight(parts(data, width, what), width, type);
}

// Indices as Uint16Array or Uint32Array; without any, `count` of them from 0.
export function indexArray(data, count, what) {
  if (data == null) return Uint32Array.from({ length: count }, (_, i) => i);
  const split = parts(data, 1, what);
  const { array } = split;
  if (array instanceof Uint16Array) return tight(split, 1, Uint16Array);
  const integers = isTyped(array) && !(array instanceof Float32Array || array instanceof Float64Array);
  if (!integers) {
    const bad = array.findIndex((x) => !Number.isInteger(x) || x < 0 || x > 0xffffffff);
    if (bad >= 0) throw new BadInputError(`${what}[${bad}] is ${array[bad]}, which is no index`);
  }
  return tight(split, 1, Uint32Array);
}

// Options in camelCase as members of a struct. Those in `others` belong to JavaScript.
export function optionValues(struct, options, others) {
  const { members } = structs[struct];
  const names = new Map(Object.keys(members).filter((m) => m !== "size").map((m) => [camelCase(m), m]));
  const values = {};
  for (const [name, value] of Object.entries(options)) {
    if (value === undefined || others.includes(name)) continue;
    const member = names.get(name);
    if (!member) {
      throw new BadOptionError(`no option is called ${name}; there are ${[...names.keys(), ...others].join(", ")}`);
    }
    values[member] = optionValue(name, member, members[member].type, value);
  }
  return values;
}

function optionValue(name, member, type, value) {
  if (presetMembers.has(member)) {
    const preset = presets.indexOf(value);
    if (preset < 0) throw new BadOptionError(`${name} is ${value}, and can be ${presets.join(", ")}`);
    return preset;
  }
  if (flags.has(member)) {
    if (typeof value !== "boolean") throw new BadOptionError(`${name} is ${value}, and can be true or false`);
    return Number(value);
  }
  if (typeof value !== "number" || Number.isNaN(value)) throw new BadOptionError(`${name} is no number`);
  const [least, most] = { i32: [-0x80000000, 0x7fffffff], u32: [0, 0xffffffff], u64: [0, Number.MAX_SAFE_INTEGER] }[type] ?? [];
  if (least !== undefined && !(Number.isInteger(value) && value >= least && value <= most)) {
    throw new BadOptionError(`${name} is ${value}, and has to be an integer from ${least} to ${most}`);
  }
  return value;
}
