import type { Primitive, Transform } from "@gltf-transform/core";
import type { Library, Unwrapped, UnwrapOptions, WorkerLibrary } from "./index.js";

export interface UnwrapPrimitivesOptions extends Omit<UnwrapOptions, "pages"> {
  /** What load() or startWorker() returned; default: one that is loaded at the first call. */
  library?: Library | WorkerLibrary;
  /** The set of uvs to make: TEXCOORD_0, TEXCOORD_1, ...; default 0. */
  texcoord?: number;
  /** Replace uvs that are there; default false: such primitives are left out. */
  overwrite?: boolean;
  /** Make seams where normals differ, for baked normal maps; default false. */
  normals?: boolean;
  /** Relative linear density of texels, 1 a primitive; default: all 1. */
  weights?: number[];
}

export interface UnwrapTransformOptions extends Omit<UnwrapPrimitivesOptions, "weights"> {
  /** Which primitives share a page; default "mesh". With "scene", texels have one size in the scene. */
  groupBy?: "primitive" | "mesh" | "scene";
  /** With "scene": unwrap each mesh once, and give each node that shows it a place for the mesh's uvs, in its extras:
   * uv * lightmapScale + lightmapOffset. Default false: nodes that show a mesh share its place. */
  instances?: boolean;
}

export function unwrap(options?: UnwrapTransformOptions): Transform;
/** Returns null if no primitive needs uvs. */
export function unwrapPrimitives(primitives: Primitive[], options?: UnwrapPrimitivesOptions): Promise<Unwrapped | null>;
