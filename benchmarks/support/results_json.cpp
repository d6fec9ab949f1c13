#include <fmt/format.h>

#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>

#include "benchmarks/support/results.h"

namespace atlas::bench {
namespace {

using Json = nlohmann::ordered_json;

// JSON has neither infinity nor NaN. Both become null, and null is read as NaN.
double number(const Json& j) {
  return j.is_null() ? std::numeric_limits<double>::quiet_NaN() : j.get<double>();
}

Json to_json(const Row& r) {
  Json values = Json::object();
  for (const auto& [name, v] : r.values) values[name] = v;
  return {{"stage", r.stage},
          {"mesh", r.mesh},
          {"setting", r.setting},
          {"preset", r.preset},
          {"triangles", r.triangles},
          {"size_in", r.size_in},
          {"size_out", r.size_out},
          {"unit", r.unit},
          {"values", values},
          {"cpu_seconds", r.cpu_seconds},
          {"cpu_spread", r.cpu_spread},
          {"wall_seconds", r.wall_seconds},
          {"memory_mib", r.memory_mib},
          {"input_mib", r.input_mib},
          {"instructions", r.instructions},
          {"threads", r.threads},
          {"failure", r.failure}};
}

Row row_from(const Json& j) {
  Row r;
  r.stage = j.at("stage");
  r.mesh = j.at("mesh");
  r.setting = j.at("setting");
  r.preset = j.at("preset");
  r.triangles = j.at("triangles");
  r.size_in = j.at("size_in");
  r.size_out = j.at("size_out");
  r.unit = j.at("unit");
  for (const auto& [name, v] : j.at("values").items()) r.values.emplace_back(name, number(v));
  r.cpu_seconds = number(j.at("cpu_seconds"));
  r.cpu_spread = number(j.at("cpu_spread"));
  r.wall_seconds = number(j.at("wall_seconds"));
  r.memory_mib = number(j.at("memory_mib"));
  r.input_mib = j.value("input_mib", 0.0);  // older files have none
  r.instructions = number(j.at("instructions"));
  r.threads = j.at("threads");
  r.failure = j.at("failure");
  return r;
}

Json to_json(const Machine& m) {
  return {{"processor", m.processor}, {"cores", m.cores}, {"system", m.system},
          {"compiler", m.compiler},   {"build", m.build}, {"date", m.date},
          {"command", m.command}};
}

Results results_from(const Json& j) {
  Results results;
  const Json& m = j.at("machine");
  results.machine = {m.at("processor"), m.at("system"),  m.at("compiler"), m.at("build"),
                     m.at("date"),      m.at("command"), m.at("cores")};
  for (const Json& row : j.at("rows")) results.rows.push_back(row_from(row));
  for (const Json& f : j.at("fits"))
    results.fits.push_back({f.at("stage"), f.at("work"), f.at("quantity"), number(f.at("exponent")),
                            number(f.at("factor")), f.at("smallest"), f.at("largest"),
                            f.at("points")});
  for (const Json& c : j.at("checks"))
    results.checks.push_back({c.at("group"), c.at("stress"), c.at("quantity"),
                              number(c.at("value")), number(c.at("bound")), c.at("note")});
  return results;
}

Json to_json(const Fit& f) {
  return {{"stage", f.stage},       {"work", f.work},     {"quantity", f.quantity},
          {"exponent", f.exponent}, {"factor", f.factor}, {"smallest", f.smallest},
          {"largest", f.largest},   {"points", f.points}};
}

Json to_json(const Check& c) {
  return {{"group", c.group}, {"stress", c.stress}, {"quantity", c.quantity}, {"value", c.value},
          {"bound", c.bound}, {"holds", c.holds()}, {"note", c.note}};
}

template <class Item>
void write_list(std::ostream& file, const char* name, const std::vector<Item>& items) {
  file << ",\n\"" << name << "\": [";
  for (std::size_t i = 0; i < items.size(); ++i)
    file << (i ? ",\n" : "\n") << to_json(items[i]).dump();
  file << "]";
}

// Returns the first line of a list's items in the layout that save() writes, or 0 if there is no
// such list.
std::size_t first_line(const std::filesystem::path& path, const std::string& list) {
  std::ifstream file(path);
  std::size_t number = 1;
  for (std::string text; std::getline(file, text); ++number)
    if (text == fmt::format("\"{}\": [", list)) return number + 1;
  return 0;
}

template <class Item>
void cite(const std::filesystem::path& path, const std::string& list, std::vector<Item>& items) {
  const std::size_t first = first_line(path, list);
  for (std::size_t i = 0; i < items.size(); ++i)
    items[i].source =
        path.filename().string() + (first ? fmt::format(":{}", first + i) : std::string());
}

Status unwritable(const std::filesystem::path& path) {
  return {ErrorCode::io, path.string() + ": cannot be written (does the folder exist?)"};
}

}  // namespace

std::string to_json_line(const Row& row) {
  return to_json(row).dump();
}

Result<Row> row_from_line(const std::string& line) {
  try {
    return row_from(Json::parse(line));
  } catch (const Json::exception& error) {
    return Status{ErrorCode::bad_input, std::string("not a row: ") + error.what()};
  }
}

Status check_target(const std::filesystem::path& path) {
  if (path.empty()) return {};
  const bool there = std::filesystem::exists(path);
  const bool writable = std::ofstream(path, std::ios::app).good();
  if (writable && !there) std::filesystem::remove(path);
  return writable ? Status() : unwritable(path);
}

Status save(const Results& results, const std::filesystem::path& path) {
  std::ofstream file(path);
  file << "{\"format\": \"libatlas-bench-1\",\n\"machine\": " << to_json(results.machine).dump();
  write_list(file, "rows", results.rows);
  write_list(file, "fits", results.fits);
  write_list(file, "checks", results.checks);
  file << "\n}\n";
  file.flush();
  return file ? Status() : unwritable(path);
}

Result<Results> load(const std::filesystem::path& path) {
  std::ifstream file(path);
  if (!file) return Status{ErrorCode::not_found, path.string() + ": no such file"};
  try {
    const Json j = Json::parse(file, nullptr, false);
    if (!j.contains("format") || j.at("format") != "libatlas-bench-1")
      return Status{ErrorCode::bad_input, path.string() + ": not a result file of atlas-bench"};
    Results results = results_from(j);
    cite(path, "rows", results.rows);
    cite(path, "checks", results.checks);
    return results;
  } catch (const Json::exception& error) {
    return Status{ErrorCode::bad_input, path.string() + ": damaged: " + error.what()};
  }
}

}  // namespace atlas::bench
