#include "scenarios/assimilation/twin_variants.hpp"

#include "engine/errors.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <sstream>
#include <string_view>

namespace bris {

namespace {

constexpr std::array<std::string_view, 4> variant_names{"free", "inserted", "nudged", "analysis"};

} // namespace

std::vector<std::string> names_of_variants(const std::string& list) {
    std::vector<std::string> names;
    if (list == "none") return names;
    std::string all;
    for (const std::string_view name : variant_names)
        all += fmt::format("{}{}", all.empty() ? "" : ", ", name);
    std::istringstream text(list);
    for (std::string name; std::getline(text, name, ',');) {
        require(std::ranges::count(variant_names, name) == 1,
                fmt::format("--variants: expected {}, found '{}'", all, name));
        require(std::ranges::count(names, name) == 0,
                fmt::format("--variants: expected each variant once, found '{}' twice", name));
        names.push_back(name);
    }
    return names;
}

} // namespace bris
