#include "libatlas/pipeline/mesh_uvs.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "libatlas/core/progress.h"
#include "libatlas/pipeline/layout_options.h"
#include "libatlas/scene/gltf/gltf_shown.h"
#include "libatlas/scene/triangle_area.h"
#include "libatlas/unwrap/atlas.h"
#include "libatlas/unwrap/join_unwrapped.h"

namespace atlas {
namespace {

// The arrays of one mesh, as its first place shows it.
struct OwnMesh {
  std::vector<std::size_t> places;  // into the shown meshes
  std::vector<Vec3f> positions;
  std::vector<std::uint32_t> indices, materials, texcoord_indices;

  MeshView view(const Scene& scene) const {
    MeshView mesh;
    mesh.positions = positions;
    mesh.indices = indices;
    mesh.materials = materials;
    if (!texcoord_indices.empty()) {
      mesh.texcoords = scene.texcoords;
      mesh.texcoord_indices = texcoord_indices;
    }
    return mesh;
  }
};

class MeshUnwrapper {
 public:
  MeshUnwrapper(const Scene& scene, const ExportOptions& options, const Context& context)
      : scene_(scene), options_(options), context_(context), shown_(shown_meshes(scene)) {}

  Result<MeshUvsOfScene> run() {
    if (shown_.empty())
      return Status(ErrorCode::bad_option,
                    "ExportOptions::mesh_uvs: only a scene that was read from glTF tells which "
                    "meshes it shows several times (read it with ReadOptions::rest)");
    if (Status s = gather(); !s.ok()) return s;
    out_.uv_indices.assign(scene_.indices.size(), 0);
    const Status s = options_.mesh_uvs == MeshUvs::instances ? unwrap_together() : unwrap_each();
    if (!s.ok()) return s;
    return std::move(out_);
  }

 private:
  Status gather() {
    std::map<std::size_t, std::size_t> number;
    for (std::size_t p = 0; p < shown_.size(); ++p) {
      if (triangles(p) == 0) continue;
      const auto [at, added] = number.try_emplace(shown_[p].mesh, meshes_.size());
      if (added) {
        meshes_.emplace_back();
        take(shown_[p], meshes_.back());
      }
      OwnMesh& mesh = meshes_[at->second];
      if (3 * triangles(p) != mesh.indices.size())
        return {
            ErrorCode::unsupported,
            fmt::format("mesh {}: one of its nodes shows {} triangles and another {}, since some "
                        "were left out (leave out ExportOptions::mesh_uvs)",
                        shown_[p].mesh, mesh.indices.size() / 3, triangles(p))};
      mesh.places.push_back(p);
    }
    return {};
  }

  std::size_t triangles(std::size_t place) const {
    std::size_t sum = 0;
    for (const ShownPart& part : shown_[place].parts) sum += part.triangles;
    return sum;
  }

  void take(const ShownMesh& shown, OwnMesh& mesh) const {
    for (const ShownPart& part : shown.parts) {
      const auto first = std::uint32_t(mesh.positions.size());
      for (std::size_t v = 0; v < part.positions; ++v)
        mesh.positions.push_back(scene_.positions[part.first_position + v]);
      for (std::size_t k = 0; k < 3 * part.triangles; ++k) {
        const std::size_t corner = part.corner(k);
        mesh.indices.push_back(std::uint32_t(first + scene_.indices[corner] - part.first_position));
        if (k % 3 == 0) mesh.materials.push_back(scene_.triangle_material[corner / 3]);
        if (!scene_.texcoord_indices.empty())
          mesh.texcoord_indices.push_back(scene_.texcoord_indices[corner]);
      }
    }
  }

  double area(std::size_t place) const {
    double sum = 0;
    for (const ShownPart& part : shown_[place].parts)
      for (std::size_t t = 0; t < part.triangles; ++t)
        sum += triangle_area(scene_, part.first_triangle + t);
    return sum;
  }

  UnwrapOptions unwrap_options() const {
    UnwrapOptions unwrap;
    unwrap.preset = options_.packing;
    unwrap.pages = options_.plain_pages;
    unwrap.page_size = options_.atlas_size;
    unwrap.mip_levels = options_.plain_mip_levels;
    unwrap.padding = plain_padding(options_);
    unwrap.square = options_.square_plain_page;
    unwrap.charts = options_.charts;
    unwrap.part_gaps = true;
    if (options_.texel_metres > 0)
      unwrap.texels_per_unit = scene_.metres_per_unit / options_.texel_metres;
    return unwrap;
  }

  Status unwrap_together() {
    Atlas atlas;
    for (const OwnMesh& mesh : meshes_) {
      std::vector<float> densities;
      const double whole = area(mesh.places[0]);
      for (const std::size_t place : mesh.places) {
        const double own = whole > 0 ? std::sqrt(area(place) / whole) : 1;
        densities.push_back(own > 0 ? float(own) : 1.0f);
      }
      const auto added = atlas.add_instances(mesh.view(scene_), mesh.places.size(), densities);
      if (!added.ok()) return added.status();
    }
    const Result<UnwrappedAtlas> made = atlas.unwrap(unwrap_options(), context_);
    if (!made.ok()) return made.status();
    out_.instances.resize(shown_.size());
    for (std::size_t i = 0; i < meshes_.size(); ++i) {
      const UnwrappedAtlas::Mesh mesh = made->mesh(i);
      spread(meshes_[i], mesh.uvs, mesh.indices);
      for (std::size_t k = 0; k < meshes_[i].places.size(); ++k)
        out_.instances[meshes_[i].places[k]] = mesh.instances[k];
    }
    out_.all = made->all();
    return {};
  }

  Status unwrap_each() {
    UnwrapOptions unwrap = unwrap_options();
    unwrap.pages = 1;
    unwrap.square = true;
    double used = 0, room = 0;
    std::size_t first_position = 0;
    for (std::size_t i = 0; i < meshes_.size(); ++i) {
      const double count = double(meshes_.size());
      const Context part =
          part_of_stage(context_, "charts", double(i) / count, double(i + 1) / count);
      Result<UnwrappedMesh> made = unwrap_mesh(meshes_[i].view(scene_), unwrap, part);
      if (!made.ok()) return made.status();
      spread(meshes_[i], made->uvs, made->indices);
      const double page = double(made->pages[0].area());
      used += made->utilization * page;
      room += page;
      for (ChartPlacement& placement : made->placements) placement.page = std::int32_t(i);
      out_.all.pages.push_back(made->pages[0]);
      out_.all.texels_per_unit = i == 0 ? made->texels_per_unit
                                        : std::min(out_.all.texels_per_unit, made->texels_per_unit);
      append_unwrapped(std::move(*made), first_position, out_.all);
      first_position += meshes_[i].positions.size();
    }
    out_.all.utilization = room > 0 ? used / room : 0;
    return {};
  }

  // Gives the corners of all places of a mesh its uvs.
  void spread(const OwnMesh& mesh, std::span<const Vec2f> uvs,
              std::span<const std::uint32_t> indices) {
    const auto first = std::uint32_t(out_.uvs.size());
    out_.uvs.insert(out_.uvs.end(), uvs.begin(), uvs.end());
    for (const std::size_t place : mesh.places) {
      std::size_t done = 0;
      for (const ShownPart& part : shown_[place].parts)
        for (std::size_t k = 0; k < 3 * part.triangles; ++k)
          out_.uv_indices[part.corner(k)] = first + indices[done++];
    }
  }

  const Scene& scene_;
  const ExportOptions& options_;
  const Context& context_;
  std::vector<ShownMesh> shown_;
  std::vector<OwnMesh> meshes_;
  MeshUvsOfScene out_;
};

void report_unwrapped(const UnwrappedMesh& all, ExportReport& report) {
  report_charts(all.charts, report);
  report_making(all.charts, report);
  report.uv_utilization = all.utilization;
  report.written_stretch_999 = all.charts.distortion.stretch_999;
  report.thin_triangles = all.thin_triangles;
  report.texels_drawn_twice = all.texels_drawn_twice;
  report.gaps = all.gaps;
  report.opened_charts = all.gaps.charts;
  report_plain_pages(all.pages, all.placements, report);
  report_placements(all.placements, report);
}

}  // namespace

Result<MeshUvsOfScene> unwrap_meshes_once(ExportJob& job) {
  const Context& context = job.record.begin("charts");
  Result<MeshUvsOfScene> made = MeshUnwrapper(job.scene, job.options, context).run();
  if (!made.ok()) return made;
  ExportReport& report = job.report;
  report_unwrapped(made->all, report);
  report.triangles_out = job.scene.triangle_count();
  job.record.finish({report.triangles_out, report.charts.size(), "charts",
                     fmt::format("L2 {:.4f}, {:.0f} % used by charts", report.distortion.stretch_l2,
                                 100 * report.uv_utilization)});
  return made;
}

}  // namespace atlas
