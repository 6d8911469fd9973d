#pragma once

#include "engine/archive.hpp"

#include <array>

namespace bris {

/// Simulated time. The time step is constant within a block of steps; the time is the start of the
/// block plus steps * dt, never a running sum.
struct Clock {
    static constexpr auto name = "clock";
    static constexpr bool is_state = true;

    std::uint64_t step = 0;       ///< since the start of the run
    std::uint64_t block_step = 0; ///< step at which the current block began
    double block_time = 0;        ///< s
    double dt = 0;                ///< s
    /// Whether something outside the step may look at the world after the present step, which must
    /// then leave behind what is derived for such readers only. Not saved.
    bool observed = true;
    /// Whether the State must be complete after the present step, because something other than the
    /// step may read it. Always with `observed`. Not saved.
    bool last = true;

    double time() const { return block_time + static_cast<double>(step - block_step) * dt; }
    /// Begins a new block with another time step, `new_dt` (s).
    void change_step(double new_dt) {
        block_time = time();
        block_step = step;
        dt = new_dt;
    }
    void save(Archive& archive) const {
        const std::array<std::uint64_t, 2> steps{step, block_step};
        const std::array<double, 2> times{block_time, dt};
        archive.put("clock/steps", std::span<const std::uint64_t>(steps));
        archive.put("clock/times", std::span<const double>(times));
    }
    void load(const Archive& archive) {
        const auto steps = archive.get<std::uint64_t>("clock/steps");
        const auto times = archive.get<double>("clock/times");
        step = steps.at(0);
        block_step = steps.at(1);
        block_time = times.at(0);
        dt = times.at(1);
    }
};

} // namespace bris
