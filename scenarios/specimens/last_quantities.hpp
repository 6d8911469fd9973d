#pragma once

#include "engine/archive.hpp"
#include "engine/simulation.hpp"
#include "systems/output/quantities.hpp"

namespace bris {

/// The quantities of the last step of a run, and its stable step. They are kept in the checkpoints
/// of the run (Run::keep): they are made of contact forces, which are not State, so that a run that
/// is resumed after its last step would have none to report.
class LastQuantities {
public:
    /// The simulation must outlive this object.
    explicit LastQuantities(const Simulation& simulation) : simulation_(simulation) {}

    /// Of the present state; of the checkpoint if no step has been run since it was loaded.
    const Quantities& quantities();
    double stable_step(); ///< s

    void save(Archive& archive);
    void load(const Archive& archive);

private:
    /// Whether a value is that of an older state than the present one; it then becomes the latter.
    bool is_outdated(std::uint64_t& steps) const;

    const Simulation& simulation_;
    Quantities quantities_;
    double stable_step_ = 0;
    std::uint64_t steps_of_quantities_ = 0, steps_of_stable_step_ = 0; ///< that had been run
};

} // namespace bris
