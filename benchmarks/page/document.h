// Text, tables and pictures that come out as Markdown and as HTML alike.
#pragma once

#include <string>
#include <vector>

namespace atlas::bench {

using Cells = std::vector<std::string>;

class Document {
 public:
  explicit Document(const std::string& title);
  void heading(const std::string& text);
  void paragraph(const std::string& text);
  // `file` lies in the folder plots/ beside the document.
  void image(const std::string& file, const std::string& text);
  // Rows whose last cell is one of the marks "EXCEEDED" and "missed" stand out in the HTML.
  void table(const Cells& header, const std::vector<Cells>& rows);

  std::string markdown, html;
};

}  // namespace atlas::bench
