#pragma once

#include "engine/archive.hpp"
#include "engine/clock.hpp"
#include "engine/health.hpp"
#include "engine/math.hpp"

#include <limits>
#include <string>

namespace bris {

/// Acceleration of weight, m/s2; acts on the true mass. Absent: no weight. Phases may change it.
struct Gravity {
    static constexpr auto name = "gravity";
    static constexpr bool is_state = true;
    Vec3 value{0, 0, -9.81};

    void save(Archive& archive) const {
        archive.put("gravity", std::span<const double>(value.data(), 3));
    }
    void load(const Archive& archive) {
        const auto v = archive.get<double>("gravity");
        value = Vec3(v.at(0), v.at(1), v.at(2));
    }
};

/// Local (Cundall) damping: each component of force on a body is reduced by this fraction where it
/// drives the motion and raised where it opposes it. In [0, 1). For quasi-static runs only: it also
/// damps free fall.
struct LocalDamping {
    static constexpr auto name = "local_damping";
    static constexpr bool is_state = true;
    double fraction = 0.7;

    void save(Archive& archive) const { put_fields(archive, "local_damping", std::tie(fraction)); }
    void load(const Archive& archive) { get_fields(archive, "local_damping", std::tie(fraction)); }
};

/// How the pair lists are kept. No choice here can change a bit of the result.
struct ListSettings {
    static constexpr auto name = "list_settings";
    double outer_skin = 0;   ///< m, > inner_skin; 0: chosen from the radii at the first refresh
    double inner_skin = 0;   ///< m, > 0; 0: likewise
    double largest_skin = 0; ///< m, of tuned skins; chosen likewise
    double widest_ratio =
        3; ///< of radii in a grid of the search for pairs; rocks of one grading stay in one
    unsigned sort_every = 8; ///< refreshes between re-orderings of rows; 0: never
    bool tune = true;        ///< skins follow the counts of work
};

/// Counts of work, and what decides when lists are made anew.
struct ListState {
    static constexpr auto name = "list_state";
    bool stale = true;               ///< entities or State have changed by hand
    bool velocities_changed = false; ///< velocities have: contacts have yet to see them
    std::uint64_t rebuilds = 0, prunes = 0, sorts = 0;
    std::uint64_t last_rebuild = 0, last_prune = 0; ///< steps
    std::uint64_t prunes_at_rebuild = 0;
    double candidate_skin = 0; ///< m, within which the candidates are complete
};

/// What the guard stops at.
struct Limits {
    static constexpr auto name = "limits";
    static constexpr bool is_state = true;
    double overlap = 0.25; ///< of the mean radius of the partners
    double speed = 1e3;    ///< m/s
    Vec3 low = Vec3::Constant(
        -std::numeric_limits<double>::infinity()); ///< m, no free body may leave this box
    Vec3 high = Vec3::Constant(std::numeric_limits<double>::infinity());

    void save(Archive& archive) const { put_fields(archive, "limits", std::tie(overlap, speed)); }
    void load(const Archive& archive) { get_fields(archive, "limits", std::tie(overlap, speed)); }
};

} // namespace bris
