// The inputs of atlas-pack.
#include <algorithm>
#include <nlohmann/json.hpp>

#include "apps/atlas-pack/commands.h"
#include "libatlas/scene/reader.h"
#include "tests/fuzz/fuzz_files.h"

namespace atlas::test {
namespace {

using app::PackCommand;
using app::PackedAtlas;

PackCommand command_of(unsigned choice, const FuzzFolder& folder) {
  PackCommand command;
  PackOptions& options = command.options;
  options.preset = PackPreset(choice % 3);
  options.time_budget = 0.01;
  options.effort = 20;
  options.allow_rotation = choice & 4;
  if (choice & 8) options.padding = 3;
  if (choice & 16) options.border = 2;
  if (choice & 32) options.alignment = 4;
  options.crop = choice & 64;
  options.power_of_two = choice & 128;
  if (choice & 256)
    command.preview = folder.path() / (choice & 2048 ? "preview.png" : "preview.svg");
  command.threads = 1;
  return command;
}

std::string fault_of(const Status& status, const FuzzFolder& folder) {
  const std::string& message = status.message();
  const bool named = message.find(folder.path().string()) != message.npos;
  // Options that no mesh or list fits are named as such, without a file.
  const bool option = status.code() == ErrorCode::bad_option;
  return (named || option) && clear_error(message) ? "" : "an unclear error: " + message;
}

// Whether the placed items lie on their pages, and no two of them on each other.
std::string judge(const PackedAtlas& atlas) {
  const auto end = [](const app::PackedItem& i, bool across) {
    const bool width = across != i.at.rotated;
    return std::int64_t{across ? i.at.x : i.at.y} + (width ? i.size.width : i.size.height);
  };
  for (const app::PackedItem& a : atlas.items) {
    if (!a.at.placed() || a.size.area() == 0) continue;
    if (a.at.page >= atlas.pages.size()) return a.name + " lies on no page";
    const Extent page = atlas.pages[a.at.page];
    if (a.at.x < 0 || a.at.y < 0 || end(a, true) > page.width || end(a, false) > page.height)
      return a.name + " lies beyond its page";
    for (const app::PackedItem* b = atlas.items.data(); b != &a; ++b)
      if (b->size.area() > 0 && b->at.page == a.at.page && end(*b, true) > a.at.x &&
          end(a, true) > b->at.x && end(*b, false) > a.at.y && end(a, false) > b->at.y)
        return a.name + " lies on " + b->name;
  }
  return {};
}

}  // namespace

FuzzResult fuzz_rects(FuzzBytes bytes, const std::string& extension) {
  const FuzzFolder folder;
  const unsigned choice = sum_of(bytes);
  PackCommand command = command_of(choice, folder);
  command.kind = PackCommand::Kind::rects;
  command.input = folder.write_scene(bytes, extension);
  command.output = folder.path() / (choice & 512 ? "packed.csv" : "packed.json");
  const Result<PackedAtlas> packed = run_rects(command, {});
  if (!packed.ok()) return {fault_of(packed.status(), folder)};
  if (!(choice & 512)) {
    std::ifstream file(command.output);
    if (!nlohmann::json::accept(file)) return {"the result is no JSON", true};
  }
  return {judge(*packed), true};
}

FuzzResult fuzz_repack(FuzzBytes bytes, const std::string& extension) {
  const FuzzFolder folder;
  const unsigned choice = sum_of(bytes);
  PackCommand command = command_of(choice, folder);
  command.kind = PackCommand::Kind::mesh;
  command.input = folder.write_scene(bytes, extension);
  command.output = folder.path() / "packed.obj";
  command.pages = choice & 512 ? 2 : 1;
  command.page_side = 64;
  command.rotations = choice & 1024 ? 1 : 8;
  const Result<PackedAtlas> packed = run_mesh(command, {});
  if (!packed.ok()) return {fault_of(packed.status(), folder)};
  const Result<LoadedScene> before = read_scene(command.input, {}, {});
  const Result<LoadedScene> again = read_scene(command.output, {}, {});
  if (!again.ok()) return {"the mesh cannot be read: " + again.status().message(), true};
  const bool kept = before->scene.triangle_count() == again->scene.triangle_count();
  return {kept ? "" : "triangles were lost", true};
}

}  // namespace atlas::test
