// Unwraps an OBJ (v and triangular f lines) with native xatlas, default options:
//   c++ -O2 -std=c++17 -I XATLAS/source/xatlas xatlas_unwrap.cpp XATLAS/source/xatlas/xatlas.cpp
//   xatlas_unwrap IN.obj OUT.obj [PAGE] [PADDING]
// Not part of the build: whoever compares makes XATLAS, a clone of github.com/jpcy/xatlas.
#include <cctype>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <vector>

#include "xatlas.h"

namespace {

struct Mesh {
  std::vector<float> positions;
  std::vector<unsigned> indices;
};

bool read(const char* path, Mesh& mesh) {
  FILE* file = std::fopen(path, "rb");
  if (!file) return false;
  char text[512];
  while (std::fgets(text, sizeof text, file)) {
    if (text[0] == 'v' && text[1] == ' ') {
      char* at = text + 2;
      for (int k = 0; k < 3; ++k) mesh.positions.push_back(std::strtof(at, &at));
    } else if (text[0] == 'f') {
      char* at = text + 1;
      for (int k = 0; k < 3; ++k) {
        mesh.indices.push_back(unsigned(std::strtoul(at, &at, 10)) - 1);
        while (*at && !std::isspace(static_cast<unsigned char>(*at))) ++at;
      }
    }
  }
  std::fclose(file);
  return !mesh.indices.empty();
}

bool write(const char* path, const Mesh& in, const xatlas::Atlas& atlas) {
  FILE* file = std::fopen(path, "wb");
  if (!file) return false;
  std::fprintf(file, "# page %u %u\n", atlas.width, atlas.height);
  for (std::size_t i = 0; i < in.positions.size(); i += 3)
    std::fprintf(file, "v %.9g %.9g %.9g\n", in.positions[i], in.positions[i + 1],
                 in.positions[i + 2]);
  const xatlas::Mesh& out = atlas.meshes[0];
  for (unsigned i = 0; i < out.vertexCount; ++i)
    std::fprintf(file, "vt %.9g %.9g\n", out.vertexArray[i].uv[0] / float(atlas.width),
                 out.vertexArray[i].uv[1] / float(atlas.height));
  // Each page has its own material, so that charts on different pages are not counted as overlaps.
  // Triangles without a chart (page -1) are written without texture coordinates.
  int page = -2;
  for (unsigned i = 0; i < out.indexCount; i += 3) {
    const xatlas::Vertex* corner[3];
    for (unsigned k = 0; k < 3; ++k) corner[k] = &out.vertexArray[out.indexArray[i + k]];
    if (corner[0]->atlasIndex != page)
      std::fprintf(file, "usemtl page%d\n", page = corner[0]->atlasIndex);
    std::fputc('f', file);
    for (unsigned k = 0; k < 3; ++k) {
      if (page < 0)
        std::fprintf(file, " %u", corner[k]->xref + 1);
      else
        std::fprintf(file, " %u/%u", corner[k]->xref + 1, out.indexArray[i + k] + 1);
    }
    std::fputc('\n', file);
  }
  return std::fclose(file) == 0;
}

}  // namespace

int main(int argc, char** argv) {
  Mesh mesh;
  if (argc < 3 || !read(argv[1], mesh)) return 2;
  xatlas::Atlas* atlas = xatlas::Create();
  xatlas::MeshDecl decl;  // positions only: no normals, no given coordinates, the default epsilon
  decl.vertexPositionData = mesh.positions.data();
  decl.vertexPositionStride = 3 * sizeof(float);
  decl.vertexCount = unsigned(mesh.positions.size() / 3);
  decl.indexData = mesh.indices.data();
  decl.indexCount = unsigned(mesh.indices.size());
  decl.indexFormat = xatlas::IndexFormat::UInt32;
  // The time is that of all threads. Welding and adjacency count, as in this library's figures.
  const std::clock_t begun = std::clock();
  if (xatlas::AddMesh(atlas, decl) != xatlas::AddMeshError::Success) return 3;
  xatlas::AddMeshJoin(atlas);
  xatlas::ComputeCharts(atlas, xatlas::ChartOptions());
  const double charts = double(std::clock() - begun) / CLOCKS_PER_SEC;
  xatlas::PackOptions pack;  // one page, whose resolution determines the density
  pack.resolution = argc > 3 ? unsigned(std::atoi(argv[3])) : 2048;
  pack.padding = argc > 4 ? unsigned(std::atoi(argv[4])) : 2;
  xatlas::PackCharts(atlas, pack);
  std::fprintf(stderr, "%u charts in %.3f CPU s, %u pages of %u x %u\n", atlas->chartCount, charts,
               atlas->atlasCount, atlas->width, atlas->height);
  const bool written = write(argv[2], mesh, *atlas);
  xatlas::Destroy(atlas);
  return written ? 0 : 4;
}
