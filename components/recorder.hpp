#pragma once

#include "engine/component.hpp"

#include <cstdint>

namespace bris {

/// 1 + index in InertialRecorders::list; 0: the body has no inertial recorder.
struct RecorderOf : State<std::uint32_t> {
    static constexpr auto name = "recorder", unit = "";
};

} // namespace bris
