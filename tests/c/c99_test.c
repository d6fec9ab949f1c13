/* The header compiles as C99, and a program in C gets by with it: a cube is unwrapped. */
#include "libatlas/c/atlas.h"

#include <stdio.h>

static int failures = 0;

static void expect(int holds, const char* what) {
  if (holds) return;
  fprintf(stderr, "does not hold: %s\n", what);
  ++failures;
}

static int count_calls(void* user, const char* stage, double fraction) {
  ++*(int*)user;
  return stage[0] == '\0' || fraction > 1;
}

static const float kCorners[8][3] = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0},
                                     {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}};
static const uint16_t kTriangles[36] = {3, 2, 1, 3, 1, 0, 4, 5, 6, 4, 6, 7, 0, 1, 5, 0, 5, 4,
                                        1, 2, 6, 1, 6, 5, 2, 3, 7, 2, 7, 6, 3, 0, 4, 3, 4, 7};

int main(void) {
  libatlas_context* context = libatlas_context_create();
  libatlas_atlas* atlas = NULL;
  libatlas_unwrapped* unwrapped = NULL;
  libatlas_mesh mesh;
  libatlas_mesh_uvs uvs;
  libatlas_atlas_info info;
  int calls = 0;
  size_t i;
  libatlas_set_progress(context, count_calls, &calls);
  expect(libatlas_mesh_init(&mesh, sizeof mesh) == LIBATLAS_OK, "mesh_init");
  mesh.positions = kCorners;
  mesh.position_count = 8;
  mesh.indices = kTriangles;
  mesh.index_count = 36;
  mesh.index_bytes = sizeof kTriangles[0];
  expect(libatlas_atlas_create(context, &atlas) == LIBATLAS_OK, "atlas_create");
  expect(libatlas_add_mesh(context, atlas, &mesh, NULL) == LIBATLAS_OK, "add_mesh");
  expect(libatlas_unwrap(context, atlas, NULL, &unwrapped) == LIBATLAS_OK, "unwrap");
  uvs.size = sizeof uvs;
  info.size = sizeof info;
  expect(libatlas_get_mesh(context, unwrapped, 0, &uvs) == LIBATLAS_OK, "get_mesh");
  expect(libatlas_get_info(context, unwrapped, &info) == LIBATLAS_OK, "get_info");
  expect(uvs.triangle_count == 12, "12 triangles");
  expect(info.chart_count >= 1 && info.chart_count <= 6, "1 to 6 charts");
  expect(calls > 0, "progress is reported");
  for (i = 0; i < 36; ++i)
    expect(uvs.vertices[uvs.indices[i]] == kTriangles[i], "vertices are copies of the mesh's");
  mesh.index_count = 35;
  expect(libatlas_add_mesh(context, atlas, &mesh, NULL) == LIBATLAS_BAD_INPUT, "35 indices");
  expect(libatlas_message(context)[0] != '\0', "a message");
  libatlas_unwrapped_destroy(unwrapped);
  libatlas_atlas_destroy(atlas);
  libatlas_context_destroy(context);
  return failures;
}
