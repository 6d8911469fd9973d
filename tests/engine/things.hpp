#pragma once

// A table whose rows have a name, for the tests of State.

#include "engine/component.hpp"

#include <cstdint>

namespace bris {

struct Things {
    static constexpr auto name = "things";
};
struct Name : State<std::uint32_t> {
    static constexpr auto name = "id", unit = "";
    static constexpr bool is_key = true;
};
struct Heat : State<double> {
    static constexpr auto name = "heat", unit = "K";
};

} // namespace bris
