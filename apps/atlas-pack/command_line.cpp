#include "apps/atlas-pack/command_line.h"

#include <fmt/format.h>

#include <charconv>
#include <limits>
#include <map>
#include <string_view>

#include "apps/common/options.h"
#include "apps/common/program.h"

namespace atlas::app {
namespace {

// Parses "2048x1024" or "2048"; "2048x0" is a strip. Returns a complaint, empty if there is none.
std::string parse_page(const std::string& text, Extent& page) {
  constexpr std::int32_t kMost = 1 << 30;
  const auto read = [](std::string_view digits, std::int32_t least, std::int32_t& side) {
    const char* end = digits.data() + digits.size();
    const auto [rest, error] = std::from_chars(digits.data(), end, side);
    return error == std::errc() && rest == end && side >= least && side <= kMost;
  };
  const std::string_view all = text, width = all.substr(0, all.find('x'));
  const bool square = width.size() == all.size();
  Extent read_page{0, 0};
  if (!read(width, 1, read_page.width) ||
      !read(square ? width : all.substr(width.size() + 1), 0, read_page.height))
    return fmt::format(
        "'{}' must be WIDTHxHEIGHT, e.g. 2048x2048, with sides of 1..{} (height 0: as low as can "
        "be)",
        text, kMost);
  page = read_page;
  return {};
}

void add_page_options(CLI::App& app, PackCommand& c) {
  const OptionGroup group(app, "Pages");
  constexpr int kMost = 1 << 20;
  app.add_option("--padding", c.options.padding, "Free texels between items")
      ->capture_default_str()
      ->check(within(0, kMost));
  app.add_option("--border", c.options.border, "Free texels along the page's edges")
      ->capture_default_str()
      ->check(within(0, kMost));
  app.add_option("--align", c.options.alignment, "Items begin at multiples of this (4 for BC/ASTC)")
      ->capture_default_str()
      ->check(within(1, kMost));
  app.add_flag("--pot", c.options.power_of_two, "Page sides are powers of two");
  app.add_flag("--square", c.options.square, "Square pages");
  app.add_flag("--crop", c.options.crop, "Cut pages to what is used");
}

void add_effort_options(CLI::App& app, PackCommand& c) {
  const OptionGroup group(app, "Effort");
  const std::map<std::string, PackPreset> presets{
      {"fast", PackPreset::fast}, {"default", PackPreset::standard}, {"best", PackPreset::best}};
  app.add_option("--preset", c.options.preset, "fast, default or best")
      ->transform(choices(presets))
      ->type_name("NAME")
      ->default_str("default");
  add_budget(app, "--preset", c.options.time_budget);
  app.add_option(
         "--effort", c.options.effort,
         "Layouts tried at most by --preset best (mesh: its work, about milliseconds); with it "
         "results repeat exactly; 0: no limit")
      ->capture_default_str()
      ->check(within(0, 1e18, "0 or more"));
  app.add_option("--seed", c.options.seed, "Seed of --preset best")
      ->capture_default_str()
      ->check(within(0, 1e18, "0 or more"));
}

void add_run_options(CLI::App& app, PackCommand& c) {
  const OptionGroup group(app, "Running");
  app.add_option("--threads", c.threads, "Threads; 0: all cores")
      ->capture_default_str()
      ->check(within(0, 1024));
  app.add_option("--preview", c.preview, "Also draw the pages: FILE.svg or FILE.png");
  app.add_flag("--json", c.json, "Print a summary as JSON on stdout");
  app.add_flag("-q,--quiet", c.quiet, "Print warnings and errors only");
}

// Returns a complaint about options that would change nothing, which nobody wants who gives them.
std::string about_effort(const CLI::App& command, const PackCommand& c) {
  for (const char* option : {"--budget", "--effort"})
    if (command.count(option) > 0 && c.options.preset != PackPreset::best)
      return fmt::format("{} is for --preset best (give both or none)", option);
  return {};
}

// Adds the options that rectangles and images have and charts do not: any page, as many pages as
// needed, quarter turns.
void add_rect_options(CLI::App& app, PackCommand& c) {
  const OptionGroup group(app, "Pages");
  app.add_option_function<std::string>("--page",
                                       [&c](const std::string& t) {
                                         if (std::string e = parse_page(t, c.options.page);
                                             !e.empty())
                                           throw CLI::ValidationError("--page", e);
                                         c.page_given = true;
                                       })
      ->type_name("WxH")
      ->description("Largest page, texels; height 0: one strip as low as can be")
      ->default_str("2048x2048");
  const auto given = [&c](const std::string&) { c.page_given = true; };
  app.add_option("--max-width", c.options.page.width, "Largest page width, texels")
      ->check(within(0, 1 << 30))
      ->each(given);
  app.add_option("--max-height", c.options.page.height, "Largest page height; 0: open")
      ->check(within(0, 1 << 30))
      ->each(given);
  app.add_option("--max-pages", c.options.max_pages, "Pages at most; 0: as many as needed")
      ->capture_default_str()
      ->check(within(0, 1'000'000));
  app.add_flag("--allow-rotation,--rotate", c.options.allow_rotation, "Allow quarter turns");
  const std::map<std::string, DataFormat> formats{{"hash", DataFormat::hash},
                                                  {"array", DataFormat::array}};
  app.add_option("--data", c.format, "Layout of the JSON: hash or array")
      ->transform(choices(formats))
      ->type_name("NAME")
      ->default_str("hash");
}

void add_depfile_option(CLI::App& app, PackCommand& c) {
  app.add_option("--depfile", c.depfile,
                 "Also write a rule for make and ninja that lists every file that was read");
}

CLI::App* add_rects(CLI::App& app, PackCommand& c) {
  CLI::App* rects = app.add_subcommand("rects", "A CSV or JSON list of rectangles");
  rects->add_option("sizes", c.input, "CSV: [name,]width,height a line; JSON: an array")
      ->required();
  rects->add_option("-o,--output", c.output, "placed.csv or placed.json")->required();
  add_rect_options(*rects, c);
  add_page_options(*rects, c);
  add_effort_options(*rects, c);
  add_run_options(*rects, c);
  constexpr std::pair<const char*, const char*> examples[] = {
      {"On as few pages of 2048 x 2048 as possible", "sizes.csv -o placed.csv --page 2048"},
      {"A strip 1000 wide, as low as ten seconds find it",
       "sizes.csv -o placed.json --page 1000x0 --preset best --budget 10s"},
      {"Four texels apart, in blocks of 4 x 4, turned where that helps",
       "sizes.csv -o placed.csv --padding 4 --align 4 --rotate"}};
  add_examples(*rects, examples);
  return rects;
}

CLI::App* add_images(CLI::App& app, PackCommand& c) {
  CLI::App* images = app.add_subcommand("images", "A folder of images into sprite pages");
  images->add_option("folder", c.input, "Read with its subfolders, in the order of names")
      ->required();
  images
      ->add_option("-o,--output", c.output,
                   "NAME or NAME.png: NAME.png and NAME.json, or NAME-0.png ... for several pages")
      ->required();
  images->add_option("--extrude", c.extrude, "Repeat edge texels outwards this many times")
      ->capture_default_str()
      ->check(within(0, 256));
  CLI::Option* threshold =
      images->add_option("--trim-threshold", c.trim_threshold, "Alpha up to this is transparent")
          ->capture_default_str()
          ->check(within(0, 254));
  add_off_flag(*images, "--no-trim", c.trim, "Keep transparent borders")->excludes(threshold);
  add_off_flag(*images, "--no-alias", c.alias, "Store identical images each");
  add_depfile_option(*images, c);
  add_rect_options(*images, c);
  add_page_options(*images, c);
  add_effort_options(*images, c);
  add_run_options(*images, c);
  constexpr std::pair<const char*, const char*> examples[] = {
      {"One page as small as the sprites allow, with its JSON", "sprites -o sheet --crop"},
      {"Pages with sides that are powers of two, edges repeated for bilinear lookups",
       "sprites -o sheet --pot --extrude 2 --padding 2"},
      {"Frames as an array, in natural order, with animations", "sprites -o sheet --data array"}};
  add_examples(*images, examples);
  return images;
}

void add_mesh(CLI::App& app, PackCommand& c) {
  CLI::App* mesh = app.add_subcommand("mesh", "The uv charts of a mesh, repacked");
  mesh->add_option("mesh", c.input, "OBJ, PLY, OFF or glTF with uvs")->required();
  mesh->add_option("-o,--output", c.output, "OBJ with new uvs, one material a page")->required();
  mesh->add_option("--page", c.page_side, "Side of the largest page, texels")
      ->capture_default_str()
      ->check(within(16, 1 << 17));
  mesh->add_option("--pages,--max-pages", c.pages, "Pages at most")
      ->capture_default_str()
      ->check(within(1, 100000));
  mesh->add_option("--uv-aspect", c.uv_aspect,
                   "Width / height of the page that the mesh's uvs were made for; without it, what "
                   "the file says if libatlas wrote it, else 1")
      ->check(positive());
  mesh->add_flag("--keep-density", c.keep_density,
                 "Keep the sizes that the charts have relative to each other; else all get the "
                 "same texel density on the surface");
  mesh->add_option("--rotations", c.rotations,
                   "Directions tried: 1, 2, 4, 8, 12, ... 64; above 4 charts may be turned by any "
                   "angle")
      ->capture_default_str()
      ->check(CLI::Validator(
          [](std::string& text) {
            const int n = std::atoi(text.c_str());
            const bool good = n == 1 || n == 2 || (n > 0 && n <= 64 && n % 4 == 0);
            return good ? std::string() : "'" + text + "' must be 1, 2, or a multiple of 4 to 64";
          },
          ""));
  add_trust_options(*mesh, c.read);
  add_depfile_option(*mesh, c);
  add_page_options(*mesh, c);
  add_effort_options(*mesh, c);
  add_run_options(*mesh, c);
  constexpr std::pair<const char*, const char*> examples[] = {
      {"The charts of a mesh, packed anew at one density", "model.obj -o packed.obj"},
      {"On a page of 1024, turned freely, two texels apart",
       "model.obj -o packed.obj --page 1024 --rotations 64 --padding 2"},
      {"On up to four pages, with sizes relative to each other as they are",
       "model.glb -o packed.obj --pages 4 --keep-density"}};
  add_examples(*mesh, examples);
}

}  // namespace

int parse_command_line(int argc, char** argv, PackCommand& c) {
  CLI::App app{"Packs rectangles, images or the charts of a mesh into pages.", "atlas-pack"};
  app.require_subcommand(1);
  c.options.time_budget = 1;

  CLI::App* rects = add_rects(app, c);
  CLI::App* images = add_images(app, c);
  add_mesh(app, c);
  constexpr std::pair<const char*, const char*> examples[] = {
      {"Rectangles on pages", "rects sizes.csv -o placed.csv"},
      {"A folder of images on one page", "images sprites -o sheet --crop"},
      {"The uvs of a mesh, packed anew", "mesh model.obj -o packed.obj"}};
  add_examples(app, examples);
  if (const int code = parse(app, argc, argv); code >= 0) return code;
  if (const std::string why = about_effort(*app.get_subcommands().front(), c); !why.empty()) {
    print_error("atlas-pack", why);
    return 2;
  }
  if (c.options.effort > 0 && app.get_subcommands().front()->count("--budget") == 0)
    c.options.time_budget = std::numeric_limits<double>::infinity();
  c.kind = *rects    ? PackCommand::Kind::rects
           : *images ? PackCommand::Kind::images
                     : PackCommand::Kind::mesh;
  return -1;
}

}  // namespace atlas::app
