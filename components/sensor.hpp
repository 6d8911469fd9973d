#pragma once

#include "engine/component.hpp"
#include "engine/entity.hpp"
#include "engine/math.hpp"

namespace bris {

struct Sensors {
    static constexpr auto name = "sensors";
};

// A SmartRock in the scene: its body, and how much of its recording has been used.

struct SensorId : State<EntityId> {
    static constexpr auto name = "id", unit = "";
    static constexpr bool is_key = true;
};
struct SensorHost : State<EntityId> {
    static constexpr auto name = "host", unit = "";
};
/// Index of the next sample of its recording.
struct NextSample : State<std::uint64_t> {
    static constexpr auto name = "next_sample", unit = "";
};
/// Number of measured vectors that the gate accepted.
struct Accepted : State<std::uint64_t> {
    static constexpr auto name = "accepted", unit = "";
};
/// Number of measured vectors that the gate rejected as too far from the forecast, and of repeated
/// samples.
struct Refused : State<std::uint64_t> {
    static constexpr auto name = "refused", unit = "";
};
/// Number of corrections of which only a part was applied because they were too large for a step.
struct Reduced : State<std::uint64_t> {
    static constexpr auto name = "reduced", unit = "";
};
/// Number of corrections of which nothing was applied because they were much too large.
struct Withheld : State<std::uint64_t> {
    static constexpr auto name = "withheld", unit = "";
};
/// Largest normalised innovation squared: chi-squared with three degrees of freedom.
struct LargestInnovation : State<double> {
    static constexpr auto name = "largest_innovation", unit = "";
};

/// Correction of a body's pose, applied in equal parts over the next `steps` steps. `as_motion` 1:
/// contacts see the correction as velocity, so friction acts on it; 0: direct insertion, which
/// contacts do not see as velocity. A row of zeros is no correction.
struct CorrectionRow {
    Vec3 shift = Vec3::Zero(), turn = Vec3::Zero();           ///< m and rad, per step
    Vec3 last_shift = Vec3::Zero(), last_turn = Vec3::Zero(); ///< m and rad, in the last step
    double steps = 0, as_motion = 0;
};
struct Correction : State<CorrectionRow> {
    static constexpr auto name = "correction", unit = "m, rad";
};
/// 1 while a body is corrected or nudged, and in the step after; otherwise 0. Only few bodies are
/// guided, and the systems of the fusion skip all others.
struct Guided : State<std::uint32_t> {
    static constexpr auto name = "guided", unit = "";
};
/// Calls visit(row) for each body that is corrected or nudged.
template <class BodyRows, class Visit>
void for_guided(const BodyRows& bodies, Visit&& visit) {
    const std::uint32_t* guided = bodies.template column<Guided>();
    for (Row b = bodies.first(); b < bodies.last(); ++b)
        if (guided[b] != 0) visit(b);
}
/// Work done on the body by corrections and nudging since the start.
struct FusionWork : State<double> {
    static constexpr auto name = "fusion_work", unit = "J";
};

} // namespace bris
