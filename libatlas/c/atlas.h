// libatlas for C and for every language that can call C: uvs for triangle meshes, several of them
// on one atlas, and packing. docs/c.md has examples and says what stays the same between versions.
//
// Structs: each begins with its size, so that later versions can add members at the end. Programs
// that were compiled with an earlier header keep working, and so do those compiled with a later one
// as long as they do not use what is new. What is passed in gets its size and its defaults from the
// function with its name and _init, as in libatlas_mesh_init(&mesh, sizeof mesh). What is handed
// out only needs the size: uvs.size = sizeof uvs. Structs that lie in arrays have no size, and
// stay as they are.
//
// Errors: calls that can fail return a status. They change nothing then, and write null or 0 to
// what they would have returned. libatlas_message() has one line of text that names the element and
// the remedy. Pointers may be null where that is said.
//
// Threads: a context and an atlas are for one thread at a time, except in libatlas_cancel();
// results may be read from several threads at once. There is no global state.
//
// Memory: arrays that are passed in are not used after the call. Arrays that are handed out belong
// to the object that they were asked of, and live as long as it does.
#pragma once

#include <stddef.h>
#include <stdint.h>

#if defined(_WIN32) && defined(LIBATLAS_C_BUILT)
#define LIBATLAS_API __declspec(dllexport)
#elif defined(_WIN32)
#define LIBATLAS_API __declspec(dllimport)
#elif defined(__GNUC__)
#define LIBATLAS_API __attribute__((visibility("default")))
#else
#define LIBATLAS_API
#endif

#ifdef __cplusplus
extern "C" {
#endif

// ---- Versions ----

#define LIBATLAS_VERSION_MAJOR 0
#define LIBATLAS_VERSION_MINOR 1
#define LIBATLAS_VERSION_PATCH 0

// The version of the library that runs, as 10000 major + 100 minor + patch.
LIBATLAS_API uint32_t libatlas_version(void);

// ---- Status ----

typedef int32_t libatlas_status;
enum {
  LIBATLAS_OK = 0,
  LIBATLAS_CANCELLED = 1,
  LIBATLAS_BAD_INPUT = 2,    // the data contradicts itself, or holds nothing usable
  LIBATLAS_BAD_OPTION = 3,   // an option or the size of a struct is out of range
  LIBATLAS_UNSUPPORTED = 4,  // valid, but beyond what this version handles
  LIBATLAS_NO_SOLUTION = 5,  // more than the pages hold
  LIBATLAS_OUT_OF_MEMORY = 6,
  LIBATLAS_CALLBACK_FAILED = 7,  // a callback written in C++ threw an exception
  LIBATLAS_INTERNAL = 8          // a defect of the library
};

// ---- Context: threads, progress, cancelling, messages ----

typedef struct libatlas_context libatlas_context;

// Returns null if there is no memory. Destroying null does nothing; so it is with all objects.
LIBATLAS_API libatlas_context* libatlas_context_create(void);
LIBATLAS_API void libatlas_context_destroy(libatlas_context* context);

// Of the last call that was given this context and failed; empty if none did. It lives until the
// next call with this context.
LIBATLAS_API const char* libatlas_message(const libatlas_context* context);

// Number of threads; 0 or less: as many as the machine has, which is the default. Results never
// depend on it.
LIBATLAS_API void libatlas_set_threads(libatlas_context* context, int32_t threads);

// Called with rising fractions from 0 to 1 of one stage after the other, from any thread, but never
// from two at once. Returns not 0 to cancel the call. Null: none.
typedef int (*libatlas_progress)(void* user, const char* stage, double fraction);
LIBATLAS_API void libatlas_set_progress(libatlas_context* context, libatlas_progress progress,
                                        void* user);

// Called likewise with one line about something that was repaired or is worth knowing. Null: none.
typedef void (*libatlas_warning)(void* user, const char* line);
LIBATLAS_API void libatlas_set_warning(libatlas_context* context, libatlas_warning warning,
                                       void* user);

// Makes the call that runs with this context return LIBATLAS_CANCELLED soon, or else the next one,
// which then lets later ones run. May be called from any thread and from signal handlers.
LIBATLAS_API void libatlas_cancel(libatlas_context* context);

typedef struct libatlas_extent {
  int32_t width, height;  // texels
} libatlas_extent;

// ---- Meshes ----

// A mesh of triangles, or of polygons. Strides are in bytes from one element to the next; 0 stands
// for no gaps. Numbers need not be aligned.
typedef struct libatlas_mesh {
  size_t size;
  const void* positions;  // 3 floats each, finite
  size_t position_count, position_stride;
  const void* indices;  // 3 a triangle, into positions
  size_t index_count;
  size_t index_bytes;  // 4, or 2 for indices of 16 bits
  // 3 floats each, 1 a position: edges at which they differ become seams, as baked normal maps need
  // them. Null: none do for that.
  const void* normals;
  size_t normal_stride;
  const void* texcoords;  // for keep_uvs: 2 floats each, 1 a position; or null
  size_t texcoord_count, texcoord_stride;
  // Where there is not one texcoord a position: index_count indices of index_bytes into them. An
  // index out of range: that corner has none. Or null.
  const void* texcoord_indices;
  const uint32_t* materials;  // 1 a triangle, or null: all alike
  const uint8_t* seams;  // 3 a triangle: not 0 if the edge from that corner to the next is a seam,
                         // across which no chart continues; or null. Either side may say so.
  const float* triangle_density;  // 1 a triangle, times `density`, or null
  float density;                  // relative linear texel density, finite and > 0; default 1
  // The corners of each polygon, at least 3; null: all are triangles. `indices`, `texcoord_indices`
  // and `seams` then have 1 element a corner, polygon after polygon, and `materials` and
  // `triangle_density` 1 a polygon. The sizes add up to index_count. Polygons may be concave and
  // enclose holes that are joined to the outline by an edge there and back.
  const uint32_t* polygon_sizes;
  size_t polygon_count;
  // 1 a position, at least 0 and finite: a seam along an edge counts its length times the mean of
  // its ends' weights, so that seams keep away from high ones. Null: all are 1.
  const float* seam_weights;
} libatlas_mesh;
LIBATLAS_API libatlas_status libatlas_mesh_init(libatlas_mesh* mesh, size_t size);

// Meshes that are to share an atlas.
typedef struct libatlas_atlas libatlas_atlas;
LIBATLAS_API libatlas_status libatlas_atlas_create(libatlas_context* context,
                                                   libatlas_atlas** atlas);
LIBATLAS_API void libatlas_atlas_destroy(libatlas_atlas* atlas);

// Adds a copy of a mesh. Meshes are numbered from 0 and never joined to each other, also where they
// touch. `number` may be null. Status: BAD_INPUT with the mesh and the triangle or polygon;
// BAD_OPTION for the size of the struct; UNSUPPORTED beyond 2^30 triangles or 2^32 positions in
// all, or for an outline too intricate to be cut into triangles.
LIBATLAS_API libatlas_status libatlas_add_mesh(libatlas_context* context, libatlas_atlas* atlas,
                                               const libatlas_mesh* mesh, uint32_t* number);

// Adds a copy of a mesh that is shown `count` times, at least once. It is unwrapped once, and each
// instance gets a place for a copy of its uvs, larger by its relative linear density; null: all 1.
// libatlas_get_instances() has the places. Every other mesh of the atlas then gets a rectangle of
// its own, too. Status: that of libatlas_add_mesh(); BAD_INPUT with the instance for a density that
// is not finite and > 0, and for no instance; UNSUPPORTED for 2^30 instances.
LIBATLAS_API libatlas_status libatlas_add_instances(libatlas_context* context,
                                                    libatlas_atlas* atlas,
                                                    const libatlas_mesh* mesh,
                                                    const float* densities, size_t count,
                                                    uint32_t* number);

// ---- Unwrapping ----

typedef int32_t libatlas_preset;
enum { LIBATLAS_FAST = 0, LIBATLAS_STANDARD = 1, LIBATLAS_BEST = 2 };

// An earlier state of the meshes of an atlas, with its uvs, as in EarlierUvs of unwrap/like.h. All
// meshes are one here. Numbers and orders do not matter: triangles are found by their positions.
// Triangles without usable uvs (such as uvs that are not finite) are made as new.
typedef struct libatlas_earlier_uvs {
  size_t size;
  const void* positions;  // 3 floats each, finite
  size_t position_count, position_stride;
  const void* indices;  // 3 a triangle, into positions
  size_t index_count;
  size_t index_bytes;  // 4, or 2 for indices of 16 bits
  const void* uvs;     // 2 floats each: 0..1 over their page, origin bottom left
  size_t uv_count, uv_stride;
  // Where uvs are not numbered as positions are: index_count indices of index_bytes into them. An
  // index out of range: that corner has none. Or null.
  const void* uv_indices;
  const uint32_t* triangle_page;  // 1 a triangle, or null: all lie on page 0
  const libatlas_extent* pages;   // at least one; sides of 1..16384
  size_t page_count;
  // How far a corner may have moved for its triangle to be unchanged, as a share of the mean edge;
  // at least 0, below 1; default 0.01.
  double tolerance;
  // 1 a position: the number of its mesh, in which alone its triangles are then looked for; needed
  // where meshes touch or lie on each other. Null: triangles may be of any mesh.
  const uint32_t* objects;
} libatlas_earlier_uvs;
LIBATLAS_API libatlas_status libatlas_earlier_uvs_init(libatlas_earlier_uvs* earlier, size_t size);

// Flags are 0 or 1.
typedef struct libatlas_unwrap_options {
  size_t size;
  double max_stretch;      // bound over 99.9 % of each chart's area, > 1; default 1.25
  double cone_degrees;     // most degrees between a chart's axis and its normals; default 0: any
  double crease_degrees;   // bend from which on a seam costs a quarter, above 0..180; default 60
  double min_fill;         // wasteful charts are cut; 0: never, below 1; default 0.72
  double uv_aspect;        // for keep_uvs: width / height of the page of the given uvs; default 1
  double texels_per_unit;  // times density; default 0: as many as the pages hold
  uint32_t pages;          // the most pages to use; default 1
  int32_t page_size;       // largest side in texels, 64..16384; default 2048
  int32_t padding;         // texels free around each chart; default 2
  int32_t mip_levels;      // that pages are to be baked with, 0..10; default 0
  int32_t alignment;       // charts begin and end at multiples of it; default 1
  libatlas_preset charts, packing;  // effort; default LIBATLAS_STANDARD
  int32_t split_at_materials;       // a chart holds one material only; default 1
  int32_t keep_uvs;  // keep the charts of the given texcoords where they are usable; default 0
  int32_t allow_rotation;  // turn charts to pack better; default 1
  int32_t square;          // sides are equal and powers of two; default 0
  int32_t part_gaps;       // keep parts of one chart apart, as lightmaps need; default 0
  // Charts, uvs and places of this stay wherever triangles are unchanged, see UnwrapOptions::like
  // of unwrap/unwrap.h. Not with keep_uvs or instances. Default null: all is new.
  const libatlas_earlier_uvs* like;
  // What seams count beside stretch, 0.001..1000: more gives fewer charts and shorter seams, which
  // stretch more within max_stretch. Default 1, as 0 is.
  double seam_weight;
} libatlas_unwrap_options;
LIBATLAS_API libatlas_status libatlas_unwrap_options_init(libatlas_unwrap_options* options,
                                                          size_t size);

// The same for lightmaps, as lightmap_options() of unwrap/unwrap.h: square pages whose sides are
// powers of two, room for mip levels, and parts of charts kept apart. `texels_per_metre` 0: as many
// as the pages hold. `metres_per_unit`: of the positions.
LIBATLAS_API libatlas_status libatlas_lightmap_options_init(libatlas_unwrap_options* options,
                                                            size_t size, double texels_per_metre,
                                                            double metres_per_unit);

// What unwrapping returns. It does not refer to the atlas or the context.
typedef struct libatlas_unwrapped libatlas_unwrapped;

// Unwraps all meshes of an atlas; `options` may be null. Nothing is left out: triangle t of a mesh
// is triangle t of its result, with its corners in the same order; of polygons each has its size -
// 2 triangles, one polygon after the other. May be called again, with other options. Status:
// BAD_INPUT without a mesh or with the element of `like` that is not usable, BAD_OPTION,
// NO_SOLUTION (more charts than the pages hold texels for), CANCELLED.
LIBATLAS_API libatlas_status libatlas_unwrap(libatlas_context* context, const libatlas_atlas* atlas,
                                             const libatlas_unwrap_options* options,
                                             libatlas_unwrapped** unwrapped);
LIBATLAS_API void libatlas_unwrapped_destroy(libatlas_unwrapped* unwrapped);

// The whole atlas and its quality.
typedef struct libatlas_atlas_info {
  size_t size;
  size_t mesh_count, chart_count, page_count;
  const libatlas_extent* pages;
  double texels_per_unit;  // that were reached, where density is 1
  double utilization;      // area of the charts / area of the pages
  double stretch_l2;       // over all charts (Sander et al. 2001); 1 is perfect
  double stretch_999;      // of the worst chart: bound on stretch over 99.9 % of its area
  double stretch_max;      // of the worst triangle
  double conformal_mean;   // mean ratio of larger to smaller singular value; 1 keeps all angles
  double seam_length;      // of edges that two triangles share in space, but not in uv
  double surface_area;
  uint64_t flipped_triangles;   // whose uvs are clockwise, since their neighbours are turned so
  uint64_t thin_triangles;      // slivers that rounding to floats closes or turns over
  uint64_t texels_drawn_twice;  // whose centres more than one triangle covers
  uint64_t kept_charts;         // with keep_uvs: given charts that were kept,
  uint64_t reflattened_charts;  // and that were flattened anew
} libatlas_atlas_info;
LIBATLAS_API libatlas_status libatlas_get_info(libatlas_context* context,
                                               const libatlas_unwrapped* unwrapped,
                                               libatlas_atlas_info* info);

// Vertices to draw a mesh with. A vertex on a seam has a copy for each side.
typedef struct libatlas_mesh_uvs {
  size_t size;
  size_t vertex_count, triangle_count;
  const uint32_t* vertices;        // 1 a vertex: the position of the mesh that it copies
  const float* uvs;                // 2 a vertex: 0..1 over its page, origin bottom left
  const uint32_t* indices;         // 3 a triangle, into the vertices
  const uint32_t* triangle_page;   // 1 a triangle
  const uint32_t* triangle_chart;  // 1 a triangle
} libatlas_mesh_uvs;
LIBATLAS_API libatlas_status libatlas_get_mesh(libatlas_context* context,
                                               const libatlas_unwrapped* unwrapped, uint32_t mesh,
                                               libatlas_mesh_uvs* uvs);

// Where an instance has the mesh's uvs: at uv * scale + offset of its page.
typedef struct libatlas_instance {
  uint32_t page;
  float scale[2], offset[2];  // 0..1 over the page, origin bottom left
} libatlas_instance;

// The instances of a mesh that libatlas_add_instances() has added; none of other meshes. The uvs of
// the mesh are 0..1 over a rectangle of its own, and its triangle_page is that of the first
// instance.
typedef struct libatlas_instances {
  size_t size;
  size_t instance_count;
  const libatlas_instance* instances;
} libatlas_instances;
LIBATLAS_API libatlas_status libatlas_get_instances(libatlas_context* context,
                                                    const libatlas_unwrapped* unwrapped,
                                                    uint32_t mesh, libatlas_instances* instances);

// Uvs of a mesh of polygons, one per corner. No seam runs inside a polygon, except in those listed
// as cut: they do not lie flat in one piece within the bounds of the options, or given uvs cut
// them. `corners` has one part of these only; they can be drawn as their triangles.
typedef struct libatlas_polygon_uvs {
  size_t size;
  size_t polygon_count, corner_count;  // 0 of a mesh of triangles
  // 1 a corner, in the mesh's order: into the vertices of libatlas_mesh_uvs.
  const uint32_t* corners;
  const uint32_t* triangle_polygon;  // 1 a triangle of libatlas_mesh_uvs
  size_t cut_count;
  const uint32_t* cut_polygons;  // ascending
} libatlas_polygon_uvs;
LIBATLAS_API libatlas_status libatlas_get_polygons(libatlas_context* context,
                                                   const libatlas_unwrapped* unwrapped,
                                                   uint32_t mesh, libatlas_polygon_uvs* polygons);

// What a chart has of the uvs of `like`.
enum {
  LIBATLAS_MADE = 0,      // nothing: it is new, or has been moved
  LIBATLAS_REPAIRED = 1,  // unchanged triangles stay; others were lost, or have been laid beside
  LIBATLAS_KEPT = 2       // all that it had, at its place: its texels need not be made again
};

// All charts of the atlas; arrays have 1 element a chart.
typedef struct libatlas_charts {
  size_t size;
  size_t chart_count;
  const uint32_t* mesh;
  const uint32_t* page;
  const uint32_t* material;
  const uint32_t* triangle_count;
  const uint8_t* kept;       // 1: with the shape that the given uvs had
  const double* area;        // on the surface
  const double* stretch_l2;  // as in libatlas_atlas_info
  const double* stretch_999;
  const double* stretch_max;
  const uint8_t* origins;  // LIBATLAS_MADE etc.; null: nothing of `like` was found again
} libatlas_charts;
LIBATLAS_API libatlas_status libatlas_get_charts(libatlas_context* context,
                                                 const libatlas_unwrapped* unwrapped,
                                                 libatlas_charts* charts);

// For each half-edge of a mesh, 3 a triangle as in libatlas_mesh: 1 if the edge from that corner to
// the next is a seam of the result, where another triangle has the same edge in space, but not in
// uv; else 0. `count` is the length of `seams`, 3 times the mesh's triangles. Of polygons: for each
// corner, as in libatlas_mesh. `atlas` is what was unwrapped.
LIBATLAS_API libatlas_status libatlas_get_seams(libatlas_context* context,
                                                const libatlas_atlas* atlas,
                                                const libatlas_unwrapped* unwrapped, uint32_t mesh,
                                                uint8_t* seams, size_t count);

// ---- Values at vertices into textures ----

typedef struct libatlas_transfer_options {
  size_t size;
  uint32_t page;   // of the atlas; default 0
  int32_t shifts;  // samples a texel, 1..64; rounded up to a square; default 4
} libatlas_transfer_options;
LIBATLAS_API libatlas_status libatlas_transfer_options_init(libatlas_transfer_options* options,
                                                            size_t size);

// Writes values at vertices into the texels of a page, whose bilinear interpolation then comes as
// near to them over each chart as it can, in the least squares sense. Texels beside charts are
// filled from those of the charts. `values`: 3 floats, finite, for each vertex of
// libatlas_mesh_uvs, one mesh after the other; `value_count` of these in all. `texels`: room for 3
// floats a texel, rows from the bottom; `texel_count` is width times height of the page. `options`
// may be null. Status: BAD_INPUT for the counts or a value that is not finite, BAD_OPTION,
// CANCELLED.
LIBATLAS_API libatlas_status libatlas_transfer(libatlas_context* context,
                                               const libatlas_unwrapped* unwrapped,
                                               const float* values, size_t value_count,
                                               const libatlas_transfer_options* options,
                                               float* texels, size_t texel_count);

// ---- Packing rectangles ----

typedef struct libatlas_pack_options {
  size_t size;
  // The largest page; default 2048 x 2048. Height 0: one page of open height. Both 0: one page that
  // is free in both directions.
  libatlas_extent page;
  uint32_t max_pages;            // default 0: as many as needed
  int32_t allow_rotation;        // by quarter turns; default 0
  int32_t padding;               // texels between any two items; default 0
  int32_t border;                // texels along the page's edges; default 0
  int32_t alignment;             // items begin at multiples of it; default 1
  int32_t crop;                  // pages are cut to what is used; default 0
  int32_t power_of_two, square;  // then their sides are rounded up; default 0
  libatlas_preset preset;        // default LIBATLAS_STANDARD
  double time_budget;            // of LIBATLAS_BEST, in seconds; default 1
  uint64_t effort;               // the most layouts it tries; default 0: no limit
  uint64_t seed;                 // default 1
} libatlas_pack_options;
LIBATLAS_API libatlas_status libatlas_pack_options_init(libatlas_pack_options* options,
                                                        size_t size);

#define LIBATLAS_NO_PAGE UINT32_MAX

// The item covers [x, x + width) x [y, y + height) of its page, with its sides swapped if it is
// rotated (not 0), which is a quarter turn counterclockwise.
typedef struct libatlas_placement {
  uint32_t page;  // LIBATLAS_NO_PAGE: not placed
  int32_t x, y;
  int32_t rotated;
} libatlas_placement;

typedef struct libatlas_packed libatlas_packed;

// Packs `count` rectangles; `options` may be null. Those for which there is no room are not placed,
// which is no error. Status: BAD_INPUT for a negative side, BAD_OPTION, CANCELLED.
LIBATLAS_API libatlas_status libatlas_pack_rects(libatlas_context* context,
                                                 const libatlas_extent* rects, size_t count,
                                                 const libatlas_pack_options* options,
                                                 libatlas_packed** packed);
LIBATLAS_API void libatlas_packed_destroy(libatlas_packed* packed);

typedef struct libatlas_packed_info {
  size_t size;
  size_t placement_count, page_count, unplaced_count;
  const libatlas_placement* placements;  // 1 a rectangle
  const libatlas_extent* pages;
  double utilization;         // area of what was placed / area of the pages
  uint32_t page_lower_bound;  // no packing of all that fit a page needs fewer pages
} libatlas_packed_info;
LIBATLAS_API libatlas_status libatlas_get_packed(libatlas_context* context,
                                                 const libatlas_packed* packed,
                                                 libatlas_packed_info* info);

// ---- Packing islands, the charts of uvs that are there ----

// Triangles that name a uv in common are one island.
typedef struct libatlas_islands {
  size_t size;
  const void* uvs;  // 2 floats each, finite
  size_t uv_count, uv_stride;
  const void* indices;  // 3 a triangle, into uvs
  size_t index_count;
  size_t index_bytes;  // 4 or 2
} libatlas_islands;
LIBATLAS_API libatlas_status libatlas_islands_init(libatlas_islands* islands, size_t size);

typedef struct libatlas_island_options {
  size_t size;
  double texels_per_uv;    // texels of the page per unit of uv; default 0: as many as fit
  uint32_t pages;          // the most pages to use; default 1
  int32_t page_size;       // largest side in texels, 64..16384; default 2048
  int32_t padding;         // texels free around each island; default 2
  int32_t alignment;       // islands own whole cells of so many texels; default 1
  int32_t allow_rotation;  // default 1
  int32_t square;          // sides are equal and powers of two; default 0
  libatlas_preset preset;  // default LIBATLAS_STANDARD
} libatlas_island_options;
LIBATLAS_API libatlas_status libatlas_island_options_init(libatlas_island_options* options,
                                                          size_t size);

typedef struct libatlas_packed_islands libatlas_packed_islands;

// Moves, turns and scales all islands by one factor so that none lies on another; `options` may be
// null. Status: BAD_INPUT with the triangle, BAD_OPTION, NO_SOLUTION, CANCELLED.
LIBATLAS_API libatlas_status libatlas_pack_islands(libatlas_context* context,
                                                   const libatlas_islands* islands,
                                                   const libatlas_island_options* options,
                                                   libatlas_packed_islands** packed);
LIBATLAS_API void libatlas_packed_islands_destroy(libatlas_packed_islands* packed);

typedef struct libatlas_packed_islands_info {
  size_t size;
  size_t uv_count, triangle_count, island_count, page_count;
  const float* uvs;  // 2 a uv: 0..1 over its page, origin bottom left; 0 where no triangle names it
  const uint32_t* triangle_island;
  const uint32_t* island_page;  // 1 an island
  const double* island_angle;   // likewise: by how much it was turned, in radians counterclockwise
  const double* island_offset;  // 2 an island: texel x, y of the given uv (0, 0)
  const libatlas_extent* pages;
  double texels_per_uv;  // that were reached
  double utilization;    // area of the islands / area of the pages
} libatlas_packed_islands_info;
LIBATLAS_API libatlas_status libatlas_get_packed_islands(libatlas_context* context,
                                                         const libatlas_packed_islands* packed,
                                                         libatlas_packed_islands_info* info);

#ifdef __cplusplus
}
#endif
