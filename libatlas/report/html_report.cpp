#include "libatlas/report/html_report.h"

#include <cstdint>
#include <nlohmann/json.hpp>
#include <span>
#include <string_view>
#include <vector>

#include "libatlas/files/atomic_file.h"
#include "libatlas/image/webp.h"
#include "libatlas/report/report_json.h"
#include "report_page.h"

namespace atlas {
namespace {

using Json = nlohmann::ordered_json;

std::string base64(std::span<const std::uint8_t> bytes) {
  constexpr std::string_view kDigits =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out;
  out.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const std::size_t count = std::min<std::size_t>(3, bytes.size() - i);
    std::uint32_t word = 0;
    for (std::size_t k = 0; k < 3; ++k) word = word << 8 | (k < count ? bytes[i + k] : 0u);
    for (std::size_t k = 0; k < 4; ++k)
      out += k <= count ? kDigits[word >> (18 - 6 * k) & 63] : '=';
  }
  return out;
}

// Returns the picture as a data URL; null without a picture.
Result<Json> data_url(const Image8& picture) {
  if (picture.empty()) return Json(nullptr);
  const auto bytes = encode_webp(picture, {});
  if (!bytes.ok()) return bytes.status();
  return Json("data:image/webp;base64," + base64(*bytes));
}

Result<Json> pictures_json(const ReportPictures& pictures) {
  Json pages = Json::array(), worst = Json::array();
  for (const PagePicture& page : pictures.pages) {
    const Result<Json> shown = data_url(page.thumbnail), charts = data_url(page.charts);
    if (!shown.ok()) return shown.status();
    if (!charts.ok()) return charts.status();
    pages.push_back({{"page", *shown}, {"charts", *charts}});
  }
  for (const Image8& picture : pictures.worst) {
    const Result<Json> url = data_url(picture);
    if (!url.ok()) return url.status();
    worst.push_back(*url);
  }
  return Json{{"pages", pages}, {"worst", worst}};
}

// Returns JSON that can stand in a script of HTML: a '<' might end it.
std::string text_of(const Json& json) {
  std::string out;
  for (const char c : json.dump(-1, ' ', false, Json::error_handler_t::replace)) {
    if (c == '<')
      out += "\\u003c";
    else
      out += c;
  }
  return out;
}

// Puts `value` in the place of `mark`, which the template has once.
void fill(std::string& page, std::string_view mark, std::string_view value) {
  page.replace(page.find(mark), mark.size(), value);
}

}  // namespace

Status write_html(const ExportReport& report, const ReportRequest& request,
                  const std::filesystem::path& path) {
  const Result<Json> pictures = pictures_json(report.pictures);
  if (!pictures.ok()) return pictures.status();
  std::string options;
  for (const auto& [name, value] : request.options) options += name + " " + value + "\n";
  const Json asked{
      {"command", request.command}, {"options", options}, {"version", LIBATLAS_VERSION}};
  ReportRequest rows;  // the page draws them
  rows.chart_rows = true;
  std::string page(embedded::report_html);
  fill(page, "@style@", embedded::report_css);
  fill(page, "@script@", embedded::report_js);
  fill(page, "@report@", text_of(json_of(report, rows)));
  fill(page, "@asked@", text_of(asked));
  fill(page, "@pictures@", text_of(*pictures));
  return write_file(path, page);
}

}  // namespace atlas
