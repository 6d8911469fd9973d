#pragma once

#include "engine/scenario.hpp"
#include "scenarios/ballast_box/box_settings.hpp"
#include "scenarios/track/bed_below_tie.hpp"
#include "scenarios/track/settling_track.hpp"

#include <cstddef>
#include <functional>
#include <memory>
#include <string_view>
#include <vector>

namespace bris {

/// A stretch of track with bays of ballast below the ties in its middle, coupled by the rails:
/// each bay is loaded as the rails load its tie, runs by itself for a block of axles, and gives its
/// settlement and stiffness back. Ties without a bay settle by the law, with what good bays settle.
/// Loads do not change within a block, which is not repeated: rearrangement is no smooth function
/// of the load.
struct CoupledTrack {
    StretchSettings stretch = {};
    SettlementLaw law = {};          ///< of the ties without a bay
    BallastBox clean = {}, mud = {}; ///< of the settlement model
    unsigned bays = 7, cycles = 100; ///< cycles: axles
    double pad_stiffness = 120e6;    ///< N/m, of both pads of a tie
    /// Largest change of a level within a block, of R0 / tie_support; a block has at most ten
    /// axles.
    double block = 0.1;

    bool has_bay(std::size_t tie) const;
};

/// What a bay has done in a block of axles.
struct BayBlock {
    std::size_t tie = 0;                  ///< from 0
    double cycles = 0;                    ///< axles so far
    double load = 0;                      ///< N, largest force of the bed on the tie
    double settlement = 0, stiffness = 0; ///< m, so far; N/m, of bed and subgrade
};

struct CoupledHistory {
    std::vector<StretchState> states; ///< before the first axle, and after each block
    std::vector<BayBlock> blocks;
};

/// Throws InputError if its numbers do not fit together, or the boxes of its bays are none.
void check_coupled(const CoupledTrack& track);

/// Runs the stretch. Bays run at once, each on one thread; the result does not depend on how many.
/// After each block the state is saved in the folder of results, from which --resume goes on;
/// settings in `may_differ` may have changed. Throws InputError, SimulationError, OutputError,
/// Interrupted.
CoupledHistory couple_bays(const CoupledTrack& track, const Common& common,
                           const std::vector<std::string_view>& may_differ);

/// The same with other beds: `bed_of(tie, common)` makes that of a tie, with a folder of its own.
using MakeBed = std::function<std::unique_ptr<BedBelowTie>(std::size_t tie, const Common& common)>;
CoupledHistory couple_beds(const CoupledTrack& track, const MakeBed& bed_of, const Common& common,
                           const std::vector<std::string_view>& may_differ);

/// Settlement of the mud bays over that of the good ones under the same load, which the law's
/// exponent stands for; NaN without bays of both kinds.
double ratio_of_bays(const CoupledTrack& track, const CoupledHistory& history);

} // namespace bris
