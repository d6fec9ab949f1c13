#include "benchmarks/page/document.h"

#include <fmt/format.h>

#include <algorithm>

namespace atlas::bench {
namespace {

std::string escaped(const std::string& text) {
  std::string result;
  for (const char c : text)
    result += c == '<'   ? "&lt;"
              : c == '>' ? "&gt;"
              : c == '&' ? "&amp;"
              : c == '"' ? "&quot;"
                         : std::string(1, c);
  return result;
}

std::string row_markdown(const Cells& cells) {
  std::string text = "|";
  for (std::string cell : cells) {
    std::replace(cell.begin(), cell.end(), '|', '/');
    text += " " + cell + " |";
  }
  return text + "\n";
}

std::string row_html(const Cells& cells, const char* tag) {
  const bool bad = !cells.empty() && (cells.back() == "EXCEEDED" || cells.back() == "missed");
  std::string text = bad ? "<tr class=\"bad\">" : "<tr>";
  for (const std::string& cell : cells) text += fmt::format("<{0}>{1}</{0}>", tag, escaped(cell));
  return text + "</tr>\n";
}

}  // namespace

Document::Document(const std::string& title) {
  markdown = "# " + title + "\n";
  html = "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><title>" +
         escaped(title) +
         "</title>\n<style>body{font:15px sans-serif;max-width:76em;margin:2em auto;padding:0 1em}"
         "table{border-collapse:collapse;margin:1em 0;display:block;overflow-x:auto}"
         "td,th{border:1px solid #ccc;padding:.2em .6em;text-align:right}"
         "td:first-child,th:first-child,td:nth-child(2),th:nth-child(2){text-align:left}"
         ".bad{background:#fcc}img{max-width:100%}</style></head><body>\n<h1>" +
         escaped(title) + "</h1>\n";
}

void Document::heading(const std::string& text) {
  markdown += "\n## " + text + "\n";
  html += "<h2>" + escaped(text) + "</h2>\n";
}

void Document::paragraph(const std::string& text) {
  markdown += "\n" + text + "\n";
  html += "<p>" + escaped(text) + "</p>\n";
}

void Document::image(const std::string& file, const std::string& text) {
  markdown += fmt::format("\n![{}](plots/{})\n", text, file);
  html += fmt::format("<p><img src=\"plots/{}\" alt=\"{}\"></p>\n", file, escaped(text));
}

void Document::table(const Cells& header, const std::vector<Cells>& rows) {
  if (rows.empty()) return paragraph("(nothing was measured)");
  std::string rule = "|";
  for (std::size_t i = 0; i < header.size(); ++i) rule += i < 2 ? "---|" : "---:|";
  markdown += '\n' + row_markdown(header) + rule + '\n';
  html += "<table>" + row_html(header, "th");
  for (const Cells& row : rows) {
    markdown += row_markdown(row);
    html += row_html(row, "td");
  }
  html += "</table>\n";
}

}  // namespace atlas::bench
