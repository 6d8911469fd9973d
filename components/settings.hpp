#pragma once

#include "engine/archive.hpp"
#include "engine/clock.hpp"
#include "engine/health.hpp"
#include "engine/math.hpp"

#include <atomic>
#include <limits>
#include <string>

namespace bris {

/// Gravitational acceleration, m/s2, which acts on the true mass. Without this resource bodies have
/// no weight. Phases may change it.
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

/// Local (Cundall) damping: each component of the force on a body is reduced by this fraction where
/// it drives the motion and increased by it where it opposes the motion. Valid range: [0, 1). Only
/// for quasi-static runs, because it also damps free fall.
struct LocalDamping {
    static constexpr auto name = "local_damping";
    static constexpr bool is_state = true;
    double fraction = 0.7;

    void save(Archive& archive) const { put_fields(archive, "local_damping", std::tie(fraction)); }
    void load(const Archive& archive) { get_fields(archive, "local_damping", std::tie(fraction)); }
};

/// Settings of the pair lists. None of them changes a bit of the result.
struct ListSettings {
    static constexpr auto name = "list_settings";
    // Skins of two bodies of mean speed together. Faster bodies have larger skins than slower ones.
    double outer_skin = 0;   ///< m, > inner_skin; 0: chosen from the radii at the first rebuild
    double inner_skin = 0;   ///< m, > 0; 0: chosen from the radii at the first rebuild
    double largest_skin = 0; ///< m, limit of tuned skins; 0: chosen from the radii
    /// Largest ratio of radii within one grid of the pair search. The default keeps the rocks of
    /// one grading in one grid.
    double widest_ratio = 3;
    unsigned sort_every =
        8;            ///< rebuilds from one sorting of rows to the next; 0: rows are not sorted
    bool tune = true; ///< true: the skins are adapted to the measured counts of work
};

/// Counts of work, and the state that decides when the pair lists are made anew.
struct ListState {
    static constexpr auto name = "list_state";
    bool stale = true; ///< entities or State were changed from outside the step
    bool velocities_changed =
        false; ///< velocities were changed and contacts have not read them yet
    std::uint64_t rebuilds = 0, prunes = 0, sorts = 0;
    std::uint64_t last_rebuild = 0, last_prune = 0; ///< step numbers
    std::uint64_t prunes_at_rebuild = 0;
    bool used_up = false;          ///< a body has moved further than its inner skin
    bool skins_are_chosen = false; ///< for the next prune, by review_candidates
    /// The candidates that are current, or are made next, serve for few steps: they have no larger
    /// skins than the near pairs.
    bool brief = false;

    /// Sets used_up; may be called by several threads.
    void note_used_up() { std::atomic_ref(used_up).store(true, std::memory_order_relaxed); }
};

/// Whether the records of contact forces are written in the present step. Most steps need only the
/// sums of forces.
struct Observation {
    static constexpr auto name = "observation";
    bool due = true;
};

/// Where only contacts read the motion of single spheres from step to step (move_spheres), the
/// columns Position, Velocity, Acceleration, AngularVelocity and StepAngularVelocity are written
/// only in steps in which they are due. Meanwhile ListedPosition, RigidMotion and Kick have the
/// motion; the spins are valid in them only if move_spheres or keep_spins wrote them last.
struct MotionColumns {
    static constexpr auto name = "motion_columns";
    bool due = true;      ///< the present step writes them
    bool current = true;  ///< they had the motion at the beginning of the present step
    bool skipped = false; ///< the present step has not written them

    /// Sets skipped; may be called by several threads.
    void note_skipped() { std::atomic_ref(skipped).store(true, std::memory_order_relaxed); }
};

/// Limits at which the guard stops the run.
struct Limits {
    static constexpr auto name = "limits";
    static constexpr bool is_state = true;
    double overlap = 0.25; ///< as a fraction of the mean radius of the partners
    /// Factor on `overlap` for contacts while violent impacts are expected. Unlike `overlap` it
    /// does not change the resolution of the sums of forces, and so no bit of a run that it lets go
    /// on.
    double impact_allowance = 1;
    double speed = 1e3; ///< m/s
    /// m, lower and upper corner of a box that no free body may leave.
    Vec3 low = Vec3::Constant(-std::numeric_limits<double>::infinity());
    Vec3 high = Vec3::Constant(std::numeric_limits<double>::infinity());

    double overlap_of_contacts() const { return impact_allowance * overlap; }

    void save(Archive& archive) const {
        put_fields(archive, "limits", std::tie(overlap, speed));
        put_fields(archive, "guard/impact_allowance", std::tie(impact_allowance));
        put_fields(archive, "guard/box",
                   std::tie(low.x(), low.y(), low.z(), high.x(), high.y(), high.z()));
    }
    void load(const Archive& archive) {
        get_fields(archive, "limits", std::tie(overlap, speed));
        impact_allowance = 1; // checkpoints of earlier versions do not have it
        if (archive.find("guard/impact_allowance") != nullptr)
            get_fields(archive, "guard/impact_allowance", std::tie(impact_allowance));
        get_fields(archive, "guard/box",
                   std::tie(low.x(), low.y(), low.z(), high.x(), high.y(), high.z()));
    }
};

} // namespace bris
