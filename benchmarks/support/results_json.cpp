#include <fstream>
#include <nlohmann/json.hpp>

#include "benchmarks/support/results.h"

namespace atlas::bench {
namespace {

using Json = nlohmann::ordered_json;

// JSON knows neither infinity nor NaN: both become null, and null reads back as NaN.
double number(const Json& j) {
  return j.is_null() ? std::numeric_limits<double>::quiet_NaN() : j.get<double>();
}

Json to_json(const Row& r) {
  Json values = Json::object();
  for (const auto& [name, v] : r.values) values[name] = v;
  return {{"stage", r.stage},           {"mesh", r.mesh},
          {"setting", r.setting},       {"preset", r.preset},
          {"triangles", r.triangles},   {"size_in", r.size_in},
          {"size_out", r.size_out},     {"unit", r.unit},
          {"values", values},           {"cpu_seconds", r.cpu_seconds},
          {"cpu_spread", r.cpu_spread}, {"wall_seconds", r.wall_seconds},
          {"memory_mib", r.memory_mib}, {"failure", r.failure}};
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

}  // namespace

Status save(const Results& results, const std::filesystem::path& path) {
  Json j{{"format", "libatlas-bench-1"}, {"machine", to_json(results.machine)}};
  for (const char* list : {"rows", "fits", "checks"}) j[list] = Json::array();
  for (const Row& row : results.rows) j["rows"].push_back(to_json(row));
  for (const Fit& f : results.fits)
    j["fits"].push_back({{"stage", f.stage},
                         {"work", f.work},
                         {"quantity", f.quantity},
                         {"exponent", f.exponent},
                         {"factor", f.factor},
                         {"smallest", f.smallest},
                         {"largest", f.largest},
                         {"points", f.points}});
  for (const Check& c : results.checks)
    j["checks"].push_back({{"group", c.group},
                           {"stress", c.stress},
                           {"quantity", c.quantity},
                           {"value", c.value},
                           {"bound", c.bound},
                           {"holds", c.holds()},
                           {"note", c.note}});
  std::ofstream file(path);
  file << j.dump(1) << '\n';
  file.flush();
  if (file) return {};
  return {ErrorCode::io, path.string() + ": cannot be written (does the folder exist?)"};
}

Result<Results> load(const std::filesystem::path& path) {
  std::ifstream file(path);
  if (!file) return Status{ErrorCode::not_found, path.string() + ": no such file"};
  try {
    const Json j = Json::parse(file);
    if (j.at("format") != "libatlas-bench-1")
      return Status{ErrorCode::bad_input, path.string() + ": not a result file of atlas-bench"};
    return results_from(j);
  } catch (const Json::exception& error) {
    return Status{ErrorCode::bad_input, path.string() + ": " + error.what()};
  }
}

}  // namespace atlas::bench
