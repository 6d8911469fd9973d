#pragma once

#include "scenarios/triaxial/triaxial.hpp"
#include "scenarios/triaxial/triaxial_scene.hpp"

namespace bris {

/// Consolidates a copy of a prepared specimen under equal pressure from all sides, without gravity
/// and with the friction of the preparation. The porosity of its core changes: sensor rocks that
/// were held are free, and the membrane gives way. The specimen itself stays as it is.
class TrialConsolidation {
public:
    /// `specimen`: State of the prepared specimen of a scene. `settings`: of its preparation.
    TrialConsolidation(const TriaxialScene& scene, const TriaxialSettings& settings,
                       const Archive& specimen, unsigned threads);

    /// Runs one block of steps; returns false when the copy is in equilibrium. Throws
    /// SimulationError.
    bool advance();
    /// Of the core of the copy in equilibrium.
    double core_porosity() const { return test_.state().core_porosity; }
    PhaseProgress progress() const;
    const StepCount& count() const { return simulation_.count(); }

private:
    Simulation simulation_;
    TriaxialTest test_;
};

} // namespace bris
