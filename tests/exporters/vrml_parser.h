// An independent reader of the VRML97 subset, which builds a plain token tree to check what was
// written.
#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

namespace atlas::test {

// A node with its fields. A field is a list of tokens (numbers, words, strings with their quotes),
// or of nodes.
struct VrmlNode {
  std::string type, def;
  std::map<std::string, std::vector<std::string>> tokens;
  std::map<std::string, std::vector<std::shared_ptr<VrmlNode>>> nodes;

  const std::vector<std::string>& field(const std::string& name) const;
  const VrmlNode& child(const std::string& name) const;
  bool has(const std::string& name) const { return tokens.count(name) || nodes.count(name); }
};

// Throws std::runtime_error with the offset where the text breaks the grammar: numbers other than
// [+-]?digits[.digits][e[+-]digits], DEF names that are not identifiers, unbalanced brackets.
std::vector<std::shared_ptr<VrmlNode>> parse_vrml(const std::string& text);

// Returns a number, parsed as strictly as by the strictest reader; throws.
double vrml_number(const std::string& token);

}  // namespace atlas::test
