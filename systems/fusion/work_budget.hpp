#pragma once

#include "engine/archive.hpp"
#include "engine/world.hpp"

#include <cstdint>
#include <limits>
#include <string>
#include <vector>

namespace bris {

/// Smallest fraction to which a correction or nudging is reduced. One that would have to be reduced
/// further has no meaning for this model and is withheld.
inline constexpr double least_share = 0.01;

/// Limit on the work of corrections in a staged test: a fraction of the work that the boundaries
/// (platens and membrane together) have done since the previous analysis, minus the deficit. An
/// unused allowance lapses. The cost of a direct insertion is predicted: the springs of the
/// contacts would store some energy (basis), and recent corrections have cost `ratio` times their
/// basis. Since forces balance where a correction begins, its cost grows as its square, so all
/// corrections of an analysis are scaled by the square root of allowed over expected work. Nudging
/// acts until the next analysis while the boundaries do work. Its basis is the gain times that
/// work, and the gain is chosen so that its cost is the allowed work; if it has cost that much by
/// the end of a stage, it is released.
struct WorkBudget {
    static constexpr double none = std::numeric_limits<double>::quiet_NaN();
    double largest_share = 0; ///< fraction of the boundaries' work; 0: no limit
    double allowed = none;    ///< J, from this analysis to the next
    double expected = none;   ///< J, of the corrections of this analysis if applied in full
    double gain = 1;          ///< of the nudging, 0 to 1
    double boundaries = 0;    ///< J, work of the boundaries until this analysis
    double allowance = 0;     ///< J, work that would be allowed without a deficit
    double deficit = 0;       ///< J, work done so far beyond the allowances
    double basis = 0;         ///< J, of the corrections that were applied
    /// Cost over basis of the last analysis that applied a correction, or half the ratio before,
    /// whichever is larger.
    double ratio = 1;
    /// J, work of corrections until this analysis: of each sensor, then of all other bodies
    /// together.
    std::vector<double> work_done;
    std::uint64_t reduced = 0;  ///< number of corrections of single sensors that were reduced
    std::uint64_t withheld = 0; ///< number of corrections that were withheld

    void save(Archive& archive, const std::string& path) const;
    void load(const Archive& archive, const std::string& path);
};

/// Limits the work of corrections from now on to this fraction of the boundaries' work (0 to 1; 0:
/// no limit). Throws InputError outside this range.
void set_work_budget(World& world, double largest_share);

/// To be called before samples are assimilated: computes what the previous corrections have cost,
/// and what the next may cost.
void begin_analysis(World& world);

/// True if limit_corrections has an effect: there is a limit, and corrections are direct
/// insertions. Nudging is limited by its gain instead.
bool limits_corrections(const World& world);

/// Reduces or withholds the corrections of an analysis before they begin, and informs the filters
/// and updates the records of this analysis, which start at `first_record`. `energy`: J, that the
/// corrections would store in contacts (spread_corrections, energy_of_corrections).
void limit_corrections(World& world, std::size_t first_record, double energy);

/// To be called before the platens move. Keeps nudging forces constant, because the targets are no
/// longer known, or releases them if they have cost more than allowed.
void hold_nudging_forces(World& world);

} // namespace bris
