#include "tests/exporters/vrml_parser.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdlib>
#include <stdexcept>

namespace atlas::test {
namespace {

[[noreturn]] void fail(const std::string& what, std::size_t at) {
  throw std::runtime_error(what + " at offset " + std::to_string(at));
}

bool is_identifier(const std::string& name) {
  const auto plain = [](unsigned char c) { return std::isalnum(c) || c == '_'; };
  return !name.empty() && !std::isdigit(static_cast<unsigned char>(name[0])) &&
         std::all_of(name.begin(), name.end(), plain);
}

class Parser {
 public:
  explicit Parser(const std::string& text) : text_(text) {
    if (text.rfind("#VRML V2.0 utf8\n", 0) != 0) fail("wrong header", 0);
    at_ = 16;
  }

  std::vector<std::shared_ptr<VrmlNode>> run() {
    std::vector<std::shared_ptr<VrmlNode>> nodes;
    for (std::string token = next(); !token.empty(); token = next()) nodes.push_back(node(token));
    return nodes;
  }

 private:
  std::string next() {
    while (at_ < text_.size()) {
      if (std::isspace(static_cast<unsigned char>(text_[at_])) || text_[at_] == ',') {
        ++at_;
      } else if (text_[at_] == '#') {
        while (at_ < text_.size() && text_[at_] != '\n') ++at_;
      } else {
        break;
      }
    }
    if (at_ >= text_.size()) return {};
    const std::size_t start = at_;
    if (std::string("{}[]").find(text_[at_]) != std::string::npos) return text_.substr(at_++, 1);
    if (text_[at_] == '"') {
      for (++at_; at_ < text_.size() && text_[at_] != '"'; ++at_) {
        if (text_[at_] == '\\') ++at_;
        if (text_[at_] & 0x80) fail("a byte beyond ASCII", at_);
      }
      if (at_++ >= text_.size()) fail("an open string", start);
      return text_.substr(start, at_ - start);
    }
    while (at_ < text_.size() && !std::isspace(static_cast<unsigned char>(text_[at_])) &&
           std::string("{}[],\"#").find(text_[at_]) == std::string::npos) {
      ++at_;
    }
    return text_.substr(start, at_ - start);
  }

  std::string peek() {
    const std::size_t before = at_;
    const std::string token = next();
    at_ = before;
    return token;
  }

  std::shared_ptr<VrmlNode> node(std::string token) {
    auto result = std::make_shared<VrmlNode>();
    if (token == "DEF") {
      result->def = next();
      if (!is_identifier(result->def)) {
        fail("the name '" + result->def + "'", at_);
      }
      token = next();
    }
    if (token.empty() || !std::isupper(static_cast<unsigned char>(token[0]))) {
      fail("no node: '" + token + "'", at_);
    }
    result->type = token;
    if (next() != "{") fail("no { after " + token, at_);
    for (token = next(); token != "}"; token = next()) {
      if (token.empty() || !std::islower(static_cast<unsigned char>(token[0]))) {
        fail("no field: '" + token + "'", at_);
      }
      if (result->has(token)) fail("field twice: " + token, at_);
      values(*result, token);
    }
    return result;
  }

  static bool is_node(const std::string& token) {
    return token == "DEF" ||
           (token.size() > 1 && std::isupper(static_cast<unsigned char>(token[0])) &&
            token != "TRUE" && token != "FALSE");
  }

  void values(VrmlNode& owner, const std::string& field) {
    std::string token = next();
    if (is_node(token)) {
      owner.nodes[field].push_back(node(token));
    } else if (token == "[") {
      auto& list = owner.tokens[field];
      for (token = next(); token != "]"; token = next()) {
        if (token.empty() || token == "{" || token == "}") fail("an open list", at_);
        is_node(token) ? owner.nodes[field].push_back(node(token)) : list.push_back(token);
      }
    } else {
      auto& list = owner.tokens[field];
      list.push_back(token);
      // A single-valued field of several numbers extends to the next field.
      for (token = peek();
           !token.empty() && token != "}" && !std::islower(static_cast<unsigned char>(token[0]));
           token = peek()) {
        list.push_back(next());
      }
    }
  }

  const std::string& text_;
  std::size_t at_ = 0;
};

}  // namespace

const std::vector<std::string>& VrmlNode::field(const std::string& name) const {
  const auto at = tokens.find(name);
  if (at == tokens.end()) throw std::runtime_error(type + " has no field " + name);
  return at->second;
}

const VrmlNode& VrmlNode::child(const std::string& name) const {
  const auto at = nodes.find(name);
  if (at == nodes.end() || at->second.size() != 1) {
    throw std::runtime_error(type + " has no single node " + name);
  }
  return *at->second.front();
}

std::vector<std::shared_ptr<VrmlNode>> parse_vrml(const std::string& text) {
  return Parser(text).run();
}

double vrml_number(const std::string& token) {
  std::size_t i = token[0] == '-' ? 1 : 0;
  const auto digits = [&] {
    const std::size_t start = i;
    while (i < token.size() && std::isdigit(static_cast<unsigned char>(token[i]))) ++i;
    return i > start;
  };
  bool good = digits();
  if (good && i < token.size() && token[i] == '.') ++i, good = digits();
  if (good && i < token.size() && token[i] == 'e') {
    ++i;
    if (i < token.size() && (token[i] == '-' || token[i] == '+')) ++i;
    good = digits();
  }
  const double value = std::strtod(token.c_str(), nullptr);
  if (!good || i != token.size() || !(std::abs(value) <= 3.4028234663852886e38)) {
    throw std::runtime_error("not a plain number: '" + token + "'");
  }
  return value;
}

}  // namespace atlas::test
