#pragma once

#include "engine/errors.hpp"

#include <algorithm>
#include <string>
#include <vector>

namespace bris {

/// The value that a name stands for, one of `names`, which are in the order of the enumeration.
/// Throws InputError if there is none.
template <class Enumeration>
Enumeration named(const std::vector<std::string>& names, const std::string& word) {
    const auto found = std::ranges::find(names, word);
    require(found != names.end(), "expected a known name, found \"" + word + "\"");
    return static_cast<Enumeration>(found - names.begin());
}

} // namespace bris
