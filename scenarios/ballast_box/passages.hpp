#pragma once

#include "engine/io/series.hpp"
#include "engine/run.hpp"
#include "scenarios/ballast_box/box_run.hpp"
#include "scenarios/ballast_box/train.hpp"

#include <functional>
#include <string>
#include <vector>

namespace bris {

/// N/m, of a whole tie, of clean beds of the model `bay` of which none was measured.
inline constexpr double usual_bed = 80e6;
/// The rails of a track on pads and beds of these stiffnesses (N/m, of a whole tie), unless the box
/// states the support of its ties.
RailOnTies rails_on(const BallastBox& box, double pads, double bed);

/// Settings of trains that pass over one tie of a bay of track.
struct TrackPassage {
    BallastBox box = {.model = "bay", .tie_support = 0, .porosity = 0.42, .fines = "filled"};
    std::string train = "passenger", first_train = "none";
    double speed = 0;
    unsigned passages = 2;
    double gap = 0, pad_stiffness = 120e6;

    void declare_options(auto& option);

    double speed_of(const std::string& name) const {
        return speed > 0 ? speed : name == "passenger" ? 31.3 : 20.0;
    }
    double train_speed() const { return speed_of(train); }
    /// The rails over this tie and others on pads and beds as stiff as its own was under the train
    /// before, unless their support is given.
    RailOnTies rails(const World& world) const;
};

/// A sample of a passage, on the tie that the train passes.
struct PassageSample {
    double passage, time, load, deflection, tie_support, subgrade_force, unbalanced_ratio;
    static constexpr auto columns() {
        using S = PassageSample;
        return std::array{Sampled{&S::passage, "passage", ""},
                          Sampled{&S::time, "time", "s"},
                          Sampled{&S::load, "load", "N"},
                          Sampled{&S::deflection, "deflection", "m"},
                          Sampled{&S::tie_support, "tie_support", "N"},
                          Sampled{&S::subgrade_force, "subgrade_force", "N"},
                          Sampled{&S::unbalanced_ratio, "unbalanced_ratio", ""}};
    }
};

/// What is done at the ends of a block of a passage and of a passage.
struct PassageActions {
    std::function<void()> frame;                    ///< every tenth of a second
    std::function<void(unsigned number)> completed; ///< passages count from 1
    std::function<void()> bed_saved = {};
};

/// The first train of `settings` passes over the bed, which nothing records. All references must
/// outlive the phase.
Phase first_passage(const BoxTestRun& test, const Run& run, const TrackPassage& settings);

/// The phases after the bed of a track was made: the first train passes, if there is one, the bed
/// is saved as bed.ckpt.h5, it changes in use as the run asks, the tie is hung up if there is to be
/// a gap, then the train passes `passages` times. `samples` has passage_columns(). All references
/// must outlive the phases.
std::vector<Phase> passage_phases(const BoxTestRun& test, const Run& run,
                                  const TrackPassage& settings, const Train& train,
                                  SeriesOf<PassageSample>& samples, const PassageActions& actions);

/// The tie's response to one passage.
struct PassageResponse {
    double settlement = 0;      ///< m, permanent, in this passage
    double deflection = 0;      ///< m, largest, from the beginning of the passage
    double largest_load = 0;    ///< N, on the half tie of the model
    double largest_support = 0; ///< N, vertical force of the ballast on the tie
};
/// Throws InputError if the samples have no passage of that number.
PassageResponse passage_response(const SeriesOf<PassageSample>& samples, unsigned number);

void TrackPassage::declare_options(auto& option) {
    option.group("Train");
    option("train", train, "",
           "Train: passenger, freight, inspection, locomotive (assets/trains), or the path of a "
           "CSV file with the "
           "columns position_m and axle_load_kN.");
    option("speed", speed, "m/s",
           "Speed of the train. 0: 31.3 m/s (70 mph) for passenger, 20 m/s for others.",
           within(0, 120));
    option("passages", passages, "",
           "Passages of the train one after the other; the first one on a new bed settles it.",
           within(1, 1000));
    option("first_train", first_train, "",
           "Train that passes once over the new bed to settle it, before the bed is saved and "
           "without being recorded; none: no such train.");
    option("gap", gap, "m",
           "Gap under the tie: it hangs on the rails so far above the settled ballast, and takes "
           "load when the rails have pushed it down. 0: it lies on the ballast.",
           within(0, 0.05).usually(0, 0.01));
    option("pad_stiffness", pad_stiffness, "N/m",
           "Stiffness of the pads between the rails and a tie, those of both rails together.",
           within(1e6, 1e10).usually(5e7, 5e8));
    option.group("Ballast");
    box.declare_state_option(option);
    option("rock_scale", box.rock_scale, "", "Factor on all sizes of rocks. 0: 1.7.", within(0, 4));
    box.declare_ballast_options(option);
    box.fouling.declare_options(option);
    box.declare_fines_option(option);
    option("sensor_density", box.sensor_density, "kg/m3",
           "Density of the sensor rocks in the finished bed; 0: that of the rocks.",
           within(0, 1e6).usually(100, 1e4));
    option("sensor_friction", box.sensor_friction, "",
           "Coulomb friction coefficient of the shells of the sensor rocks in the finished bed; "
           "between a shell and a rock the lower coefficient acts. Below 0: that of the rocks.",
           within(-1, 100));
    option.group("Track");
    box.declare_track_options(option);
    option.group("Simulation");
    box.declare_simulation_options(option);
    box.written.declare_options(option, write_of_clumps);
}

} // namespace bris
