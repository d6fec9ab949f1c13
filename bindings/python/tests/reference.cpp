// Unwraps a mesh by the C++ call, for the tests of the Python package: the positions and indices of
// raw files become one raw file of vertices, indices and uvs.
// Usage: reference POSITIONS INDICES RESULT PAGE_SIZE
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <iterator>
#include <span>
#include <vector>

#include "libatlas/unwrap/unwrap.h"

namespace {

template <class T>
std::vector<T> read(const char* path) {
  std::ifstream file(path, std::ios::binary);
  const std::vector<char> bytes((std::istreambuf_iterator<char>(file)), {});
  std::vector<T> values(bytes.size() / sizeof(T));
  std::memcpy(values.data(), bytes.data(), values.size() * sizeof(T));
  return values;
}

template <class T>
void write(std::ofstream& file, const std::vector<T>& values) {
  file.write(reinterpret_cast<const char*>(values.data()),
             std::streamsize(values.size() * sizeof(T)));
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 5)
    return std::fputs("usage: reference POSITIONS INDICES RESULT PAGE_SIZE\n", stderr), 2;
  const auto positions = read<atlas::Vec3f>(argv[1]);
  const auto indices = read<std::uint32_t>(argv[2]);
  atlas::MeshView mesh;
  mesh.positions = positions;
  mesh.indices = indices;
  const auto unwrapped = atlas::unwrap_mesh(mesh, {{.page_size = std::atoi(argv[4])}}, {});
  if (!unwrapped.ok()) return std::fprintf(stderr, "%s\n", unwrapped.status().message().c_str()), 1;
  std::ofstream file(argv[3], std::ios::binary);
  write(file, unwrapped->vertices);
  write(file, unwrapped->indices);
  write(file, unwrapped->uvs);
  return file.flush() ? 0 : 1;
}
