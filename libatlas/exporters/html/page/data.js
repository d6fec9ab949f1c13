// Reads what the exporter has put into the page: JSON, and bytes in base64. docs/formats.md describes
// them.

function bytesOf(id) {
  const text = document.getElementById(id).textContent;
  if (Uint8Array.fromBase64) return Uint8Array.fromBase64(text);
  const digit = new Uint8Array(128);
  const digits = 'ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/';
  for (let i = 0; i < 64; ++i) digit[digits.charCodeAt(i)] = i;
  const pad = text.endsWith('==') ? 2 : text.endsWith('=') ? 1 : 0;
  const bytes = new Uint8Array((text.length / 4) * 3 - pad);
  for (let i = 0, at = 0; i < text.length; i += 4) {
    const word = (digit[text.charCodeAt(i)] << 18) | (digit[text.charCodeAt(i + 1)] << 12) |
      (digit[text.charCodeAt(i + 2)] << 6) | digit[text.charCodeAt(i + 3)];
    bytes[at++] = word >> 16;
    if (at < bytes.length) bytes[at++] = word >> 8;
    if (at < bytes.length) bytes[at++] = word;
  }
  return bytes;
}

async function inflated(bytes) {
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream('deflate'));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

// Reads columns one after the other, see html/mesh_columns.h.
class Columns {
  constructor(bytes) {
    this.bytes = bytes;
    this.at = 0;
  }
  numbers(count) {
    const planes = this.bytes[this.at++];
    const result = new Uint32Array(count);
    for (let p = 0; p < planes; ++p) {
      for (let i = 0; i < count; ++i) result[i] |= this.bytes[this.at + i] << (8 * p);
      this.at += count;
    }
    return result;
  }
  values(count) {
    const result = this.numbers(count);
    let last = 0;
    for (let i = 0; i < count; ++i) {
      last += (result[i] >>> 1) ^ -(result[i] & 1);
      result[i] = last;
    }
    return result;
  }
  indices(count) {
    const result = this.numbers(count);
    let next = 0;
    for (let i = 0; i < count; ++i) {
      result[i] = next - result[i];
      if (result[i] === next) ++next;
    }
    return result;
  }
}

// Returns all parts in common arrays: part.firstVertex and part.firstIndex say where each begins.
function readMesh(world, bytes) {
  const sum = (key) => world.parts.reduce((n, part) => n + part[key], 0);
  const vertices = sum('vertices');
  const mesh = {
    positions: new Float32Array(3 * vertices),
    uvs: new Float32Array(2 * vertices),
    charts: new Uint32Array(vertices),
    indices: new Uint32Array(3 * sum('triangles')),
    partOf: new Uint16Array(sum('triangles')),
    low: [Infinity, Infinity, Infinity],
    high: [-Infinity, -Infinity, -Infinity],
  };
  const columns = new Columns(bytes);
  let firstVertex = 0, firstIndex = 0;
  for (const [number, part] of world.parts.entries()) {
    Object.assign(part, {firstVertex, firstIndex});
    for (let axis = 0; axis < 3; ++axis) {
      const values = columns.values(part.vertices);
      for (let i = 0; i < part.vertices; ++i) {
        const x = world.mesh.low[axis] + world.mesh.step * values[i];
        mesh.positions[3 * (firstVertex + i) + axis] = x;
        mesh.low[axis] = Math.min(mesh.low[axis], x);
        mesh.high[axis] = Math.max(mesh.high[axis], x);
      }
    }
    for (let axis = 0; axis < 2; ++axis) {
      const values = columns.values(part.vertices);
      for (let i = 0; i < part.vertices; ++i)
        mesh.uvs[2 * (firstVertex + i) + axis] = values[i] / world.mesh.uvSteps;
    }
    mesh.charts.set(columns.values(part.vertices), firstVertex);
    mesh.partOf.fill(number, firstIndex / 3, firstIndex / 3 + part.triangles);
    const indices = columns.indices(3 * part.triangles);
    for (let i = 0; i < indices.length; ++i) mesh.indices[firstIndex + i] = firstVertex + indices[i];
    firstVertex += part.vertices;
    firstIndex += indices.length;
  }
  return mesh;
}

// Returns the image of a page as the browser decodes it, bottom row first, no side longer than `most`.
async function readImage(bytes, type, most) {
  const raw = {premultiplyAlpha: 'none', colorSpaceConversion: 'none'};
  const image = await createImageBitmap(new Blob([bytes], {type}), {imageOrientation: 'flipY', ...raw});
  const shrink = timesHalved(image, most);
  if (shrink === 0) return image;
  const small = await createImageBitmap(image, {resizeWidth: Math.max(1, image.width >> shrink),
    resizeHeight: Math.max(1, image.height >> shrink), resizeQuality: 'high', ...raw});
  image.close();
  return small;
}

// Returns how often an image must be halved so that no side is longer than `most`.
const timesHalved = ({width, height}, most) =>
  Math.max(0, Math.ceil(Math.log2(Math.max(width, height) / most)));
