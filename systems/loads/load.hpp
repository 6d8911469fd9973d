#pragma once

#include "systems/loads/element.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace bris {

/// A factor as a function of time: mean + amplitude sin(2 pi frequency (t - start) + phase) for
/// t >= start, and its value at `start` before; or, where `times` is not empty, a table that is
/// interpolated linearly and constant beyond its ends.
struct LoadHistory {
    double mean = 1, amplitude = 0;
    double frequency = 0, phase = 0, start = 0;  ///< Hz, rad, s
    std::vector<double> times = {}, values = {}; ///< s, ascending

    double at(double time) const {
        if (times.empty())
            return mean +
                   amplitude * std::sin(2 * pi * frequency * std::max(0.0, time - start) + phase);
        const auto next = std::upper_bound(times.begin(), times.end(), time) - times.begin();
        if (next == 0) return values.front();
        const auto k = static_cast<std::size_t>(next);
        if (k == times.size()) return values.back();
        const double part = (time - times[k - 1]) / (times[k] - times[k - 1]);
        return values[k - 1] + part * (values[k] - values[k - 1]);
    }
};

/// A force and a couple on a body, both fixed in direction, times a history.
struct Load {
    Vec3 force = Vec3::Zero();  ///< N, world frame
    Vec3 couple = Vec3::Zero(); ///< N m, world frame
    Vec3 point = Vec3::Zero();  ///< m, where the force acts, in the axes of the body
    LoadHistory history = {};

    static auto fields(auto& self) {
        auto& h = self.history;
        return std::tie(self.force, self.couple, self.point, h.mean, h.amplitude, h.frequency,
                        h.phase, h.start, h.times, h.values);
    }
};

/// 1 + index in Loads::of_body; 0: none.
struct LoadOf : State<std::uint32_t> {
    static constexpr auto name = "load", unit = "";
};
/// Sum of the loads on a body in this step.
struct LoadForce : Derived<Wrench> {
    static constexpr auto name = "load_force", unit = "N, N m";
};
/// Work that loads have done on the body.
struct LoadWork : State<double> {
    static constexpr auto name = "load_work", unit = "J";
};

/// The loads of a scene. Phases may change them between steps.
struct Loads : ElementLists<Load>, ElementDefaults {
    static constexpr auto name = "loads", plural = "loads";
    static constexpr bool is_state = true;
    void save(Archive& archive) const { save_elements(archive, "loads", of_body); }
    void load(const Archive& archive) { load_elements(archive, "loads", of_body); }

    using Acting = LoadForce;
    using Work = LoadWork;
    static StepList force_systems();
    static StepList work_systems();
};

/// Adds a load on a free body in a scene of clumps. Throws InputError.
void add_load(World& world, EntityId body, const Load& load);

} // namespace bris
