#pragma once

#include "engine/component.hpp"
#include "engine/signal/true_motion.hpp"

#include <cstdint>
#include <vector>

namespace bris {

/// 1 + index in InertialRecorders::list; 0: the body has no inertial recorder.
struct RecorderOf : State<std::uint32_t> {
    static constexpr auto name = "recorder", unit = "";
};

/// The motion of the bodies with inertial recorders in the present step.
struct NotedMotions {
    static constexpr auto name = "noted_motions";
    std::vector<TrueMotion> of; ///< in the order of InertialRecorders::list
};

} // namespace bris
