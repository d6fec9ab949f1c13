// Reads the triangles of a GLB file and writes it with other vertices.
import { gather } from "../lib/gather.js";

const arrayTypes = { 5120: Int8Array, 5121: Uint8Array, 5122: Int16Array, 5123: Uint16Array, 5125: Uint32Array, 5126: Float32Array };
const componentTypes = new Map(Object.entries(arrayTypes).map(([code, type]) => [type, Number(code)]));
const widths = { SCALAR: 1, VEC2: 2, VEC3: 3, VEC4: 4, MAT2: 4, MAT3: 9, MAT4: 16 };
const jsonChunk = 0x4e4f534a, binaryChunk = 0x004e4942, triangleMode = 4;

export function readGlb(buffer) {
  const view = new DataView(buffer);
  if (buffer.byteLength < 20 || view.getUint32(0, true) !== 0x46546c67) throw new Error("this is no GLB file");
  const chunks = {};
  for (let at = 12; at + 8 <= buffer.byteLength;) {
    const length = view.getUint32(at, true);
    chunks[view.getUint32(at + 4, true)] ??= new Uint8Array(buffer, at + 8, Math.min(length, buffer.byteLength - at - 8));
    at += 8 + length;
  }
  const json = JSON.parse(new TextDecoder().decode(chunks[jsonChunk]));
  const packed = (json.extensionsRequired ?? []).filter((name) => /draco|meshopt/.test(name));
  if (packed.length > 0) throw new Error(`the file is compressed (${packed}): decompress it first`);
  if (json.buffers?.some(({ uri }) => uri)) throw new Error("the file keeps its data in other files: pack them into it first");
  return { json, binary: chunks[binaryChunk] ?? new Uint8Array(0) };
}

// The elements of an accessor without gaps, as they are stored.
export function accessorArray({ json, binary }, index) {
  const accessor = json.accessors[index];
  const type = arrayTypes[accessor.componentType], width = widths[accessor.type];
  const result = new type(accessor.count * width);
  if (accessor.bufferView !== undefined) {
    const { byteOffset = 0, byteStride } = json.bufferViews[accessor.bufferView];
    const size = type.BYTES_PER_ELEMENT, stride = byteStride ?? size * width;
    const from = binary.byteOffset + byteOffset + (accessor.byteOffset ?? 0);
    const bytes = new Uint8Array(result.buffer), source = new Uint8Array(binary.buffer);
    for (let i = 0; i < accessor.count; ++i) {
      bytes.set(source.subarray(from + i * stride, from + i * stride + size * width), i * size * width);
    }
  }
  if (accessor.sparse) putSparse({ json, binary }, accessor.sparse, result, width);
  return result;
}

function putSparse(file, { count, indices, values }, result, width) {
  const inner = (part, componentType, type) =>
    accessorArray({ ...file, json: { ...file.json, accessors: [{ count, type, componentType, ...part }] } }, 0);
  const places = inner(indices, indices.componentType, "SCALAR");
  const type = Object.keys(widths).find((name) => widths[name] === width);
  const numbers = inner(values, componentTypes.get(result.constructor), type);
  places.forEach((place, i) => result.set(numbers.subarray(i * width, (i + 1) * width), place * width));
}

function floats(file, index) {
  const array = accessorArray(file, index);
  if (array instanceof Float32Array) return array;
  const most = { Int8Array: 127, Uint8Array: 255, Int16Array: 32767, Uint16Array: 65535 }[array.constructor.name];
  const scale = file.json.accessors[index].normalized ? 1 / most : 1;
  return Float32Array.from(array, (x) => Math.max(-1, x * scale));
}

// The primitives of triangles, each with the matrices of the nodes that show it.
export function primitivesOf(file) {
  const { json } = file, found = [];
  const places = nodeMatrices(json);
  (json.meshes ?? []).forEach((mesh, m) => {
    for (const primitive of mesh.primitives) {
      if ((primitive.mode ?? triangleMode) !== triangleMode || primitive.attributes.POSITION === undefined) continue;
      const positions = floats(file, primitive.attributes.POSITION);
      const indices = primitive.indices === undefined ? Uint32Array.from({ length: positions.length / 3 }, (_, i) => i)
        : Uint32Array.from(accessorArray(file, primitive.indices));
      if (indices.length < 3) continue;
      found.push({ primitive, positions, indices: indices.subarray(0, indices.length - (indices.length % 3)), matrices: places.get(m) ?? [identity] });
    }
  });
  if (found.length === 0) throw new Error("the file has no triangles");
  return found;
}

const identity = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1];

export function product(a, b) {
  return Array.from({ length: 16 }, (_, i) => [0, 1, 2, 3].reduce((sum, k) => sum + a[4 * k + (i % 4)] * b[4 * (i >> 2) + k], 0));
}

function localMatrix({ matrix, translation: t = [0, 0, 0], rotation: [x, y, z, w] = [0, 0, 0, 1], scale: s = [1, 1, 1] }) {
  if (matrix) return matrix;
  return [
    s[0] * (1 - 2 * (y * y + z * z)), s[0] * 2 * (x * y + z * w), s[0] * 2 * (x * z - y * w), 0,
    s[1] * 2 * (x * y - z * w), s[1] * (1 - 2 * (x * x + z * z)), s[1] * 2 * (y * z + x * w), 0,
    s[2] * 2 * (x * z + y * w), s[2] * 2 * (y * z - x * w), s[2] * (1 - 2 * (x * x + y * y)), 0, t[0], t[1], t[2], 1];
}

function nodeMatrices(json) {
  const places = new Map();
  const visit = (index, above) => {
    const node = json.nodes[index], matrix = product(above, localMatrix(node));
    if (node.mesh !== undefined) places.set(node.mesh, [...(places.get(node.mesh) ?? []), matrix]);
    for (const child of node.children ?? []) visit(child, matrix);
  };
  const scene = json.scenes?.[json.scene ?? 0];
  for (const root of scene?.nodes ?? []) visit(root, identity);
  return places;
}

// A file of one mesh.
export function fileOfMesh({ positions }) {
  const json = {
    asset: { version: "2.0" }, scene: 0, scenes: [{ nodes: [0] }], nodes: [{ mesh: 0 }],
    meshes: [{ primitives: [{ attributes: { POSITION: 0 } }] }],
    accessors: [{ bufferView: 0, componentType: 5126, count: positions.length / 3, type: "VEC3" }],
    bufferViews: [{ buffer: 0, byteLength: positions.byteLength }], buffers: [{ byteLength: positions.byteLength }],
  };
  return { json, binary: new Uint8Array(positions.buffer, positions.byteOffset, positions.byteLength) };
}

// The file with the vertices, indices and uvs of the results, one a primitive, in the set TEXCOORD_`set`.
export function withResults(file, primitives, results, set) {
  const json = structuredClone(file.json), parts = [file.binary];
  let length = file.binary.byteLength;
  const add = (array, like, target) => {
    const gap = -length & 3;
    parts.push(new Uint8Array(gap), new Uint8Array(array.buffer, array.byteOffset, array.byteLength));
    json.bufferViews.push({ buffer: 0, byteOffset: length + gap, byteLength: array.byteLength, target });
    length += gap + array.byteLength;
    const count = array.length / widths[like.type];
    return json.accessors.push({ ...like, bufferView: json.bufferViews.length - 1, count, componentType: componentTypes.get(array.constructor) }) - 1;
  };
  const copies = primitives.map(({ primitive }) => {
    const mesh = file.json.meshes.findIndex(({ primitives }) => primitives.includes(primitive));
    return json.meshes[mesh].primitives[file.json.meshes[mesh].primitives.indexOf(primitive)];
  });
  copies.forEach((primitive, i) => {
    const { vertices, uvs, indices } = results[i];
    for (const attributes of [primitive.attributes, ...(primitive.targets ?? [])]) {
      for (const [semantic, index] of Object.entries(attributes)) {
        attributes[semantic] = add(...remapped(file, index, vertices, semantic), 34962);
      }
    }
    // glTF begins at the upper left.
    primitive.attributes[`TEXCOORD_${set}`] = add(uvs.map((x, k) => (k % 2 ? 1 - x : x)), { type: "VEC2" }, 34962);
    for (let k = 0; k < set; ++k) primitive.attributes[`TEXCOORD_${k}`] ??= primitive.attributes[`TEXCOORD_${set}`];
    primitive.indices = add(vertices.length < 0xffff ? Uint16Array.from(indices) : indices, { type: "SCALAR" }, 34963);
  });
  return writeGlb(json, parts, length);
}

// An attribute for other vertices: its array, and the rest of its accessor. Elements begin at multiples of 4 bytes.
function remapped(file, index, vertices, semantic) {
  const { type, normalized } = file.json.accessors[index];
  const array = accessorArray(file, index), width = widths[type];
  if ((width * array.BYTES_PER_ELEMENT) % 4 !== 0) {
    const all = floats(file, index), values = gather(all, vertices, width);
    return [values, { type, ...bounds(values, width, semantic) }];
  }
  const values = gather(array, vertices, width);
  return [values, { type, ...(normalized ? { normalized } : {}), ...bounds(values, width, semantic) }];
}

function bounds(values, width, semantic) {
  if (semantic !== "POSITION") return {};
  const min = Array(width).fill(Infinity), max = Array(width).fill(-Infinity);
  values.forEach((x, i) => {
    min[i % width] = Math.min(min[i % width], x);
    max[i % width] = Math.max(max[i % width], x);
  });
  return { min, max };
}

function writeGlb(json, parts, length) {
  json.buffers = [{ ...json.buffers?.[0], byteLength: length }];
  const text = new TextEncoder().encode(JSON.stringify(json));
  const spaces = new Uint8Array(-text.length & 3).fill(32), zeros = new Uint8Array(-length & 3);
  const jsonLength = text.length + spaces.length, binaryLength = length + zeros.length;
  const head = Uint32Array.of(0x46546c67, 2, 28 + jsonLength + binaryLength, jsonLength, jsonChunk);
  return new Blob([head, text, spaces, Uint32Array.of(binaryLength, binaryChunk), ...parts, zeros], { type: "model/gltf-binary" });
}
