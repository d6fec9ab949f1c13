// unwrap(options): a transform for glTF-Transform, called as its own one.
import { BadOptionError } from "./lib/errors.js";
import { gather } from "./lib/gather.js";

const triangles = 4, strip = 5, fan = 6;
let loaded = null;

export function unwrap(options = {}) {
  const transform = async (document) => {
    const { groupBy = "mesh" } = options;
    const groups = groupings[groupBy];
    if (!groups) throw new BadOptionError(`groupBy is ${groupBy}, and can be ${Object.keys(groupings).join(", ")}`);
    for (const group of groups(document)) await unwrapPrimitives(group.primitives, { weights: group.weights, ...options });
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
function largestScale(mesh) {
  const nodes = mesh.listParents().filter((parent) => typeof parent.getWorldScale === "function");
  const scale = Math.max(0, ...nodes.flatMap((node) => node.getWorldScale().map(Math.abs)));
  return Number.isFinite(scale) && scale > 0 ? scale : 1;
}

// weights: relative density of texels, one a primitive; library: what load() or startWorker() returned; the others are
// options of Library.unwrap(). Returns its result, or null if no primitive needs uvs.
export async function unwrapPrimitives(primitives, options = {}) {
  const { texcoord = 0, overwrite = false, weights, library, normals = false, groupBy, watlas, ...ofUnwrap } = options;
  if (!Number.isInteger(texcoord) || texcoord < 0) throw new BadOptionError(`texcoord is ${texcoord}, and has to be 0, 1, 2, ...`);
  if ((ofUnwrap.pages ?? 1) !== 1) throw new BadOptionError("pages has to be 1: the uvs of a glTF file lie on one texture");
  const semantic = `TEXCOORD_${texcoord}`;
  const density = (i) => weights?.[i] ?? 1;
  const wanted = primitives
    .map((primitive, i) => ({ primitive, density: density(i), indices: triangleIndices(primitive) }))
    .filter(({ primitive, indices }) => indices?.length && (overwrite || !primitive.getAttribute(semantic)));
  if (wanted.length === 0) return null;
  const calls = library ?? (await (loaded ??= import("libatlas").then(({ load }) => load())));
  const meshes = wanted.map(({ primitive, density, indices }) => ({
    positions: floatsOf(primitive.getAttribute("POSITION")),
    indices,
    density,
    normals: normals && primitive.getAttribute("NORMAL") ? floatsOf(primitive.getAttribute("NORMAL")) : undefined,
    texcoords: ofUnwrap.keepUvs && primitive.getAttribute("TEXCOORD_0") ? floatsOf(primitive.getAttribute("TEXCOORD_0")) : undefined,
  }));
  const result = await calls.unwrap(meshes, ofUnwrap);
  wanted.forEach(({ primitive }, i) => put(primitive, result.meshes[i], texcoord));
  return result;
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
