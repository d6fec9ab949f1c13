// Reads the nodes of a VRML97 file, for world_mesh.h.
#pragma once

#include <deque>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace atlas::test::vrml {

// The value of a field.
struct Value {
  std::vector<double> numbers;
  std::vector<std::string> strings;
  std::vector<struct Node*> nodes;
};
struct Node {
  std::string type;
  std::map<std::string, Value> fields;

  const Value& field(const std::string& name) const {
    static const Value none;
    const auto it = fields.find(name);
    return it == fields.end() ? none : it->second;
  }
  const Node* node(const std::string& name) const {
    const Value& value = field(name);
    return value.nodes.empty() ? nullptr : value.nodes[0];
  }
};

// The nodes live in `all`, and so as long as this.
struct Nodes {
  std::deque<Node> all;
  std::vector<const Node*> roots;
};

// Throws std::runtime_error, naming the byte, if the text is no VRML.
Nodes read_nodes(std::string_view text);

}  // namespace atlas::test::vrml
