#include "libatlas/scene/gltf/draco_mesh.h"

#include <draco/compression/decode.h>
#include <draco/core/varint_decoding.h>
#include <draco/metadata/metadata_decoder.h>
#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <exception>
#include <new>

#include "libatlas/scene/gltf/draco_guard.h"

namespace atlas {
namespace {

// Draco spends about a byte on a triangle, and less on flat, regular ones. Data that announce more
// than this many triangles or points for each byte are damaged, and no memory is allocated for
// them, unless they announce few.
constexpr std::size_t kMostExpansion = 64, kFew = std::size_t{1} << 20;

// What a triangle and its share of the points take decoded, with more attributes than is usual.
constexpr std::size_t kTriangleBytes = 64;

draco::DecoderBuffer buffer_of(std::span<const unsigned char> bytes) {
  draco::DecoderBuffer buffer;
  buffer.Init(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  return buffer;
}

// Some exporters promise the counts that a mesh had before compression, which joins and divides
// points.
constexpr std::size_t kMostBroken = 4, kFewBroken = std::size_t{1} << 14;

bool is_edgebreaker(std::span<const unsigned char> bytes) {
  constexpr std::size_t kMethod = 8;  // after the magic word, the version and the kind of geometry
  return bytes.size() > kMethod && bytes[kMethod] == draco::MESH_EDGEBREAKER_ENCODING;
}

// Reads the counts at the beginning of the data, since Draco allocates memory for any counts.
// Returns what is wrong, or an empty text.
std::string check_counts(const DracoBytes& data) {
  const std::span<const unsigned char> bytes = data.bytes;
  constexpr char kMagic[] = {'D', 'R', 'A', 'C', 'O'};
  constexpr std::uint8_t kMesh = draco::TRIANGULAR_MESH;
  draco::DecoderBuffer buffer = buffer_of(bytes);
  char magic[sizeof kMagic];
  std::uint8_t major = 0, minor = 0, geometry = 0, method = 0, traversal = 0;
  std::uint16_t flags = 0;
  if (!buffer.Decode(magic, sizeof magic) || std::memcmp(magic, kMagic, sizeof magic) != 0 ||
      !buffer.Decode(&major) || !buffer.Decode(&minor) || !buffer.Decode(&geometry) ||
      !buffer.Decode(&method) || !buffer.Decode(&flags))
    return "holds no data of Draco";
  if (major != 2 || minor != 2)
    return fmt::format("is of Draco's bitstream {}.{}, and glTF has 2.2", major, minor);
  if (geometry != kMesh) return "holds a point cloud, not a mesh";
  buffer.set_bitstream_version(DRACO_BITSTREAM_VERSION(2, 2));
  if ((flags & METADATA_FLAG_MASK) != 0) {
    draco::GeometryMetadata metadata;
    if (!draco::MetadataDecoder().DecodeGeometryMetadata(&buffer, &metadata))
      return "has damaged metadata";
  }
  // Sequential data have triangles and points; the others have points and triangles.
  std::uint32_t counts[2] = {0, 0};
  if (method == draco::MESH_EDGEBREAKER_ENCODING && !buffer.Decode(&traversal))
    return "ends too early";
  for (std::uint32_t& count : counts)
    if (!draco::DecodeVarint(&count, &buffer)) return "ends too early";
  if (!data.limited) return "";
  const std::size_t announced = std::max(counts[0], counts[1]);
  if (announced > std::max(bytes.size() * kMostExpansion, kFew))
    return "is too short for what it should hold";
  if (data.promised > 0 && announced > std::max(kMostBroken * data.promised, kFewBroken))
    return fmt::format("announces {} points or triangles, but its accessors {}", announced,
                       data.promised);
  return "";
}

template <class T>
bool convert(const draco::PointAttribute& attribute, std::size_t points, DracoRows& rows) {
  for (std::size_t p = 0; p < points; ++p) {
    const draco::PointIndex point(static_cast<std::uint32_t>(p));
    T row[4];  // accessors that Draco can fill have four components at most
    if (!attribute.ConvertValue<T>(attribute.mapped_index(point),
                                   static_cast<std::int8_t>(rows.components), row))
      return false;
    std::memcpy(&rows.data[p * rows.stride], row, rows.components * sizeof(T));
  }
  return true;
}

bool convert_to_type(const draco::PointAttribute& attribute, std::size_t points, DracoRows& rows) {
  rows.data.assign(points * rows.stride, 0);
  switch (rows.component_type) {
    case 5120:
      return convert<std::int8_t>(attribute, points, rows);
    case 5121:
      return convert<std::uint8_t>(attribute, points, rows);
    case 5122:
      return convert<std::int16_t>(attribute, points, rows);
    case 5123:
      return convert<std::uint16_t>(attribute, points, rows);
    case 5125:
      return convert<std::uint32_t>(attribute, points, rows);
    case 5126:
      return convert<float>(attribute, points, rows);
    default:
      return false;
  }
}

std::string read_attribute(const draco::Mesh& mesh, DracoRows& rows) {
  const draco::PointAttribute* attribute = mesh.GetAttributeByUniqueId(rows.id);
  if (!attribute) return fmt::format("has no attribute of id {}", rows.id);
  if (attribute->num_components() != rows.components)
    return fmt::format("has {} components, not {}, in the attribute of id {}",
                       attribute->num_components(), rows.components, rows.id);
  if (!convert_to_type(*attribute, mesh.num_points(), rows))
    return fmt::format("has an attribute, id {}, whose values do not fit its accessor", rows.id);
  return {};
}

// Returns the bytes of a decoded mesh and of the rows that it will fill.
std::size_t decoded_bytes(const draco::Mesh& mesh, std::span<const DracoRows> asked) {
  std::size_t row = 0;
  for (int a = 0; a < mesh.num_attributes(); ++a)
    row += static_cast<std::size_t>(mesh.attribute(a)->byte_stride());
  for (const DracoRows& rows : asked) row += rows.stride;
  return row * mesh.num_points() + sizeof(draco::Mesh::Face) * std::size_t{mesh.num_faces()};
}

std::string decode(std::span<const unsigned char> bytes, std::span<DracoRows> asked,
                   DracoMesh& mesh, DracoBudget& budget) {
  draco::DecoderBuffer buffer = buffer_of(bytes);
  draco::Mesh found;
  if (!(is_edgebreaker(bytes) ? decode_edgebreaker(buffer, found)
                              : draco::Decoder().DecodeBufferToGeometry(&buffer, &found).ok()))
    return "cannot be decompressed";
  if (!budget.take(decoded_bytes(found, asked)))
    return "decodes to more than a file of this size can hold (name the same data less often)";
  mesh.points = found.num_points();
  mesh.indices.reserve(3 * std::size_t{found.num_faces()});
  for (std::uint32_t f = 0; f < found.num_faces(); ++f)
    for (const draco::PointIndex& corner : found.face(draco::FaceIndex(f)))
      mesh.indices.push_back(corner.value());
  for (DracoRows& rows : asked)
    if (std::string wrong = read_attribute(found, rows); !wrong.empty()) return wrong;
  return {};
}

}  // namespace

DracoBudget::DracoBudget(std::size_t file_bytes)
    : left_(kTriangleBytes * std::max(file_bytes * kMostExpansion, kFew)) {}

bool DracoBudget::take(std::size_t bytes) {
  if (bytes > left_) return false;
  if (limited()) left_ -= bytes;
  return true;
}

std::string decode_draco(const DracoBytes& data, std::span<DracoRows> asked, DracoMesh& mesh,
                         DracoBudget& budget) {
  if (std::string wrong = check_counts(data); !wrong.empty()) return wrong;
  try {
    return decode(data.bytes, asked, mesh, budget);
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::exception&) {  // such as the containers' own, for sizes that are damaged
    return "cannot be decompressed";
  }
}

}  // namespace atlas
