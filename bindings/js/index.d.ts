// The types of libatlas. Arrays are flat. Uvs are 0..1 over their page, with the origin at the bottom left.

export class LibatlasError extends Error {}
/** The worker was terminated. */
export class CancelledError extends LibatlasError {}
/** The data contradicts itself, or holds nothing usable. The message names the mesh and the element. */
export class BadInputError extends LibatlasError {}
/** An option is unknown or out of range. */
export class BadOptionError extends LibatlasError {}
/** Valid, but beyond what this version handles. */
export class UnsupportedError extends LibatlasError {}
/** More than the pages hold. */
export class NoSolutionError extends LibatlasError {}
export class OutOfMemoryError extends LibatlasError {}
/** A defect of the library. */
export class InternalError extends LibatlasError {}

export type NumberArray =
  | Float32Array | Float64Array | Uint8Array | Uint8ClampedArray | Uint16Array | Uint32Array
  | Int8Array | Int16Array | Int32Array | number[];

/** An array without gaps, or elements that lie apart: all in numbers of the array, not in bytes. */
export type Numbers = NumberArray | {
  array: NumberArray;
  /** Where the first element begins; default 0. */
  offset?: number;
  /** From one element to the next; default: no gaps. */
  stride?: number;
  /** Of elements; default: as many as there is room for. */
  count?: number;
};

export interface Mesh {
  /** 3 numbers a vertex, finite. */
  positions: Numbers;
  /** 3 a triangle, into positions; default: 0, 1, 2, ... */
  indices?: Numbers;
  /** 3 numbers a vertex: edges at which they differ become seams. */
  normals?: Numbers;
  /** 2 numbers each, 1 a vertex or by texcoordIndices: for keepUvs. */
  texcoords?: Numbers;
  /** 1 a corner, into texcoords; out of range: that corner has none. */
  texcoordIndices?: Numbers;
  /** 1 a face, integers. */
  materials?: Numbers;
  /** 1 a corner: not 0 if the edge from it to the next corner of its face is a seam. */
  seams?: Numbers;
  /** 1 a vertex, at least 0: a seam along an edge counts its length times the mean of its ends' weights; default 1. */
  seamWeights?: Numbers;
  /** 1 a face, times density. */
  triangleDensity?: Numbers;
  /** Linear density of texels relative to other meshes, > 0; default 1. */
  density?: number;
  /** The corners of each polygon, at least 3; default: all faces are triangles. Arrays with 1 element
   * a corner then have them polygon after polygon. */
  polygonSizes?: Numbers;
  /** 1 an instance: its linear density of texels relative to the others, > 0. The mesh is unwrapped once, and each
   * instance gets a place for its uvs. */
  instances?: Numbers;
  /** 3 a vertex, finite, such as colours: the result has textures that show them. */
  values?: Numbers;
}

export type Effort = "fast" | "standard" | "best";

export interface Callbacks {
  /** Of one stage after the other, from 0 to 1. What it throws, the call throws. */
  onProgress?: (stage: string, fraction: number) => void;
  /** One line about something that was repaired or is worth knowing. */
  onWarning?: (line: string) => void;
  /** Library looks at it when it tells progress; WorkerLibrary stops at once. The call throws the signal's reason. */
  signal?: AbortSignal;
}

export interface UnwrapOptions extends Callbacks {
  /** Bound over 99.9 % of each chart's area, > 1; default 1.25. */
  maxStretch?: number;
  /** Most degrees between a chart's axis and its normals; default 0: any. */
  coneDegrees?: number;
  /** Bend from which on a seam costs a quarter, above 0..180; default 60. */
  creaseDegrees?: number;
  /** Wasteful charts are cut; 0: never, below 1; default 0.72. */
  minFill?: number;
  /** For keepUvs: width / height of the page of the given uvs; default 1. */
  uvAspect?: number;
  /** Times density; default 0: as many as the pages hold. */
  texelsPerUnit?: number;
  /** The most pages to use; default 1. */
  pages?: number;
  /** Largest side in texels, 64..16384; default 2048. */
  pageSize?: number;
  /** Texels free around each chart; default 2. */
  padding?: number;
  /** That pages are to be baked with, 0..10; default 0. */
  mipLevels?: number;
  /** Charts begin and end at multiples of so many texels; default 1. */
  alignment?: number;
  /** Effort; default "standard". */
  charts?: Effort;
  packing?: Effort;
  /** A chart holds one material only; default true. */
  splitAtMaterials?: boolean;
  /** Keep the charts of the given texcoords where they are usable; default false. */
  keepUvs?: boolean;
  /** Turn charts to pack better; default true. */
  allowRotation?: boolean;
  /** Sides are equal and powers of two; default false. */
  square?: boolean;
  /** Keep parts of one chart apart, as lightmaps need; default false. */
  partGaps?: boolean;
  /** Charts, uvs and places of this stay wherever triangles are unchanged; not with keepUvs or instances. */
  like?: EarlierUvs;
  /** What seams count beside stretch, 0.001..1000: more gives fewer charts and shorter seams; default 1. */
  seamWeight?: number;
  /** Begin with the defaults for lightmaps: square pages, room for mip levels, parts of charts kept apart. */
  lightmap?: boolean | { texelsPerMetre?: number; metresPerUnit?: number };
  /** Return the seams of each mesh; default false. */
  seams?: boolean;
  /** Of textures: samples a texel, 1..64; default 4. */
  shifts?: number;
}

/** An earlier state of all meshes, which are one here. Triangles are found by their positions; those without usable
 * uvs are made as new. */
export interface EarlierUvs {
  /** 3 numbers each. */
  positions: Numbers;
  /** 3 a triangle. */
  indices?: Numbers;
  /** 2 numbers each, 1 a position or by uvIndices: 0..1 over their page, origin bottom left. */
  uvs: Numbers;
  /** 3 a triangle. One out of range: that corner has none. */
  uvIndices?: Numbers;
  /** 1 a triangle; without it all lie on page 0. */
  trianglePage?: Numbers;
  pages: Page[];
  /** 1 a position: the number of its mesh, in which alone its triangles are looked for; needed where meshes touch. */
  objects?: Numbers;
  /** How far a corner may have moved for its triangle to be unchanged, as a share of the mean edge; default 0.01. */
  tolerance?: number;
}

export interface Page {
  /** Texels. */
  width: number;
  height: number;
}

/** Vertices to draw a mesh with. A vertex on a seam has a copy for each side. Triangle t is that of the mesh. */
export interface UnwrappedMesh {
  /** 1 a vertex: the vertex of the mesh that it copies. */
  vertices: Uint32Array;
  /** 2 a vertex. */
  uvs: Float32Array;
  /** 3 a triangle, into vertices. */
  indices: Uint32Array;
  trianglePage: Uint32Array;
  triangleChart: Uint32Array;
  /** With the option seams, 1 a corner of the given faces: 1 if the edge to the next corner is a seam. */
  seams?: Uint8Array;
  /** Of a mesh with instances, whose uvs are 0..1 over a rectangle of its own: an instance has them at
   * uv * scale + offset of its page. 1 an instance; scale and offset 2. */
  instances?: { page: Uint32Array; scale: Float32Array; offset: Float32Array };
  /** Of polygons: 1 a corner, in the mesh's order, into vertices. */
  corners?: Uint32Array;
  /** Of polygons: 1 a triangle. */
  trianglePolygon?: Uint32Array;
  /** Polygons in which a seam runs; corners has one part of these only. */
  cutPolygons?: Uint32Array;
}

/** Arrays with 1 element a chart. */
export interface Charts {
  mesh: Uint32Array;
  page: Uint32Array;
  material: Uint32Array;
  triangleCount: Uint32Array;
  /** 1: with the shape that the given uvs had. */
  kept: Uint8Array;
  /** On the surface. */
  area: Float64Array;
  stretchL2: Float64Array;
  stretch999: Float64Array;
  stretchMax: Float64Array;
  /** What it has of the uvs of `like`. 0: nothing; 1: repaired where it lay; 2: kept as it was. Empty: nothing was found again. */
  origins: Uint8Array;
}

export interface Unwrapped {
  meshes: UnwrappedMesh[];
  pages: Page[];
  charts: Charts;
  chartCount: number;
  /** That were reached, where density is 1. */
  texelsPerUnit: number;
  /** Area of the charts / area of the pages. */
  utilization: number;
  /** Over all charts (Sander et al. 2001); 1 is perfect. */
  stretchL2: number;
  /** Of the worst chart: bound on stretch over 99.9 % of its area. */
  stretch999: number;
  /** Of the worst triangle. */
  stretchMax: number;
  /** Mean ratio of larger to smaller singular value; 1 keeps all angles. */
  conformalMean: number;
  seamLength: number;
  surfaceArea: number;
  flippedTriangles: number;
  thinTriangles: number;
  texelsDrawnTwice: number;
  keptCharts: number;
  reflattenedCharts: number;
  /** Of meshes with values, 1 a page: 3 a texel, rows from the bottom. Bilinear interpolation of them is as near to the values over
   * each chart as it can be, in the least squares sense; texels beside charts are filled. */
  textures?: Float32Array[];
}

export interface PackOptions extends Callbacks {
  /** The largest page; default 2048 x 2048. Height 0: open height; both 0: one page, free in both directions. */
  page?: Page;
  /** Default 0: as many as needed. */
  maxPages?: number;
  /** By quarter turns; default false. */
  allowRotation?: boolean;
  /** Texels between any two; default 0. */
  padding?: number;
  /** Texels along the page's edges; default 0. */
  border?: number;
  /** Items begin at multiples of it; default 1. */
  alignment?: number;
  /** Pages are cut to what is used; default false. */
  crop?: boolean;
  /** Then their sides are rounded up; default false. */
  powerOfTwo?: boolean;
  square?: boolean;
  /** Default "standard". */
  preset?: Effort;
  /** Of "best", in seconds; default 1. */
  timeBudget?: number;
  /** The most layouts that it tries; default 0: no limit. */
  effort?: number;
  seed?: number;
}

/** Arrays have 1 element a rectangle; it covers [x, x + width) x [y, y + height), sides swapped if rotated. */
export interface Packed {
  /** -1: there was no room. */
  page: Int32Array;
  x: Int32Array;
  y: Int32Array;
  rotated: Uint8Array;
  pages: Page[];
  unplacedCount: number;
  utilization: number;
  /** No packing of all that fit a page needs fewer pages. */
  pageLowerBound: number;
}

export interface Islands {
  /** 2 numbers each, finite. */
  uvs: Numbers;
  /** 3 a triangle; triangles that name a uv in common are one island. */
  indices?: Numbers;
}

export interface IslandOptions extends Callbacks {
  /** Texels of the page per unit of uv; default 0: as many as fit. */
  texelsPerUv?: number;
  pages?: number;
  pageSize?: number;
  padding?: number;
  alignment?: number;
  allowRotation?: boolean;
  square?: boolean;
  preset?: Effort;
}

export interface PackedIslands {
  uvs: Float32Array;
  triangleIsland: Uint32Array;
  islandPage: Uint32Array;
  /** By how much each was turned, in radians counterclockwise. */
  islandAngle: Float64Array;
  /** 2 an island: texel x, y of the given uv (0, 0). */
  islandOffset: Float64Array;
  pages: Page[];
  texelsPerUv: number;
  utilization: number;
}

/** Calls block. All throw LibatlasError, or what a callback throws. */
export interface Library {
  readonly version: string;
  unwrap(meshes: Mesh | Mesh[], options?: UnwrapOptions): Unwrapped;
  /** rects: width and height of each, in texels. */
  packRects(rects: Numbers, options?: PackOptions): Packed;
  packIslands(islands: Islands, options?: IslandOptions): PackedIslands;
}

/** The same calls in a worker, one after the other. */
export interface WorkerLibrary {
  unwrap(meshes: Mesh | Mesh[], options?: UnwrapOptions): Promise<Unwrapped>;
  packRects(rects: Numbers, options?: PackOptions): Promise<Packed>;
  packIslands(islands: Islands, options?: IslandOptions): Promise<PackedIslands>;
  /** Ends the worker; calls that have not ended are rejected with CancelledError. */
  terminate(): void;
}

/** The compiled library, its bytes, a Response or an address; default: libatlas.wasm beside this file. */
export type WasmSource = WebAssembly.Module | ArrayBuffer | ArrayBufferView | Response | URL | string;

export function load(options?: { wasm?: WasmSource }): Promise<Library>;
/** worker: starts the file worker.js of this package, for pages that have it elsewhere. */
export function startWorker(options?: { wasm?: WasmSource; worker?: () => any }): Promise<WorkerLibrary>;

/** Values of vertices, `width` each, for the vertices of a result. */
export function gather<T extends Float32Array | Float64Array | Uint8Array | Uint16Array | Uint32Array | Int8Array | Int16Array | Int32Array>(
  values: T, vertices: Uint32Array, width: number): T;
