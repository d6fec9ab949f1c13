// The order of image files that are frames, and the animations that their names tell.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace atlas::app {

// Whether a comes before b in natural order: numbers within names count by their value, so walk_2
// comes before walk_10. Folders are compared one by one. Names that differ only in leading zeros
// come in the order of their bytes.
bool natural_less(const std::filesystem::path& a, const std::filesystem::path& b);

struct Animation {
  std::string name;
  std::vector<std::string> frames;  // the images' names, in the order that was given
};

// Returns the animations: each has two or more images whose names are equal up to the number at
// their end, "walk_1.png" and "walk_2.png" for "walk". Images that are called by a number alone
// are an animation with the name of their folder, if they lie in one. `names` are in natural
// order, with '/'.
std::vector<Animation> animations_of(const std::vector<std::string_view>& names);

}  // namespace atlas::app
