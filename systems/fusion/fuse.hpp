#pragma once

#include "components/body.hpp"
#include "components/kinds.hpp"
#include "components/sensor.hpp"
#include "components/settings.hpp"
#include "engine/clock.hpp"
#include "engine/rows.hpp"
#include "systems/fusion/analysis_record.hpp"
#include "systems/fusion/nudging.hpp"
#include "systems/fusion/sensor_filter.hpp"
#include "systems/fusion/work_budget.hpp"

namespace bris {

/// What was measured, and when: s by the clock of the simulation, or axial strain
/// (Fusion::by_strain).
struct TimedMeasurement {
    double time;
    Measured what;
    double arrives = time; ///< not before: late
    bool again = false;    ///< has come before, as add_sensors finds: tells nothing new
};

/// The recordings of a scene's sensors, by their rows, each in the order of arrival.
struct Replay {
    static constexpr auto name = "replay";
    std::vector<std::vector<TimedMeasurement>> samples;
};

/// The filters of a scene's sensors, by their rows.
struct Fusion {
    static constexpr auto name = "fusion";
    static constexpr bool is_state = true;
    std::vector<SensorFilter> filters;
    unsigned injection_steps =
        1; ///< in which a correction of position enters; 1: it jumps (set_correction)
    NudgingSettings nudging;
    /// m: a correction may change no overlap of its body by more in a step (twice that between two
    /// such bodies). What is over it is corrected by less; by a hundred times, not at all. 0: any
    /// is given whole. Pulls have their own limit.
    double largest_shift = 0;
    double note_every = 0; ///< s or strain between notes of the motion, beside those of analyses:
                           ///< for samples that come late; 0: none
    bool spread = false;   ///< corrections are spread over the contact network (spread_corrections)
    bool by_strain = false;  ///< in a test by stages time means nothing: samples are taken by axial
                             ///< strain, and all rests then
    double strain = 0;       ///< to which they have been
    std::uint64_t notes = 0; ///< intervals of note_every that have been begun
    WorkBudget budget;       ///< what corrections may cost, in a test by stages
    std::vector<AnalysisRecord> records; ///< of all analyses

    void save(Archive& archive) const;
    void load(const Archive& archive);
};

/// Makes sensors of bodies: their table, filters and recordings, and the columns by which
/// corrections enter. One for each host; throws InputError if samples are not in the order of
/// arrival, arrive before they are taken, or a host is twice among them.
void add_sensors(World& world, const std::vector<EntityId>& hosts,
                 std::vector<std::vector<TimedMeasurement>> samples, const FilterSettings& settings,
                 unsigned injection_steps = 1);

using FusedSensors = Rows<Sensors, const SensorHost, NextSample, Accepted, Refused, TooLate,
                          Reduced, Withheld, LargestInnovation>;
template <class... Shape>
using FusedBodies =
    Rows<Bodies, const BodyId, const Position, const BoundingRadius, const Acceleration,
         const InertialMass, Velocity, AngularVelocity, StepAngularVelocity, AngularMomentum,
         Guided, Correction, Nudging, FusionWork, Shape...>;

/// Whether a sample has come by the end of this step, or the motion is to be noted.
bool fusion_is_due(const World& world);

/// In a test by stages, between steps: where none of the samples that have come is let in, counts
/// them and notes the motion, which takes no step and moves nothing. False: one is; the next step
/// takes them all.
bool dismiss_samples(World& world);

/// Corrects the bodies of sensors by the samples that have come by now, each in the place of its
/// time: velocity and spin at once, position and attitude in the steps to come. What velocities
/// gain in energy is booked; contacts see it in the next step, whether there are new lists in it or
/// not.
void fuse_spheres(FusedSensors sensors, FusedBodies<const SphereInertia> bodies, Fusion& fusion,
                  ListState& lists, const Replay& replay, const Clock& clock);
void fuse_clumps(FusedSensors sensors, FusedBodies<const Orientation, const InertialInertia> bodies,
                 Fusion& fusion, ListState& lists, const Replay& replay, const Clock& clock);

/// J, put into the scene by all corrections.
double fusion_work(const World& world);

} // namespace bris
