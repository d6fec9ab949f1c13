// Text, tables and pictures, written as Markdown and as HTML.
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
  // Rows whose last cell is "EXCEEDED" or "missed" are highlighted in the HTML.
  void table(const Cells& header, const std::vector<Cells>& rows);

  std::string markdown, html;
};

}  // namespace atlas::bench
