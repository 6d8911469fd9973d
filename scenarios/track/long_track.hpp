#pragma once

#include "engine/scenario.hpp"
#include "engine/simulation.hpp"
#include "scenarios/ballast_box/passages.hpp"

#include <string>

namespace bris {

/// Settings of a track of bays of ballast side by side, over which a train passes.
struct LongTrack {
    BallastBox box = {.model = "bay", .tie_support = 0, .porosity = 0.42};
    unsigned bays = 3, passages = 1;
    std::string train = "locomotive", first_train = "none";
    double speed = 31.3, duration = 0, pad_stiffness = 120e6, gap = 0;

    void declare_options(auto& option);
    bool settles_bay() const { return first_train != "none"; }
    /// Of the ties on springs beyond the ballast.
    RailOnTies rails() const { return rails_on(box, pad_stiffness, usual_bed); }
};

/// The track with its rail and a sensor on the middle tie. Fines and water stay where they are once
/// the bay was seated. Its bay is taken from the store or made, and each rank makes and
/// divides its own part. For a run that is resumed, of a bay that was never settled. Throws
/// InputError, SimulationError, OutputError, Interrupted.
Simulation make_track(const LongTrack& track, const Common& common);

/// Whether a run goes on with the track; an interrupted one may not yet have had its bay.
bool resumes_track(const Common& common);

/// Runs a step, in which the contacts between the bays are found, from which the time step of the
/// passages follows.
void find_step(Simulation& simulation, const LongTrack& track);
/// Hangs the ties up (hang_ties), after which the ballast needs `hanging_time` (s) to come to rest.
void begin_hanging(Simulation& simulation, const LongTrack& track);
inline constexpr double hanging_time = 0.2;
/// The train comes, and the sensors begin to record.
void begin_passage(Simulation& simulation, const LongTrack& track);

/// s, simulated time of a passage: as given, or until the last axle has left the rail.
double duration_of(const LongTrack& track, const World& world);

void LongTrack::declare_options(auto& option) {
    option.group("Track");
    option("bays", bays, "",
           "Bays of ballast, each with a tie and 0.61 m of track: copies of one bay, every "
           "second one its mirror image.",
           within(1, 20000).usually(1, 2000));
    option("pad_stiffness", pad_stiffness, "N/m",
           "Stiffness of the pads between the rails and a tie, those of both rails together.",
           within(1e6, 1e10).usually(5e7, 5e8));
    option("gap", gap, "m",
           "Gap under the ties on ballast: before the last passage they are hung on the rail so "
           "far above it. 0: they lie on the ballast.",
           within(0, 0.05).usually(0, 0.01));
    box.declare_track_options(option);
    option.group("Train");
    option("train", train, "",
           "Train: passenger, freight, inspection, locomotive (assets/trains), or the path of "
           "a CSV file with the columns position_m and axle_load_kN.");
    option("speed", speed, "m/s", "Speed of the train.", within(0.1, 120));
    option("passages", passages, "",
           "Passages of the train one after the other, of which the sensors record the last one.",
           within(1, 1000));
    option(
        "first_train", first_train, "",
        "Train that passes once over the bay by itself to settle it, before it is copied: at 31.3 "
        "m/s if it is passenger, else at 20 m/s. none: no such train.");
    option(
        "duration", duration, "s",
        "Simulated time of a passage, from the first axle on the rail on, which begins some 11 m "
        "before the ballast. 0: until the last axle has left it.",
        within(0, 1e4));
    option.group("Ballast");
    box.declare_state_option(option);
    option("rock_scale", box.rock_scale, "", "Factor on all sizes of rocks. 0: 1.7.", within(0, 4));
    box.declare_ballast_options(option);
    box.fouling.declare_options(option);
    box.declare_fines_option(option);
    option.group("Simulation");
    box.declare_simulation_options(option);
}

} // namespace bris
