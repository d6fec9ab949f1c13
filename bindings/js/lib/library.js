// The calls of the C library with objects and typed arrays.
import { indexArray, numbers, optionValues } from "./arrays.js";
import { BadInputError, CancelledError, InternalError, OutOfMemoryError } from "./errors.js";
import { Instance } from "./instance.js";
import { camelCase } from "./structs.js";

const ofCalls = ["lightmap", "seams", "shifts", "onProgress", "onWarning", "signal"];
const keptMemory = 256 * 2 ** 20;

export class Library {
  #module;
  #instance = null;
  #running = false;

  constructor(module) {
    this.#module = module;
  }

  get version() {
    return this.#run({}, (call) => {
      const number = call.version();
      return [Math.floor(number / 10000), Math.floor(number / 100) % 100, number % 100].join(".");
    });
  }

  unwrap(meshes, options = {}) {
    const list = (Array.isArray(meshes) ? meshes : [meshes]).map(tightMesh);
    const { like, ...rest } = options, earlier = like && tightEarlier(like);
    return this.#run(options, (call) => {
      const atlas = call.create("atlas_create", "atlas_destroy");
      for (const mesh of list) addMesh(call, atlas, mesh);
      const values = optionValues("unwrap_options", rest, ofCalls);
      if (earlier) values.like = earlierStruct(call, earlier);
      const unwrapped = call.create("unwrap", "unwrapped_destroy", atlas, unwrapOptions(call, options.lightmap, values));
      const result = unwrapResult(call, atlas, unwrapped, list, options.seams);
      if (list.some(({ values }) => values)) result.textures = texturesOf(call, unwrapped, result, list, options.shifts);
      return result;
    });
  }

  packRects(rects, options = {}) {
    const sides = numbers(Int32Array, rects, 2, "rects");
    const { page, ...rest } = options;
    const values = optionValues("pack_options", rest, ofCalls);
    if (page) [values.page_width, values.page_height] = [page.width, page.height];
    return this.#run(options, (call) => {
      const packed = call.create("pack_rects", "packed_destroy", call.put(sides), sides.length / 2,
        call.struct("pack_options", values));
      const info = call.ask("get_packed", "packed_info", packed);
      const places = call.take(Uint32Array, info.placements, 4 * info.placement_count);
      const column = (type, k) => type.from({ length: info.placement_count }, (_, i) => places[4 * i + k]);
      return {
        page: column(Int32Array, 0),  // -1: not placed
        x: column(Int32Array, 1),
        y: column(Int32Array, 2),
        rotated: column(Uint8Array, 3),
        pages: extents(call, info),
        unplacedCount: info.unplaced_count,
        utilization: info.utilization,
        pageLowerBound: info.page_lower_bound,
      };
    });
  }

  packIslands(islands, options = {}) {
    const uvs = numbers(Float32Array, islands.uvs, 2, "uvs");
    const indices = indexArray(islands.indices, uvs.length / 2, "indices");
    const values = optionValues("island_options", options, ofCalls);
    return this.#run(options, (call) => {
      const given = call.struct("islands", {
        uvs: call.put(uvs), uv_count: uvs.length / 2,
        indices: call.put(indices), index_count: indices.length, index_bytes: indices.BYTES_PER_ELEMENT,
      });
      const packed = call.create("pack_islands", "packed_islands_destroy", given, call.struct("island_options", values));
      const info = call.ask("get_packed_islands", "packed_islands_info", packed);
      return {
        uvs: call.take(Float32Array, info.uvs, 2 * info.uv_count),
        triangleIsland: call.take(Uint32Array, info.triangle_island, info.triangle_count),
        islandPage: call.take(Uint32Array, info.island_page, info.island_count),
        islandAngle: call.take(Float64Array, info.island_angle, info.island_count),
        islandOffset: call.take(Float64Array, info.island_offset, 2 * info.island_count),
        pages: extents(call, info),
        texelsPerUv: info.texels_per_uv,
        utilization: info.utilization,
      };
    });
  }

  // Runs work(call). An instance in which something broke is not used again, and neither is one with
  // much memory, which WebAssembly cannot give back.
  #run({ onProgress, onWarning, signal }, work) {
    if (this.#running) throw new InternalError("callbacks cannot call the library: await the end of the call first");
    signal?.throwIfAborted();
    const instance = (this.#instance ??= new Instance(this.#module));
    const own = [];
    const guarded = (callback) => {
      try {
        callback();
      } catch (error) {
        own.push(error);
      }
    };
    const listener = {
      progress: (stage, fraction) => {
        guarded(() => onProgress?.(stage, fraction));
        return own.length > 0 || signal?.aborted;  // cancels
      },
      warning: (line) => guarded(() => onWarning?.(line)),
    };
    this.#running = true;
    try {
      const result = instance.run(listener, work);
      if (instance.memoryBytes > keptMemory) this.#instance = null;
      if (own.length > 0) throw own[0];
      return result;
    } catch (error) {
      this.#instance = null;
      if (own.length > 0) throw own[0];
      if (error instanceof CancelledError) signal?.throwIfAborted();
      throw told(error);
    } finally {
      this.#running = false;
    }
  }
}

// WebAssembly's own errors are not the library's.
function told(error) {
  if (error instanceof WebAssembly.RuntimeError) {
    return new InternalError(`the library stopped (${error.message}): please report the mesh`);
  }
  if (error instanceof RangeError && /memory|allocation|Maximum call stack|length/i.test(error.message)) {
    return new OutOfMemoryError(`the mesh needs more memory than there is (${error.message})`);
  }
  return error;
}

// A mesh whose arrays are tight and of the types that the library reads.
export function tightMesh(mesh, number = 0) {
  const name = (array) => `mesh ${number}: ${array}`;
  const floats = (array, width) => numbers(Float32Array, mesh[array], width, name(array));
  const positions = floats("positions", 3);
  if (!positions) throw new BadInputError(name("positions are missing"));
  const result = {
    positions,
    indices: indexArray(mesh.indices, positions.length / 3, name("indices")),
    normals: floats("normals", 3),
    texcoords: floats("texcoords", 2),
    materials: numbers(Uint32Array, mesh.materials, 1, name("materials")),
    seams: numbers(Uint8Array, mesh.seams, 1, name("seams")),
    triangleDensity: floats("triangleDensity", 1),
    seamWeights: floats("seamWeights", 1),
    polygonSizes: numbers(Uint32Array, mesh.polygonSizes, 1, name("polygonSizes")),
    instances: floats("instances", 1),
    values: floats("values", 3),
    density: mesh.density ?? 1,
  };
  if (mesh.texcoordIndices != null) {
    const texcoordIndices = numbers(Uint32Array, mesh.texcoordIndices, 1, name("texcoordIndices"));
    result.indices = Uint32Array.from(result.indices);  // both are of one type
    result.texcoordIndices = texcoordIndices;
  }
  checkLengths(result, name);
  return result;
}

// The library reads as many elements as there are corners and faces.
function checkLengths(mesh, name) {
  const corners = mesh.indices.length;
  const faces = mesh.polygonSizes?.length ?? Math.floor(corners / 3);
  const positions = mesh.positions.length / 3;
  const wanted = { normals: 3 * positions, values: 3 * positions, materials: faces, seams: corners, seamWeights: positions, triangleDensity: faces, texcoordIndices: corners };
  if (!mesh.texcoordIndices) wanted.texcoords = 2 * positions;
  for (const [array, length] of Object.entries(wanted)) {
    if (mesh[array] && mesh[array].length !== length) {
      throw new BadInputError(name(`${array} has ${mesh[array].length} numbers instead of ${length}`));
    }
  }
}

function addMesh(call, atlas, mesh) {
  const struct = meshStruct(call, mesh);
  if (!mesh.instances) call.check("add_mesh", atlas, struct, 0);
  else call.check("add_instances", atlas, struct, call.put(mesh.instances), mesh.instances.length, 0);
}

function meshStruct(call, mesh) {
  return call.struct("mesh", {
    positions: call.put(mesh.positions), position_count: mesh.positions.length / 3,
    indices: call.put(mesh.indices), index_count: mesh.indices.length, index_bytes: mesh.indices.BYTES_PER_ELEMENT,
    normals: call.put(mesh.normals),
    texcoords: call.put(mesh.texcoords), texcoord_count: (mesh.texcoords?.length ?? 0) / 2,
    texcoord_indices: call.put(mesh.texcoordIndices),
    materials: call.put(mesh.materials), seams: call.put(mesh.seams), seam_weights: call.put(mesh.seamWeights),
    triangle_density: call.put(mesh.triangleDensity), density: mesh.density,
    polygon_sizes: call.put(mesh.polygonSizes), polygon_count: mesh.polygonSizes?.length ?? 0,
  });
}

// Earlier uvs likewise. The library reads as many uvIndices and pages of triangles as indices say.
function tightEarlier(like) {
  const name = (array) => `like: ${array}`;
  const of = (type, array, width) => numbers(type, like[array], width, name(array));
  const positions = of(Float32Array, "positions", 3);
  if (!positions) throw new BadInputError(name("positions are missing"));
  const indices = Uint32Array.from(indexArray(like.indices, positions.length / 3, name("indices")));
  const result = {
    positions, indices, uvs: of(Float32Array, "uvs", 2), uvIndices: of(Uint32Array, "uvIndices", 1),
    trianglePage: of(Uint32Array, "trianglePage", 1), objects: of(Uint32Array, "objects", 1),
    pages: Int32Array.from((like.pages ?? []).flatMap(({ width, height }) => [width, height])),
    tolerance: like.tolerance,
  };
  const wanted = { objects: positions.length / 3, uvIndices: indices.length, trianglePage: Math.floor(indices.length / 3) };
  for (const [array, length] of Object.entries(wanted)) {
    if (result[array] && result[array].length !== length) {
      throw new BadInputError(name(`${array} has ${result[array].length} numbers instead of ${length}`));
    }
  }
  return result;
}

function earlierStruct(call, { positions, indices, uvs, uvIndices, trianglePage, pages, tolerance, objects }) {
  return call.struct("earlier_uvs", {
    positions: call.put(positions), position_count: positions.length / 3,
    indices: call.put(indices), index_count: indices.length, index_bytes: 4,
    uvs: call.put(uvs), uv_count: (uvs?.length ?? 0) / 2, uv_indices: call.put(uvIndices),
    triangle_page: call.put(trianglePage), pages: call.put(pages), page_count: pages.length / 2, objects: call.put(objects),
    ...(tolerance === undefined ? {} : { tolerance }),
  });
}

function unwrapOptions(call, lightmap, values) {
  if (!lightmap) return call.struct("unwrap_options", values);
  const { texelsPerMetre = 0, metresPerUnit = 1 } = lightmap === true ? {} : lightmap;
  return call.struct("unwrap_options", values, "lightmap_options_init", texelsPerMetre, metresPerUnit);
}

function unwrapResult(call, atlas, unwrapped, list, withSeams) {
  const info = call.ask("get_info", "atlas_info", unwrapped);
  const meshes = list.map((mesh, i) => {
    const uvs = call.ask("get_mesh", "mesh_uvs", unwrapped, i);
    const result = {
      vertices: call.take(Uint32Array, uvs.vertices, uvs.vertex_count),
      uvs: call.take(Float32Array, uvs.uvs, 2 * uvs.vertex_count),
      indices: call.take(Uint32Array, uvs.indices, 3 * uvs.triangle_count),
      trianglePage: call.take(Uint32Array, uvs.triangle_page, uvs.triangle_count),
      triangleChart: call.take(Uint32Array, uvs.triangle_chart, uvs.triangle_count),
    };
    if (mesh.polygonSizes) Object.assign(result, polygonResult(call, unwrapped, i));
    if (mesh.instances) result.instances = instancesOf(call, unwrapped, i);
    if (withSeams) result.seams = seamsOf(call, atlas, unwrapped, i, mesh.indices.length);
    return result;
  });
  const { size, mesh_count, page_count, pages, ...figures } = info;
  const named = Object.fromEntries(Object.entries(figures).map(([name, value]) => [camelCase(name), value]));
  return { meshes, pages: extents(call, info), ...named, charts: chartsOf(call, unwrapped) };
}

function polygonResult(call, unwrapped, mesh) {
  const polygons = call.ask("get_polygons", "polygon_uvs", unwrapped, mesh);
  return {
    corners: call.take(Uint32Array, polygons.corners, polygons.corner_count),
    trianglePolygon: call.take(Uint32Array, polygons.triangle_polygon,
      polygons.corner_count - 2 * polygons.polygon_count),
    cutPolygons: call.take(Uint32Array, polygons.cut_polygons, polygons.cut_count),
  };
}

// Of each page the texels that show the values at the meshes' vertices.
function texturesOf(call, unwrapped, { meshes, pages }, list, shifts) {
  const lacking = list.findIndex(({ values }) => !values);
  if (lacking >= 0) throw new BadInputError(`mesh ${lacking}: values are missing, which other meshes have`);
  const values = new Float32Array(3 * meshes.reduce((sum, { vertices }) => sum + vertices.length, 0));
  let at = 0;
  meshes.forEach(({ vertices }, i) => {
    for (const v of vertices) for (let k = 0; k < 3; ++k) values[at++] = list[i].values[3 * v + k];
  });
  const given = call.put(values);
  return pages.map(({ width, height }, page) => {
    const options = call.struct("transfer_options", { page, ...(shifts === undefined ? {} : { shifts }) });
    const texels = call.allocate(12 * width * height);
    call.check("transfer", unwrapped, given, values.length / 3, options, texels, width * height);
    return call.take(Float32Array, texels, 3 * width * height);
  });
}

// Arrays with one element, or two, an instance.
function instancesOf(call, unwrapped, mesh) {
  const { instances, instance_count } = call.ask("get_instances", "instances", unwrapped, mesh);
  const words = call.take(Uint32Array, instances, 5 * instance_count), numbers = new Float32Array(words.buffer);
  const pair = (at) => Float32Array.from({ length: 2 * instance_count }, (_, i) => numbers[5 * (i >> 1) + at + (i & 1)]);
  return { page: Uint32Array.from({ length: instance_count }, (_, i) => words[5 * i]), scale: pair(1), offset: pair(3) };
}

function seamsOf(call, atlas, unwrapped, mesh, count) {
  const place = call.allocate(count);
  call.check("get_seams", atlas, unwrapped, mesh, place, count);
  return call.take(Uint8Array, place, count);
}

// Arrays with one element a chart.
function chartsOf(call, unwrapped) {
  const { chart_count, ...charts } = call.ask("get_charts", "charts", unwrapped);
  const types = { mesh: Uint32Array, page: Uint32Array, material: Uint32Array, triangle_count: Uint32Array, kept: Uint8Array, origins: Uint8Array };
  const result = {};
  for (const [name, place] of Object.entries(charts)) {
    if (name !== "size") result[camelCase(name)] = call.take(types[name] ?? Float64Array, place, place && chart_count);
  }
  return result;
}

function extents(call, { pages, page_count }) {
  const sides = call.take(Int32Array, pages, 2 * page_count);
  return Array.from({ length: page_count }, (_, i) => ({ width: sides[2 * i], height: sides[2 * i + 1] }));
}
