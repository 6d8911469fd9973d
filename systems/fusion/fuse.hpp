#pragma once

#include "components/body.hpp"
#include "components/kinds.hpp"
#include "components/sensor.hpp"
#include "components/settings.hpp"
#include "engine/clock.hpp"
#include "engine/rows.hpp"
#include "systems/fusion/analysis_record.hpp"
#include "systems/fusion/sensor_filter.hpp"
#include "systems/loads/nudging.hpp"

namespace bris {

/// A measurement and its time: s on the simulation clock, or axial strain (Fusion::by_strain).
struct TimedMeasurement {
    double time;
    Measured what;
    bool again = false; ///< repeats an earlier sample (set by add_sensors): no new information
};

/// The recordings of a scene's sensors, by sensor row, each in the order of time.
struct Replay {
    static constexpr auto name = "replay";
    std::vector<std::vector<TimedMeasurement>> samples;
};

/// The filters of a scene's sensors, by sensor row, and how their corrections are applied.
struct Fusion {
    static constexpr auto name = "fusion";
    static constexpr bool is_state = true, changes_in_whole_steps_only = true;
    std::vector<SensorFilter> filters;
    /// Steps over which a correction of the pose is applied; 1: direct insertion (set_correction).
    unsigned injection_steps = 1;
    NudgingSettings nudging;
    /// m: largest displacement of any point of a body by its correction in a step, so that no
    /// overlap of the body changes by more (by twice that between two corrected bodies). A larger
    /// correction is reduced to this limit; one a hundred times larger is withheld. 0: no limit.
    /// Nudging has its own limit.
    double largest_shift = 0;
    /// True in a staged test, where time has no meaning: samples are indexed by axial strain, and
    /// all bodies are at rest when samples are assimilated.
    bool by_strain = false;
    double strain = 0;                   ///< axial strain up to which samples are assimilated
    std::vector<AnalysisRecord> records; ///< of all analyses

    void save(Archive& archive) const;
    void load(const Archive& archive);
};

/// Turns bodies into sensor rocks: adds the table of sensors, their filters and recordings, and the
/// columns of corrections. `samples`: one recording per host. Throws InputError if samples are not
/// in the order of time, if a host occurs twice, or if injection_steps is 0.
void add_sensors(World& world, const std::vector<EntityId>& hosts,
                 std::vector<std::vector<TimedMeasurement>> samples, const FilterSettings& settings,
                 unsigned injection_steps = 1);

using FusedSensors = Rows<Sensors, const SensorHost, NextSample, Accepted, Refused, Reduced,
                          Withheld, LargestInnovation>;
template <class... Shape>
using FusedBodies =
    Rows<Bodies, const BodyId, const Position, const BoundingRadius, const Acceleration,
         const InertialMass, Velocity, AngularVelocity, StepAngularVelocity, AngularMomentum,
         Guided, Correction, Nudging, FusionWork, Shape...>;

/// True if there is a sample by the end of this step.
bool fusion_is_due(const World& world);

/// For a staged test, between steps. If the gate accepts none of the samples that have arrived,
/// counts them without a step, moves nothing and returns true. Otherwise returns false, and the
/// next step assimilates all samples.
bool dismiss_samples(World& world);

/// Corrects the bodies of sensors by the samples that have arrived, each at its own time: velocity
/// and angular velocity at once, position and attitude over the next steps. The change of kinetic
/// energy is accumulated in FusionWork. Contacts see the new velocities in the next step, whether
/// or not it begins with new lists.
void fuse_spheres(FusedSensors sensors, FusedBodies<const SphereInertia> bodies, Fusion& fusion,
                  ListState& lists, const Replay& replay, const Clock& clock);
void fuse_clumps(FusedSensors sensors, FusedBodies<const Orientation, const InertialInertia> bodies,
                 Fusion& fusion, ListState& lists, const Replay& replay, const Clock& clock);

/// Work of all corrections and nudging on the scene, J.
double fusion_work(const World& world);

} // namespace bris
