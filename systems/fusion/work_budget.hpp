#pragma once

#include "engine/archive.hpp"
#include "engine/world.hpp"

#include <cstdint>
#include <limits>
#include <string>
#include <vector>

namespace bris {

/// A correction or pull that is to be cut to a smaller share is no news of this model, and is not
/// given.
inline constexpr double least_share = 0.01;

/// What corrections may cost in a test by stages: a share of what the boundaries (platens and
/// membrane together) have done since the analysis before, less what is owed; what is not used
/// lapses. What is put is judged before it is put: the springs of its contacts would store some
/// energy (basis), and corrections of late have cost `ratio` times that. Cost goes as the square of
/// a correction, since forces balance where it begins; so all of an analysis are given a share of
/// the square root of allowed over expected. What is pulled pulls until the next analysis, through
/// what boundaries do: its basis is the gain times their work, and its gain such that it costs what
/// is allowed; should it have cost that before, it is let go.
struct WorkBudget {
    static constexpr double none = std::numeric_limits<double>::quiet_NaN();
    double largest_share = 0; ///< of the boundaries' work; 0: no limit
    double allowed = none;    ///< J, from this analysis to the next
    double expected = none;   ///< J, of the corrections of this analysis if given whole
    double gain = 1;          ///< with which bodies are pulled, 0 to 1
    double boundaries = 0;    ///< J, done by them until this analysis
    double allowance = 0;     ///< J, what it would be allowed if nothing were owed
    double deficit = 0;       ///< J, spent before over what was allowed
    double basis = 0;         ///< J, of what was given
    double ratio = 1; ///< of cost to basis: of the last analysis that gave something, or half of
                      ///< what it was before, whichever is more
    std::vector<double> work_done; ///< J, by corrections until this analysis: sensor by sensor, and
                                   ///< of all others together
    std::uint64_t reduced = 0;  ///< corrections that were cut, of single sensors
    std::uint64_t withheld = 0; ///< that were not given at all

    void save(Archive& archive, const std::string& path) const;
    void load(const Archive& archive, const std::string& path);
};

/// From now on corrections may do at most this share of the boundaries' work (0 to 1).
void set_work_budget(World& world, double largest_share);

/// Before samples are taken: what the corrections before have cost, and what those to come may.
void begin_analysis(World& world);

/// Whether limit_corrections has anything to do: no where there is no limit, nor for pulls, which
/// have got their gain.
bool limits_corrections(const World& world);

/// Cuts or withholds the corrections that an analysis has given, not yet begun, and tells filters
/// and the records of this analysis, from `first_record` on. `energy`: J, that they would store in
/// contacts (spread_corrections, energy_of_corrections).
void limit_corrections(World& world, std::size_t first_record, double energy);

/// Before platens move: what pulls stays as a force, for where bodies should be is known no more;
/// or is let go where it has cost enough.
void hold_nudging_forces(World& world);

} // namespace bris
