#pragma once

#include "engine/archive.hpp"
#include "engine/simulation.hpp"
#include "scenarios/ensemble/model_run.hpp"
#include "scenarios/triaxial/triaxial.hpp"

#include <cstdint>
#include <vector>

namespace bris {

/// A running model of a triaxial test, with the poses of its rocks when shearing began.
class TriaxialModel {
public:
    /// Starts from a prepared specimen.
    TriaxialModel(const TriaxialScene& scene, const TriaxialSettings& settings,
                  const Archive& specimen, const RockParameters& parameters);

    /// Runs one block of steps of the test; returns false when the test is done.
    bool advance(const ModelVariant& variant);

    const Simulation& simulation() const { return simulation_; }
    World& world() { return simulation_.world(); }
    const TriaxialTest& test() const { return test_; }
    /// Number of points: one at the start of shearing, one for each stage.
    std::size_t stages() const { return test_.state().curves.size(); }
    const std::vector<EntityId>& rocks() const { return rocks_; } ///< sensor rocks first
    std::size_t sensors() const { return sensors_; }
    const std::vector<RockPose>& start() const { return start_; } ///< empty before shearing
    std::vector<RockPose> poses();
    /// Work (J) of the boundaries since shearing began.
    double boundary_work() const {
        return test_.state().curves[quantity::boundary_work].back() - work_before_;
    }
    /// Number of contacts from each rock to the nearest sensor rock, at present; at most
    /// farthest_shell.
    std::vector<unsigned> shells() const;

    Archive save() const;
    void load(const ModelVariant& variant, const Archive& archive);

private:
    void begin_shear(const ModelVariant& variant, std::vector<RockPose> poses, double work);

    Simulation simulation_;
    TriaxialTest test_;
    std::vector<EntityId> rocks_;
    std::size_t sensors_ = 0;
    std::vector<RockPose> start_;
    double work_before_ = 0;
};

} // namespace bris
