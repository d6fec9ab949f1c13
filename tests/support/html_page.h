// Reads what a page of HTML says of its world, without the library's writers: an oracle for them.
#pragma once

#include <zlib.h>

#include <array>
#include <cstdint>
#include <cstring>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>
#include <vector>

namespace atlas::test {

inline std::string from_base64(const std::string& text) {
  std::string result;
  std::uint32_t word = 0;
  int bits = 0;
  for (const char c : text) {
    if (c == '=') break;
    const int digit = c >= 'A' && c <= 'Z'   ? c - 'A'
                      : c >= 'a' && c <= 'z' ? c - 'a' + 26
                      : c >= '0' && c <= '9' ? c - '0' + 52
                      : c == '+'             ? 62
                      : c == '/'             ? 63
                                             : throw std::runtime_error("no base64");
    word = word << 6 | std::uint32_t(digit);
    if ((bits += 6) >= 8) result += static_cast<char>(word >> (bits -= 8));
  }
  return result;
}

// Of the format that zlib's compress() writes, of any size.
inline std::vector<std::uint8_t> unzipped(const std::string& bytes) {
  std::vector<std::uint8_t> result(1 << 16);
  for (;; result.resize(2 * result.size())) {
    uLongf size = result.size();
    const int code = uncompress(result.data(), &size, reinterpret_cast<const Bytef*>(bytes.data()),
                                bytes.size());
    result.resize(code == Z_OK ? size : result.size());
    if (code == Z_OK) return result;
    if (code != Z_BUF_ERROR) throw std::runtime_error("no zlib data");
  }
}

class HtmlPage {
 public:
  struct Corner {
    std::array<double, 3> position;  // metres, y up
    std::array<double, 2> uv;
    std::uint32_t chart;
  };
  struct Part {
    std::size_t page = 0;
    bool one_sided = false;
    std::vector<std::array<Corner, 3>> triangles;
  };

  explicit HtmlPage(std::string text) : text_(std::move(text)) {
    world = nlohmann::json::parse(script("world"));
    read_parts(unzipped(data("mesh")));
  }

  // The bytes of an element with data.
  std::string data(const std::string& id) const { return from_base64(script(id)); }
  const std::string& text() const { return text_; }

  nlohmann::json world;
  std::vector<Part> parts;

 private:
  std::string script(const std::string& id) const {
    const std::size_t tag = text_.find(" id=\"" + id + "\">");
    if (tag == std::string::npos) throw std::runtime_error("no script " + id);
    const std::size_t begin = text_.find('>', tag) + 1;
    return text_.substr(begin, text_.find("</script>", begin) - begin);
  }

  void read_parts(const std::vector<std::uint8_t>& bytes) {
    std::size_t at = 0;
    const auto column = [&](std::size_t count) {
      std::vector<std::uint32_t> values(count, 0);
      const int planes = bytes.at(at++);
      for (int p = 0; p < planes; ++p)
        for (std::uint32_t& v : values) v |= std::uint32_t(bytes.at(at++)) << (8 * p);
      return values;
    };
    const auto running = [&](std::size_t count) {
      std::vector<std::uint32_t> values = column(count);
      std::uint32_t last = 0;
      for (std::uint32_t& v : values) v = last += v % 2 == 0 ? v / 2 : ~(v / 2);
      return values;
    };
    for (const auto& entry : world["parts"]) {
      const std::size_t vertices = entry["vertices"];
      std::vector<Corner> corners(vertices);
      for (std::size_t k = 0; k < 3; ++k) {
        const auto steps = running(vertices);
        for (std::size_t i = 0; i < vertices; ++i)
          corners[i].position[k] = world["mesh"]["low"][k].get<double>() +
                                   world["mesh"]["step"].get<double>() * steps[i];
      }
      for (std::size_t k = 0; k < 2; ++k) {
        const auto steps = running(vertices);
        for (std::size_t i = 0; i < vertices; ++i)
          corners[i].uv[k] = steps[i] / world["mesh"]["uvSteps"].get<double>();
      }
      const auto charts = running(vertices);
      for (std::size_t i = 0; i < vertices; ++i) corners[i].chart = charts[i];
      Part part{entry["page"], entry["oneSided"], {}};
      const auto distances = column(3 * entry["triangles"].get<std::size_t>());
      std::uint32_t next = 0;
      for (std::size_t k = 0; k < distances.size(); ++k) {
        const std::uint32_t vertex = next - distances[k];
        if (vertex == next) ++next;
        if (k % 3 == 0) part.triangles.emplace_back();
        part.triangles.back()[k % 3] = corners.at(vertex);
      }
      parts.push_back(std::move(part));
    }
    if (at != bytes.size()) throw std::runtime_error("bytes are left over");
  }

  std::string text_;
};

}  // namespace atlas::test
