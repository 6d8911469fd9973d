#pragma once

#include "engine/archive.hpp"
#include "engine/run.hpp"
#include "scenarios/ballast_box/box_run.hpp"
#include "scenarios/ballast_box/train.hpp"

#include <filesystem>
#include <string>
#include <vector>

namespace bris {

/// How far a body moves downwards in a passage.
struct Movement {
    double deflection = 0; ///< m, the largest within a load cycle, since the beginning of the cycle
    double settlement = 0; ///< m, what remains at the end of the passage; negative: upwards
    /// m/N, displacement over the load of the rails on a tie, by least squares over all changes
    /// from one extreme of the load to the next.
    double compliance = 0;
};
/// Movements in one passage: of each sensor rock, in the order of BoxBodies::sensors, and the tie.
struct PassageMovements {
    std::vector<Movement> rocks = {};
    Movement tie = {};
};

/// The passages of a slice of track, kept in its checkpoints.
struct PassageRecord {
    std::vector<PassageMovements> passages = {}; ///< that have ended
    PassageMovements now = {};                   ///< of the present one
    /// m, of sensor rocks and tie when the present passage and its load cycle began, and at the
    /// last extreme of the load.
    std::vector<double> at_begin = {}, at_valley = {}, at_turn = {};

    void save(Archive& archive) const;
    void load(const Archive& archive);
};

/// A box of the settlement model, one half tie on a slice of ballast, over which trains pass so
/// slowly that inertia does not matter: each extreme of the load on the tie (load_turns) is reached
/// within half of BallastBox::steps_per_cycle.
struct TrackSlice {
    BallastBox box = {};
    std::uint64_t seed = 1; ///< of the packing
    RailOnTies rails() const {
        return {box.rail_bending, box.tie_support, tie_spacing, weight_of_tie};
    }
};

/// The settings of a box of that model whose tie is seated under the weight of the rails alone.
/// Throws InputError for another model.
BallastBox seated_by_rails(BallastBox box);

/// Makes the bed of a slice, seats its tie under the weight of the rails, lets the trains pass one
/// after the other, and saves a checkpoint NAME.ckpt.h5 in the folder of `common` at the end and
/// when one is due. With `from`, the checkpoint of a run of the same bed whose passages are the
/// first of these, the run goes on from there; settings in `may_differ` may have changed. Throws
/// InputError, SimulationError, OutputError and Interrupted.
PassageRecord run_trains(const TrackSlice& slice, const std::vector<Train>& trains,
                         const Common& common, const std::string& name,
                         const std::filesystem::path& from,
                         const std::vector<std::string_view>& may_differ,
                         const ReportProgress& report);

} // namespace bris
