#pragma once

#include "scenarios/ballast_box/box_run.hpp"
#include "scenarios/ballast_box/box_settings.hpp"
#include "scenarios/track/bed_below_tie.hpp"

namespace bris {

/// A bay of ballast under half a tie of a track, in a world of its own, with frictionless sides and
/// scaled masses (the settlement model of the ballast box), loaded so slowly that inertia does not
/// matter.
class Bay : public BedBelowTie {
public:
    /// `box`: of the settlement model. `common`: of the bay alone: its folder of results, which
    /// must exist, the seed of its packing, and the settings on which its bed depends.
    Bay(const BallastBox& box, const Common& common);

    /// Takes the bed from the store or makes it, and seats the tie.
    void prepare(const ReportProgress& report) override;
    double load(double force, unsigned axles) override;
    /// Change of the force over that of the deflection in the last unloading.
    double stiffness() const override { return stiffness_; }
    void save(const std::filesystem::path& checkpoint) const override;
    void resume(const std::filesystem::path& checkpoint) override;

private:
    /// Half a load cycle.
    void advance_turn();

    BallastBox box_;
    Common common_;
    Simulation simulation_;
    BoxTestRun test_;
    double stiffness_ = 0;
};

} // namespace bris
