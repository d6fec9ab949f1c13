// unwrap(options): a transform for glTF-Transform, called as its own one.
import { BadInputError, BadOptionError } from "./lib/errors.js";
import { gather } from "./lib/gather.js";

const triangles = 4, strip = 5, fan = 6;
let loaded = null;

export function unwrap(options = {}) {
  const transform = async (document) => {
    const { groupBy = "mesh" } = options;
    const groups = groupings[groupBy];
    if (!groups) throw new BadOptionError(`groupBy is ${groupBy}, and can be ${Object.keys(groupings).join(", ")}`);
    if (options.instances && groupBy !== "scene") throw new BadOptionError('instances have places on one page: set groupBy to "scene"');
    if (options.instances) await unwrapInstances(document, options);
    else for (const group of groups(document)) await unwrapPrimitives(group.primitives, { weights: group.weights, ...options });
    document.getLogger().debug("unwrap: Complete.");
  };
  Object.defineProperty(transform, "name", { value: "unwrap" });
  return transform;
}

// Which primitives share a page.
const groupings = {
  primitive: (document) => eachOnce(document).map(({ primitive }) => ({ primitives: [primitive] })),
  mesh: (document) => {
    const seen = new Set();
    return document.getRoot().listMeshes().map((mesh) => ({ primitives: mesh.listPrimitives().filter((p) => !seen.has(p) && seen.add(p)) }));
  },
  scene: (document) => {
    const all = eachOnce(document);
    return [{ primitives: all.map(({ primitive }) => primitive), weights: all.map(({ mesh }) => largestScale(mesh)) }];
  },
};

function eachOnce(document) {
  const meshOf = new Map();
  for (const mesh of document.getRoot().listMeshes()) {
    for (const primitive of mesh.listPrimitives()) if (!meshOf.has(primitive)) meshOf.set(primitive, mesh);
  }
  return [...meshOf].map(([primitive, mesh]) => ({ primitive, mesh }));
}

// Of the nodes that show the mesh, so that texels are of one size in the scene.
const largestScale = (mesh) => scaleOf(nodesOf(mesh));

const nodesOf = (mesh) => mesh.listParents().filter((parent) => typeof parent.getWorldScale === "function");

function scaleOf(nodes) {
  const scale = Math.max(0, ...nodes.flatMap((node) => node.getWorldScale().map(Math.abs)));
  return Number.isFinite(scale) && scale > 0 ? scale : 1;
}

// weights: relative density of texels, one a primitive; library: what load() or startWorker() returned; the others are
// options of Library.unwrap(). Returns its result, or null if no primitive needs uvs.
export async function unwrapPrimitives(primitives, options = {}) {
  const { texcoord, ofMesh, ofUnwrap, calls } = await parted(options);
  const wanted = primitives
    .map((primitive, i) => ({ primitive, mesh: meshOf(primitive, ofMesh), density: options.weights?.[i] ?? 1 }))
    .filter(({ mesh }) => mesh);
  if (wanted.length === 0) return null;
  const result = await calls.unwrap(wanted.map(({ mesh, density }) => ({ ...mesh, density })), ofUnwrap);
  wanted.forEach(({ primitive }, i) => put(primitive, result.meshes[i], texcoord));
  return result;
}

// Who takes which options.
async function parted(options) {
  const { texcoord = 0, overwrite = false, weights, library, normals = false, groupBy, instances, watlas, ...ofUnwrap } = options;
  if (!Number.isInteger(texcoord) || texcoord < 0) throw new BadOptionError(`texcoord is ${texcoord}, and has to be 0, 1, 2, ...`);
  if ((ofUnwrap.pages ?? 1) !== 1) throw new BadOptionError("pages has to be 1: the uvs of a glTF file lie on one texture");
  const calls = library ?? (await (loaded ??= import("libatlas").then(({ load }) => load())));
  return { texcoord, ofUnwrap, calls, ofMesh: { normals, keepUvs: ofUnwrap.keepUvs, unless: overwrite ? null : `TEXCOORD_${texcoord}` } };
}

// What is unwrapped of a primitive; null if it has no triangles or needs no uvs.
function meshOf(primitive, { normals, keepUvs, unless }) {
  const indices = unless && primitive.getAttribute(unless) ? null : triangleIndices(primitive);
  if (!indices?.length) return null;
  const floats = (semantic) => primitive.getAttribute(semantic) && floatsOf(primitive.getAttribute(semantic));
  return { positions: floats("POSITION"), indices, normals: normals ? floats("NORMAL") : null, texcoords: keepUvs ? floats("TEXCOORD_0") : null };
}

// Each mesh has uvs of 0..1 over a rectangle, and each node that shows it a place for them in its extras: lightmapScale
// and lightmapOffset, as atlas-export --instances extras writes them.
async function unwrapInstances(document, options) {
  const { texcoord, ofMesh, ofUnwrap, calls } = await parted({ ...options, keepUvs: false });
  const shown = document.getRoot().listMeshes().map((mesh) => ({ nodes: nodesOf(mesh), parts: partsOf(mesh, ofMesh) }))
    .filter(({ nodes, parts }) => nodes.length > 0 && parts.length > 0);
  const primitives = shown.flatMap(({ parts }) => parts.map(({ primitive }) => primitive));
  if (new Set(primitives).size < primitives.length) throw new BadInputError("two meshes share a primitive, which can have one place only: duplicate it");
  if (shown.length === 0) return;
  const meshes = shown.map(({ nodes, parts }) => ({ ...joined(parts), instances: nodes.map((node) => scaleOf([node])) }));
  const result = await calls.unwrap(meshes, ofUnwrap);
  shown.forEach(({ nodes, parts }, i) => {
    const { instances: { scale, offset }, ...whole } = result.meshes[i];
    let first = 0;
    for (const { primitive, mesh } of parts) {
      put(primitive, partOf(whole, first, mesh.positions.length / 3), texcoord);
      first += mesh.positions.length / 3;
    }
    nodes.forEach((node, k) => {
      const [x, y, width, height] = [offset[2 * k], offset[2 * k + 1], scale[2 * k], scale[2 * k + 1]];
      node.setExtras({ ...node.getExtras(), lightmapScale: [width, height], lightmapOffset: [x, Math.max(0, 1 - y - height)] });
    });
  });
}

const partsOf = (mesh, ofMesh) =>
  mesh.listPrimitives().map((primitive) => ({ primitive, mesh: meshOf(primitive, ofMesh) })).filter(({ mesh }) => mesh);

// The primitives of a mesh as one; each is a material, so that no chart holds triangles of two.
function joined(parts) {
  const positions = [], indices = [], materials = [], normals = [];
  parts.forEach(({ mesh }, i) => {
    const first = positions.length / 3;
    for (const x of mesh.positions) positions.push(x);
    for (const x of mesh.normals ?? []) normals.push(x);
    for (const v of mesh.indices) indices.push(first + v);
    for (let t = 0; t < mesh.indices.length; t += 3) materials.push(i);
  });
  return { positions, indices, materials, normals: normals.length === positions.length ? normals : null };
}

// Of a result, what copies `count` vertices from the first on.
function partOf({ vertices, uvs, indices }, first, count) {
  const own = [], place = new Map();
  vertices.forEach((v, i) => v >= first && v < first + count && place.set(i, own.push(i) - 1));
  return {
    vertices: Uint32Array.from(own, (i) => vertices[i] - first),
    uvs: Float32Array.from({ length: 2 * own.length }, (_, k) => uvs[2 * own[k >> 1] + (k & 1)]),
    indices: indices.filter((v) => place.has(v)).map((v) => place.get(v)),
  };
}

// Of three corners a triangle; null for points and lines.
function triangleIndices(primitive) {
  const position = primitive.getAttribute("POSITION");
  if (!position) return null;
  const given = primitive.getIndices()?.getArray();
  const count = given?.length ?? position.getCount();
  const corner = given ? (i) => given[i] : (i) => i;
  const mode = primitive.getMode();
  if (mode === triangles) return Uint32Array.from({ length: count - (count % 3) }, (_, i) => corner(i));
  if (mode !== strip && mode !== fan) return null;
  const result = [];
  for (let t = 0; t + 2 < count; ++t) {
    const first = mode === fan ? 0 : t;
    const [second, third] = mode === strip && t % 2 ? [t + 2, t + 1] : [t + 1, t + 2];
    const [a, b, c] = [first, second, third].map(corner);
    if (a !== b && b !== c && c !== a) result.push(a, b, c);  // strips turn by triangles without area
  }
  return Uint32Array.from(result);
}

function floatsOf(accessor) {
  const array = accessor.getArray();
  if (array instanceof Float32Array) return array;
  const width = accessor.getElementSize();
  const result = new Float32Array(accessor.getCount() * width);
  for (let i = 0, element = []; i < accessor.getCount(); ++i) result.set(accessor.getElement(i, element), i * width);
  return result;
}

// Gives the primitive the vertices, indices and uvs of the result.
function put(primitive, { vertices, uvs, indices }, texcoord) {
  // Clones belong to the document of their original.
  const model = primitive.getAttribute("POSITION").clone().setName("").setExtras({}).setNormalized(false).setSparse(false);
  const accessor = (array, type) => model.clone().setArray(array).setType(type);
  for (const holder of [primitive, ...primitive.listTargets()]) {
    for (const semantic of holder.listSemantics()) {
      const old = holder.getAttribute(semantic);
      const copy = accessor(gather(old.getArray(), vertices, old.getElementSize()), old.getType());
      copy.setName(old.getName()).setNormalized(old.getNormalized()).setExtras(old.getExtras());
      holder.setAttribute(semantic, copy);
      disposeUnused(old);
    }
  }
  // glTF begins at the upper left.
  const made = accessor(uvs.map((x, i) => (i % 2 ? 1 - x : x)), "VEC2");
  const replaced = primitive.getAttribute(`TEXCOORD_${texcoord}`);
  primitive.setAttribute(`TEXCOORD_${texcoord}`, made);
  if (replaced) disposeUnused(replaced);
  // A set may exist only where all before it do.
  for (let k = 0; k < texcoord; ++k) {
    if (!primitive.getAttribute(`TEXCOORD_${k}`)) primitive.setAttribute(`TEXCOORD_${k}`, made);
  }
  const small = vertices.length < 0xffff;
  const old = primitive.getIndices();
  primitive.setIndices(accessor(small ? Uint16Array.from(indices) : indices, "SCALAR")).setMode(triangles);
  if (old) disposeUnused(old);
  model.dispose();
}

function disposeUnused(accessor) {
  if (accessor.listParents().every((parent) => parent.propertyType === "Root")) accessor.dispose();
}
