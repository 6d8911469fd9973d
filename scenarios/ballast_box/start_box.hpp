#pragma once

#include "engine/run.hpp"
#include "engine/scenario.hpp"
#include "engine/simulation.hpp"
#include "scenarios/ballast_box/box_settings.hpp"
#include "scenarios/specimens/bed_store.hpp"

#include <string>
#include <string_view>
#include <vector>

namespace bris {

/// The world of a box with its step. Throws InputError, and SimulationError where its rocks need
/// more memory than there is.
Simulation make_box_simulation(const BallastBox& box, const Common& common);
/// The same, computed as a whole by each of several ranks.
Simulation make_undivided_box(const BallastBox& box, const Common& common);

/// The systems of its step, those of the fields of a fouled run included (--explain).
std::string explain_box(const BallastBox& box, const Common& common);

/// Settings of the state that a finished bed of a box is brought to: the run of table 1, fines and
/// water. None if its bed is mixed with them. They refer to `common`.
std::vector<std::string_view> settings_of_state(const BallastBox& box, const Common& common);

/// Continues a run from --resume; does nothing without it. Settings in `may_differ` may have
/// changed. Fields are added where the checkpoint has them. Throws InputError, OutputError.
void resume_box(Run& run, Simulation& simulation, const BallastBox& box, const Common& common,
                const std::vector<std::string_view>& may_differ);

/// The finished bed of a box: a run that begins without --resume takes it from the store of beds
/// (BedStore), or makes it and adds it.
class BoxBed {
public:
    /// `simulation`: before its first step. `after_bed`: settings that act after the bed was made,
    /// which serves for any of their values. `of_named_bed`: settings that act on it, but may
    /// differ from those of a bed that --resume names. They refer to `common`, which must outlive
    /// this.
    BoxBed(const Simulation& simulation, const Common& common,
           std::vector<std::string_view> after_bed,
           const std::vector<std::string_view>& of_named_bed = {});

    /// Begins the run: with the bed of the store, if that has it, or from --resume. Settings in
    /// `may_differ` may differ from those of a checkpoint that is not of a bed. Throws InputError
    /// if the bed has fines, and the run asks for one that was made without them.
    void begin(Run& run, Simulation& simulation, const BallastBox& box,
               const std::vector<std::string_view>& may_differ) const;

    /// Adds bed.ckpt.h5 in the folder of results to the store, if this run made it.
    void keep() const;

private:
    const Common& common_;
    std::vector<std::string_view> after_bed_;
    BedStore store_;
};

} // namespace bris
