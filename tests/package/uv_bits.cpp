// Unwraps OBJ files, or a few generated meshes, and prints a hash of all uvs. Compiled against the
// library, or with TWO_FILES against the release of two files: both print the same.
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#ifdef TWO_FILES
#include "libatlas.h"
#else
#include "libatlas/unwrap/unwrap.h"
#endif

namespace {

struct Mesh {
  std::vector<atlas::Vec3f> positions;
  std::vector<std::uint32_t> indices;
};

// A torus whose tube swells `bumps` times, or which is rough for bumps < 0.
Mesh torus(unsigned around, unsigned across, int bumps) {
  Mesh mesh;
  std::uint32_t noise = 1;
  for (unsigned i = 0; i < around; ++i)
    for (unsigned j = 0; j < across; ++j) {
      const double a = 6.283185307179586 * i / around, b = 6.283185307179586 * j / across;
      noise = noise * 1664525u + 1013904223u;
      const double swell =
          bumps < 0 ? 0.02 * double(noise >> 8) / (1 << 24) : 0.1 * std::sin(bumps * a);
      const double tube = 0.4 + swell, r = 1 + tube * std::cos(b);
      mesh.positions.push_back(
          {float(r * std::cos(a)), float(r * std::sin(a)), float(tube * std::sin(b))});
      const unsigned i1 = (i + 1) % around, j1 = (j + 1) % across;
      const unsigned p = i * across + j, q = i1 * across + j, s = i1 * across + j1,
                     t = i * across + j1;
      for (const unsigned v : {p, q, s, p, s, t}) mesh.indices.push_back(v);
    }
  return mesh;
}

// Reads positions, and faces as fans.
Mesh read(const char* path) {
  Mesh mesh;
  std::ifstream file(path);
  for (std::string line; std::getline(file, line);) {
    std::istringstream words(line);
    std::string word;
    words >> word;
    if (word == "v") {
      atlas::Vec3f p{};
      words >> p.x >> p.y >> p.z;
      mesh.positions.push_back(p);
    } else if (word == "f") {
      std::vector<std::uint32_t> corners;
      while (words >> word) corners.push_back(std::uint32_t(std::stoul(word)) - 1);
      for (std::size_t k = 2; k < corners.size(); ++k)
        for (const std::size_t c : {std::size_t{0}, k - 1, k}) mesh.indices.push_back(corners[c]);
    }
  }
  return mesh;
}

class Hash {
 public:
  template <class T>
  void add(const std::vector<T>& values) {
    const auto* bytes = reinterpret_cast<const unsigned char*>(values.data());
    for (std::size_t i = 0; i < values.size() * sizeof(T); ++i)
      value_ = (value_ ^ bytes[i]) * 1099511628211u;
  }
  unsigned long long value() const { return value_; }

 private:
  std::uint64_t value_ = 14695981039346656037u;  // FNV-1a
};

int print(const char* name, const Mesh& mesh) {
  atlas::MeshView view;
  view.positions = mesh.positions;
  view.indices = mesh.indices;
  const auto unwrapped = atlas::unwrap_mesh(view, {}, {});
  if (!unwrapped.ok()) {
    std::fprintf(stderr, "%s: %s\n", name, unwrapped.status().message().c_str());
    return 1;
  }
  Hash hash;
  hash.add(unwrapped->vertices);
  hash.add(unwrapped->uvs);
  hash.add(unwrapped->indices);
  std::printf("%s: %zu charts, %016llx\n", name, unwrapped->charts.charts.size(), hash.value());
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  int failed = 0;
  for (int i = 1; i < argc; ++i) failed |= print(argv[i], read(argv[i]));
  if (argc > 1) return failed;
  failed |= print("torus", torus(96, 48, 5));
  failed |= print("rough torus", torus(64, 32, -1));
  failed |= print("coarse torus", torus(12, 6, 0));
  return failed;
}
