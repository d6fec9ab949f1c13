#include "tests/support/vrml_nodes.h"

#include <cctype>
#include <charconv>
#include <cstring>
#include <stdexcept>
#include <utility>

namespace atlas::test::vrml {
namespace {

class Reader {
 public:
  explicit Reader(std::string_view text) : text_(text) {
    if (text.substr(0, 15) != "#VRML V2.0 utf8")
      throw std::runtime_error("the VRML header is missing");
    advance();
  }
  Nodes read() {
    while (kind_ != Kind::end) {
      if (word_ == "ROUTE") {
        for (int i = 0; i < 4; ++i) advance();
      } else if (const Node* node = read_node()) {
        nodes_.roots.push_back(node);
      }
    }
    return std::move(nodes_);
  }

 private:
  enum class Kind { end, word, number, string, mark };

  [[noreturn]] void fail(const std::string& wanted) const {
    throw std::runtime_error("VRML, byte " + std::to_string(at_) + ": expected " + wanted);
  }

  void advance() {
    while (at_ < text_.size() && (std::isspace(static_cast<unsigned char>(text_[at_])) ||
                                  text_[at_] == ',' || text_[at_] == '#')) {
      if (text_[at_] == '#')
        while (at_ < text_.size() && text_[at_] != '\n') ++at_;
      else
        ++at_;
    }
    if (at_ >= text_.size()) {
      kind_ = Kind::end;
      word_ = {};
      return;
    }
    const std::size_t first = at_;
    const char c = text_[at_];
    if (std::strchr("{}[]", c)) {
      kind_ = Kind::mark;
      ++at_;
    } else if (c == '"') {
      kind_ = Kind::string;
      for (++at_; at_ < text_.size() && text_[at_] != '"'; ++at_)
        if (text_[at_] == '\\') ++at_;
      if (at_ >= text_.size()) fail("a closing quote");
      ++at_;
      word_ = text_.substr(first + 1, at_ - first - 2);
      return;
    } else {
      while (at_ < text_.size() && !std::isspace(static_cast<unsigned char>(text_[at_])) &&
             !std::strchr("{}[],\"#", text_[at_]))
        ++at_;
      const auto [end, error] = std::from_chars(text_.data() + first, text_.data() + at_, number_);
      kind_ = error == std::errc() && end == text_.data() + at_ ? Kind::number : Kind::word;
    }
    word_ = text_.substr(first, at_ - first);
  }

  Node* read_node() {
    if (kind_ != Kind::word) fail("a node");
    if (word_ == "NULL") return advance(), nullptr;
    if (word_ == "USE") {
      advance();
      Node* node = defined_[std::string(word_)];
      if (!node) fail("a DEF before USE " + std::string(word_));
      return advance(), node;
    }
    std::string name;
    if (word_ == "DEF") {
      advance();
      name = word_;
      advance();
    }
    Node* node = &nodes_.all.emplace_back();
    node->type = word_;
    if (!name.empty()) defined_[name] = node;
    advance();
    if (word_ != "{") fail("{ after " + node->type);
    advance();
    while (word_ != "}") {
      if (kind_ != Kind::word) fail("a field of " + node->type);
      const std::string field(word_);
      advance();
      read_value(node->fields[field]);
    }
    advance();
    return node;
  }

  void read_value(Value& value) {
    if (kind_ == Kind::mark && word_ == "[") {
      for (advance(); !(kind_ == Kind::mark && word_ == "]");) {
        if (kind_ == Kind::end) fail("]");
        read_item(value);
      }
      advance();
    } else if (kind_ == Kind::number) {
      while (kind_ == Kind::number) read_item(value);
    } else {
      read_item(value);
    }
  }

  void read_item(Value& value) {
    if (kind_ == Kind::number) {
      value.numbers.push_back(number_);
      advance();
    } else if (kind_ == Kind::string) {
      value.strings.emplace_back(word_);
      advance();
    } else if (word_ == "TRUE" || word_ == "FALSE") {
      value.numbers.push_back(word_ == "TRUE");
      advance();
    } else {
      value.nodes.push_back(read_node());
    }
  }

  std::string_view text_, word_;
  std::size_t at_ = 0;
  Kind kind_ = Kind::end;
  double number_ = 0;
  Nodes nodes_;
  std::map<std::string, Node*> defined_;
};

}  // namespace

Nodes read_nodes(std::string_view text) {
  return Reader(text).read();
}

}  // namespace atlas::test::vrml
