// Unwraps a mesh with the native library, for comparisons with WebAssembly.
// Usage: native MESH RESULT: MESH holds the numbers of positions and indices (uint32), the
// positions (3 floats each) and the indices; RESULT gets the numbers of charts, vertices and
// triangles, the vertices, uvs and indices, and the charts of the triangles. Prints the CPU seconds
// of the second of two calls, on one thread.
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

#include "libatlas/c/atlas.h"

static void check(libatlas_context* context, libatlas_status status) {
  if (!status) return;
  fprintf(stderr, "%s\n", libatlas_message(context));
  exit(1);
}

static double unwrap(libatlas_context* context, const libatlas_mesh* mesh,
                     libatlas_unwrapped** result) {
  const clock_t begun = clock();
  libatlas_atlas* atlas;
  check(context, libatlas_atlas_create(context, &atlas));
  check(context, libatlas_add_mesh(context, atlas, mesh, NULL));
  check(context, libatlas_unwrap(context, atlas, NULL, result));
  libatlas_atlas_destroy(atlas);
  return (double)(clock() - begun) / CLOCKS_PER_SEC;
}

int main(int count, char** arguments) {
  if (count != 3) return 2;
  FILE* in = fopen(arguments[1], "rb");
  uint32_t counts[3];
  if (!in || fread(counts, 4, 2, in) != 2) return 2;
  float* positions = malloc(12 * (size_t)counts[0]);
  uint32_t* indices = malloc(4 * (size_t)counts[1]);
  if (fread(positions, 12, counts[0], in) != counts[0] ||
      fread(indices, 4, counts[1], in) != counts[1])
    return 2;
  fclose(in);

  libatlas_mesh mesh;
  libatlas_mesh_init(&mesh, sizeof mesh);
  mesh.positions = positions;
  mesh.position_count = counts[0];
  mesh.indices = indices;
  mesh.index_count = counts[1];
  mesh.index_bytes = 4;
  libatlas_context* context = libatlas_context_create();
  libatlas_set_threads(context, 1);
  libatlas_unwrapped* result;
  unwrap(context, &mesh, &result);
  libatlas_unwrapped_destroy(result);
  printf("%.4f\n", unwrap(context, &mesh, &result));

  libatlas_atlas_info info = {.size = sizeof info};
  libatlas_mesh_uvs uvs = {.size = sizeof uvs};
  check(context, libatlas_get_info(context, result, &info));
  check(context, libatlas_get_mesh(context, result, 0, &uvs));
  FILE* out = fopen(arguments[2], "wb");
  if (!out) return 2;
  counts[0] = (uint32_t)info.chart_count;
  counts[1] = (uint32_t)uvs.vertex_count;
  counts[2] = (uint32_t)uvs.triangle_count;
  fwrite(counts, 4, 3, out);
  fwrite(uvs.vertices, 4, uvs.vertex_count, out);
  fwrite(uvs.uvs, 8, uvs.vertex_count, out);
  fwrite(uvs.indices, 12, uvs.triangle_count, out);
  fwrite(uvs.triangle_chart, 4, uvs.triangle_count, out);
  return fclose(out) ? 2 : 0;
}
