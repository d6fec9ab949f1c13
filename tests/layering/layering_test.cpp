// The layers of the library: a folder of libatlas/ includes only folders listed above it, public
// headers show nothing internal and no vector types of third parties, each header compiles on its
// own, and the programs include public headers.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "tests/layering/source_tree.h"

namespace {

namespace fs = std::filesystem;

struct Component {
  std::string name;
  std::vector<std::string> folders;
};

// Returns the components in the order in which libatlas/CMakeLists.txt adds them.
std::vector<Component> components() {
  std::istringstream text(read(kRoot / "libatlas/CMakeLists.txt"));
  std::vector<Component> result;
  std::smatch match;
  for (std::string line; std::getline(text, line);) {
    if (!std::regex_match(line, match, std::regex(R"(atlas_component\(([a-z]+) ([a-z_ ]+)\))")))
      continue;
    result.push_back({match[1], {}});
    std::istringstream names(match[2]);
    for (std::string name; names >> name;) result.back().folders.push_back(name);
  }
  return result;
}

// Returns the folders in the order in which a folder may include those before it.
std::vector<std::string> folder_order() {
  std::vector<std::string> order;
  for (const Component& c : components())
    order.insert(order.end(), c.folders.begin(), c.folders.end());
  return order;
}

// What includes of other packages look like.
const std::regex kThirdParty(
    R"((glm|Eigen|CGAL|OpenMesh|OpenImageIO|OIIO|tbb|oneapi|nlohmann|fmt|embree[34]|epoxy|GLFW|imgui|boost|CLI|draco)[/.].*|(imgui|tiny_gltf|zlib|meshoptimizer|png|jpeglib|jerror)\.h)");

struct Include {
  std::string target;  // the text between the quotes or brackets
  int line;
};

std::vector<Include> includes_of(const fs::path& path) {
  std::ifstream file(path);
  std::vector<Include> result;
  const std::regex pattern(R"(^\s*#\s*include\s*[<"]([^>"]+)[>"].*)");
  std::string text;
  for (int line = 1; std::getline(file, text); ++line) {
    std::smatch match;
    if (std::regex_match(text, match, pattern)) result.push_back({match[1], line});
  }
  return result;
}

std::vector<fs::path> sources(const std::string& extension, const char* folder = "libatlas") {
  std::vector<fs::path> result;
  for (const auto& entry : fs::recursive_directory_iterator(kRoot / folder))
    if (entry.is_regular_file() &&
        (extension.empty() ? entry.path().extension() == ".h" || entry.path().extension() == ".cpp"
                           : entry.path().extension() == extension))
      result.push_back(entry.path());
  std::sort(result.begin(), result.end());
  return result;
}

bool internal(const fs::path& header) {
  std::ifstream file(header);
  std::string first;
  std::getline(file, first);
  return first.rfind("// Internal", 0) == 0;
}

std::string place(const fs::path& path, int line) {
  return fs::relative(path, kRoot).string() + ":" + std::to_string(line);
}

TEST(Layering, FoldersIncludeOnlyThoseAboveThem) {
  const auto order = folder_order();
  ASSERT_GE(order.size(), 10u);
  const auto rank = [&](const std::string& folder) {
    return std::find(order.begin(), order.end(), folder) - order.begin();
  };
  int seen = 0;
  for (const fs::path& path : sources("")) {
    const std::string folder = fs::relative(path, kRoot / "libatlas").begin()->string();
    ASSERT_LT(rank(folder), std::ptrdiff_t(order.size())) << folder << " is not in the list";
    for (const Include& include : includes_of(path)) {
      if (include.target.rfind("libatlas/", 0) != 0) continue;
      const std::string target = (++fs::path(include.target).begin())->string();
      ++seen;
      EXPECT_LE(rank(target), rank(folder))
          << place(path, include.line) << ": " << folder << "/ may not include " << target << "/";
      EXPECT_TRUE(fs::exists(kRoot / include.target))
          << place(path, include.line) << ": no such header";
    }
  }
  EXPECT_GT(seen, 100);
}

// What a folder's CMakeLists.txt names behind DEPENDS is what the folder includes.
TEST(Layering, DependsAreThoseThatAreIncluded) {
  for (const std::string& folder : folder_order()) {
    std::set<std::string> included, listed;
    for (const fs::path& path : sources(""))
      if (*fs::relative(path, kRoot / "libatlas").begin() == folder)
        for (const Include& include : includes_of(path))
          if (include.target.rfind("libatlas/", 0) == 0)
            included.insert((++fs::path(include.target).begin())->string());
    included.erase(folder);
    const std::string text = read(kRoot / "libatlas" / folder / "CMakeLists.txt");
    std::smatch depends;
    if (std::regex_search(text, depends, std::regex(R"(DEPENDS([a-z_\s]+))"))) {
      std::istringstream names(depends[1]);
      for (std::string name; names >> name;) listed.insert(name);
    }
    EXPECT_EQ(listed, included) << folder;
  }
}

// The same rule within a folder that is divided, in the order in which its CMakeLists.txt first
// names its own folders. Files directly in it may include all of these, but of these files they may
// include only the public headers.
TEST(Layering, FoldersWithinAFolderIncludeOnlyThoseAboveThem) {
  int seen = 0;
  for (const fs::path& path : sources("")) {
    const fs::path inner = path.parent_path(), outer = inner.parent_path();
    if (outer.parent_path() != kRoot / "libatlas") continue;
    const std::string listed = read(outer / "CMakeLists.txt");
    const std::size_t own = listed.find(inner.filename().string() + "/");
    ASSERT_NE(own, std::string::npos) << inner;
    for (const Include& include : includes_of(path)) {
      const fs::path target = (kRoot / include.target).parent_path();
      if (target == outer) {
        EXPECT_FALSE(internal(kRoot / include.target)) << place(path, include.line);
      } else if (target.parent_path() == outer) {
        ++seen;
        EXPECT_LE(listed.find(target.filename().string() + "/"), own)
            << place(path, include.line) << ": " << inner.filename() << "/ may not include "
            << target.filename() << "/";
      }
    }
  }
  EXPECT_GT(seen, 400);
}

TEST(Layering, PublicHeadersShowNoThirdParty) {
  int seen = 0;
  for (const fs::path& path : sources(".h")) {
    if (internal(path)) continue;
    ++seen;
    for (const Include& include : includes_of(path)) {
      EXPECT_FALSE(std::regex_match(include.target, kThirdParty))
          << place(path, include.line) << ": a public header includes " << include.target
          << " (make the header internal, or hide it in the .cpp)";
    }
  }
  EXPECT_GT(seen, 20);
}

// The component uv is what others embed: it includes headers of Eigen, GLM and fmt, and in one file
// each what can be left out of a build.
TEST(Layering, TheComponentUvUsesFewPackages) {
  const std::map<std::string, std::string> where{{"core/run_chunks_tbb.cpp", "oneapi/"},
                                                 {"param/cgal_backend.cpp", "CGAL/"}};
  const std::vector<Component> all = components();
  ASSERT_FALSE(all.empty());
  ASSERT_EQ(all[0].name, "uv");
  int seen = 0;
  for (const std::string& folder : all[0].folders) {
    for (const fs::path& path : sources("", ("libatlas/" + folder).c_str())) {
      const auto other = where.find(fs::relative(path, kRoot / "libatlas").string());
      for (const Include& include : includes_of(path)) {
        if (!std::regex_match(include.target, kThirdParty)) continue;
        ++seen;
        EXPECT_TRUE(std::regex_match(include.target, std::regex("(glm|Eigen|fmt)/.*")) ||
                    (other != where.end() && include.target.rfind(other->second, 0) == 0))
            << place(path, include.line) << ": " << include.target;
      }
    }
  }
  EXPECT_GT(seen, 20);
}

TEST(Layering, PublicHeadersIncludeOnlyPublicOnes) {
  for (const fs::path& path : sources(".h")) {
    if (internal(path)) continue;
    for (const Include& include : includes_of(path)) {
      if (include.target.rfind("libatlas/", 0) != 0) continue;
      EXPECT_FALSE(internal(kRoot / include.target))
          << place(path, include.line) << ": " << include.target << " is not installed";
    }
  }
}

TEST(Layering, HeadersAreGuardedOnce) {
  for (const fs::path& path : sources(".h"))
    EXPECT_NE(read(path).find("#pragma once"), std::string::npos) << path;
}

// Nothing in libatlas/ depends on the programs, the tests, the examples or the benchmarks.
TEST(Layering, TheLibraryKnowsNobodyAboveIt) {
  for (const fs::path& path : sources(""))
    for (const Include& include : includes_of(path))
      for (const char* folder : {"apps/", "tests/", "examples/", "benchmarks/"})
        EXPECT_NE(include.target.rfind(folder, 0), 0u) << place(path, include.line);
}

// Programs and examples show how the installed library is used, so they include what is installed,
// except for what would be no use to others.
TEST(Layering, ProgramsIncludePublicHeadersOnly) {
  const std::map<std::string, std::string> reasons{
      {"core/counted.h", "words of messages"},
      {"core/counting_sort.h", "a small algorithm"},
      {"core/disjoint_sets.h", "a small algorithm"},
      {"files/links.h", "outputs are compared where their links lead"},
      {"files/parse_number.h", "numbers in options are read as those in files are"},
      {"core/text_buffer.h", "numbers in OBJ are written as by the library"},
      {"pack/larger_pages.h", "the programs advise alike"},
      {"scene/building/losses.h", "the programs name what they leave out alike"},
      {"scene/obj/obj_names.h", "names in OBJ are written as by the library"},
      {"scene/triangle_area.h", "a formula"},
  };
  std::set<std::string> used;
  for (const char* folder : {"apps", "examples"}) {
    for (const fs::path& path : sources("", folder)) {
      for (const Include& include : includes_of(path)) {
        if (include.target.rfind("libatlas/", 0) != 0) continue;
        if (!internal(kRoot / include.target)) continue;
        const std::string header = include.target.substr(std::string("libatlas/").size());
        used.insert(header);
        EXPECT_TRUE(reasons.contains(header))
            << place(path, include.line) << ": " << include.target << " is not installed";
      }
    }
  }
  for (const auto& [header, reason] : reasons)
    EXPECT_TRUE(used.contains(header)) << header << " needs no exception (" << reason << ")";
}

}  // namespace
