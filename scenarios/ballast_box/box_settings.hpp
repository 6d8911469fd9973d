#pragma once

#include "engine/options.hpp"
#include "engine/signal/imu.hpp"
#include "scenarios/ballast_box/table_1.hpp"
#include "scenarios/rocks/own_rocks.hpp"
#include "scenarios/specimens/fouling_options.hpp"
#include "scenarios/specimens/rock_material.hpp"
#include "scenarios/specimens/write_option.hpp"

#include <algorithm>
#include <array>
#include <string>
#include <vector>

namespace bris {

/// Settings of a ballast box. x: along the track; y: along the ties to the shoulder, from their
/// middle or, in the model `full`, from the wall behind their other end; z: up, from the surface of
/// the subgrade.
struct BallastBox {
    std::string run = "I.2", model = "settlement";
    double frequency = 0, peak_load = 0, least_load = 0.1;
    unsigned cycles = 0, steps_per_cycle = 16'000;
    double width = 0.2, rock_scale = 0, smallest_rock = 0.03;
    std::string material = "limestone", grading = "arema_3";
    std::filesystem::path clumps = {};
    std::string sensor_shape = "cube,rock_01,rock_02,rock_03";
    double sensor_density = 0, sensor_friction = -1; ///< of a bay; 0, below 0: as the rocks
    double friction_factor = 1, stiffness_factor = 1, restitution = 0;
    double subgrade_modulus = 200e6, subgrade_damping = 0.2, series_compliance = 0;
    double rail_bending = 1.58e7, tie_support = 3e7;
    unsigned box_ties = 0;
    double bladder_pressure = 200e3, tie_level = 0;
    double porosity = 0.40, compaction_pressure = 50e3, fill_softness = 0.25;
    double rest = 2e-3, step_fraction = 0.5;
    std::string imu = "smartrock-like";
    double sampling_rate = 500;
    FoulingOptions fouling = {.settings = {.voxel = 0.01}};
    std::string fines = "mixed"; ///< how they come into the bed: mixed or filled
    WriteOption written = {};

    void declare_options(auto& option);
    // the groups of options, which other scenarios of the box share
    void declare_ballast_options(auto& option);
    void declare_fines_option(auto& option);
    void declare_state_option(auto& option);
    void declare_track_options(auto& option);
    void declare_simulation_options(auto& option);

    /// True masses and recorders in the sensor rocks: the models with real time. The model `bay`,
    /// one tie over which trains pass, belongs to the scenarios track_passage and long_track.
    bool is_dynamic() const { return model == "dynamic" || is_full() || is_bay(); }
    bool is_full() const { return model == "full"; }
    bool is_bay() const { return model == "bay"; }
    /// Fines lie in each lift before it is compacted.
    bool is_mixed() const { return fines == "mixed"; }
    // settings with the default of 0 that a run or a model determines
    double peak() const { return peak_load > 0 ? peak_load : box_test(run).peak_load; }
    double least() const { return least_load * peak(); }
    double load_frequency() const {
        return frequency > 0 ? frequency : box_test(run).frequencies.back();
    }
    /// 0 in the model `full`: some steps of a cycle, which say how long 1 000 cycles would take.
    unsigned load_cycles() const {
        return cycles > 0 ? cycles : is_full() ? 0 : is_dynamic() ? 1 : 5;
    }
    /// Ties below the rails; in the model `full` all of them are modelled.
    unsigned ties() const { return box_ties > 0 ? box_ties : is_full() ? 4 : 2; }
    double scale() const {
        if (rock_scale > 0) return rock_scale;
        return is_full() ? 1 : is_bay() ? 1.7 : is_dynamic() ? 1.5 : 1.3;
    }
};

/// Throws InputError for settings that do not fit together.
void check_box(const BallastBox& box);

/// Fines and water of the run: as given, or where nothing is given those of the report's runs on
/// fouled ballast. None on clean ballast, where moisture has no effect: such a run has no fields.
FoulingOptions fouling_of(const BallastBox& box);

/// Upper limit of restitution while the bed is made, so that rocks come to rest soon.
inline constexpr double making_restitution = 0.3;

inline constexpr double tie_width = 0.27, tie_length = 2.59, tie_height = 0.23;  // m
inline constexpr double tie_mass = 2400 * (tie_width * tie_length * tie_height); // kg, of concrete
inline constexpr double tie_spacing = 0.61;                                      // m
inline constexpr double plate_thickness = 0.05; // m, of the plates that compact the lifts

/// Sizes of the box, its ties and its bladder, m. Those of the box are the report's; those of the
/// ties are usual for concrete ties.
struct BoxSizes {
    double width = 0;                        ///< along x: a slice, two bays, or the whole box
    std::vector<double> ties;                ///< x of each tie
    std::array<std::size_t, 2> loaded{0, 0}; ///< numbers of the ties below the two actuators
    double across = 1.68;                    ///< of the box along y
    double middle = 0;                       ///< y of the middle of the ties; 0: a mirror side
    double depth = 0.36;                     ///< of the ballast, as filled
    Vec3 tie = Vec3::Zero();                 ///< of the tie or half tie that is modelled
    double rail_seat = 0.7525;               ///< y from the middle of a tie
    double bladder_depth = 0.30;             ///< along y
    double bladder_low = 0.16;               ///< z of its lower side
    double bladder_height = 0.20;            ///< on which the pressure acts
    double bladder_top = 0.56;               ///< z of its upper side, so that no rock falls over it
    double bladder_face() const { return across - bladder_depth; } ///< y
    /// y of the centre of what is modelled of a tie, and of the load of the rails on it.
    double tie_centre() const { return middle > 0 ? middle : tie.y() / 2; }
    double load_place() const { return middle > 0 ? middle : rail_seat; }
    double tie_end() const { return tie_centre() + tie.y() / 2; } ///< y, beside the shoulder
    /// Share of a whole tie's load that the model's tie carries.
    double share = 0.5;
};
BoxSizes box_sizes(const BallastBox& box);

/// A course of ballast: its thickness (m) and whether it completes a lift, which is then compacted.
struct Course {
    double thickness;
    bool compacted;
};
/// The three lifts of 0.12 m. The upper one is poured in two courses, so that sensor rocks come to
/// lie 5 cm below the ties.
inline constexpr std::array<Course, 4> courses{
    {{0.12, true}, {0.12, true}, {0.07, false}, {0.05, true}}};
/// Number of the lift that a course belongs to.
constexpr std::size_t lift_of(std::size_t course) { return std::min<std::size_t>(course, 2); }

void BallastBox::declare_options(auto& option) {
    option.group("Test");
    option("run", run, "",
           "Run of table 1 of the report: I.1 to I.4 (clean) or II.1 to II.4 (fouled).");
    option(
        "model", model, "",
        "settlement: a slice under half a tie, quasi-static with scaled masses. dynamic: two "
        "half ties that are loaded 180 degrees apart, with true masses. full: the same with four "
        "whole ties in the whole box.",
        {"settlement", "dynamic", "full"});
    option("frequency", frequency, "Hz",
           "Frequency of the load in the dynamic model. 0: the highest one of the run.",
           within(0, 10));
    option("peak_load", peak_load, "N",
           "Peak load of each actuator, up to 490 kN. 0: that of the run.",
           within(0, 1e7).usually(1e3, 1e6));
    option("least_load", least_load, "", "Least load of each actuator over the peak load.",
           within(0, 0.9));
    option("cycles", cycles, "",
           "Load cycles. 0: 5 in the settlement model, 1 in the dynamic one, 200 time steps in the "
           "full one.",
           within(0, 1e6));
    option("steps_per_cycle", steps_per_cycle, "", "Time steps of a cycle in the settlement model.",
           within(200, 1e6));
    option.group("Ballast");
    option("width", width, "m", "Width of the slice of the settlement model along the track.",
           within(0.1, 0.61));
    option("rock_scale", rock_scale, "",
           "Factor on all sizes of rocks. 0: 1.3 in the settlement model, 1.5 in the dynamic one, "
           "1 in "
           "the full one.",
           within(0, 4));
    declare_ballast_options(option);
    fouling.declare_options(option);
    declare_fines_option(option);
    option.group("Track");
    declare_track_options(option);
    option("series_compliance", series_compliance, "m/N",
           "Compliance of frame, pads and rails between an actuator and its tie, which is added to "
           "that of the model.",
           within(0, 1e-6));
    option("box_ties", box_ties, "",
           "Ties that carry the rails. In the dynamic model 2 (those of the model; each actuator "
           "stands above one of them) or 4 (as in the box; the model's are the middle ones). In "
           "the full model 4 (the report's box of 3.96 m) or more, each with 0.61 m of track; "
           "actuators stand above the two middle ones. 0: 2 or 4.",
           within(0, 40));
    option.group("Simulation");
    declare_simulation_options(option);
    written.declare_options(option, write_of_clumps);
}

void BallastBox::declare_ballast_options(auto& option) {
    option("smallest_rock", smallest_rock, "m",
           "Sieve size below which the grading is truncated, before scaling.", within(0.01, 0.06));
    option("porosity", porosity, "",
           "Porosity at which the compaction of a lift ends, measured away from its sides.",
           within(0.3, 0.6));
    option("material", material, "",
           "Rock of the ballast: granite, limestone (assets/materials) or the path of a file.");
    option("grading", grading, "", help_grading);
    option("clumps", clumps, "", help_clumps);
    option("sensor_shape", sensor_shape, "",
           "Shapes of the sensor rocks under the rail seat, the middle and the end of a tie and "
           "between two ties: clumps of --clumps or of assets/clumps or paths of files. Fewer are "
           "taken in turn.");
    option("friction_factor", friction_factor, "",
           "Factor on the friction between rocks, uniform in the box.", above(0, 1));
    option("stiffness_factor", stiffness_factor, "",
           "Factor on the contact stiffness of rocks, uniform in the box.", above(0, 1));
    option("restitution", restitution, "",
           "Coefficient of restitution of all contacts of the loaded ballast, 0.3 to 1. 0: that of "
           "the materials.",
           within(0, 1));
    option("compaction_pressure", compaction_pressure, "Pa",
           "Mean pressure of the plate that compacts a lift; it oscillates by 60 % at 30 Hz.",
           within(1e3, 1e6));
    option("fill_softness", fill_softness, "",
           "Factor on the stiffness of rocks while the ballast is poured and compacted.",
           within(1e-3, 1));
}

void BallastBox::declare_fines_option(auto& option) {
    option("fines", fines, "",
           "mixed: fines and water lie in each lift before its compaction. filled: they come into "
           "the voids of the finished bed, so that states can be compared over one packing.",
           {"mixed", "filled"});
}

void BallastBox::declare_state_option(auto& option) {
    option("run", run, "",
           "State of the ballast, as in the runs of table 1 of the report: I.2 clean, I.4 without "
           "shoulder, II.2 fouled and dry, II.3 fouled and wet, II.4 fouled, wet and without "
           "shoulder.",
           {"I.2", "I.4", "II.2", "II.3", "II.4"});
}

void BallastBox::declare_track_options(auto& option) {
    option(
        "subgrade_modulus", subgrade_modulus, "N/m3",
        "Modulus of the subgrade: pressure over settlement of its plates. The default is that of a "
        "layer of 0.30 m with 60 MPa on a rigid floor.",
        within(1e6, 1e10));
    option("subgrade_damping", subgrade_damping, "",
           "Ratio of critical damping of the subgrade's plates.", within(0, 2));
    option("rail_bending", rail_bending, "N m2", "Bending stiffness E I of both rails together.",
           within(1e4, 1e9));
    option(
        "tie_support", tie_support, "N/m",
        "Support of the ties by pad, bed and subgrade in series, when the rails distribute the "
        "loads. 0, in track_passage and long_track only: its pads, and a bed of 80 MN/m or as the "
        "train before found it.",
        within(0, 1e10).usually(1e6, 1e9));
    option("bladder_pressure", bladder_pressure, "Pa",
           "Pressure in the bladder next to the shoulder while it is inflated.", within(0, 1e6));
    option("tie_level", tie_level, "m",
           "Height of the lower side of the ties when they are placed. 0: on the ballast.",
           within(0, 1));
}

void BallastBox::declare_simulation_options(auto& option) {
    option("rest", rest, "",
           "Unbalanced force ratio at which the box is at rest under the least loads, before the "
           "cycles begin.",
           within(1e-6, 0.1));
    option("step_fraction", step_fraction, "",
           "Time step over the stable step of the contacts, when the dynamic loading begins.",
           within(0.01, 0.9));
    option("imu", imu, "", "Inertial sensors of the sensor rocks (dynamic model).",
           {"ideal", "lab-grade", "smartrock-like", "cheap"});
    option("sampling_rate", sampling_rate, "Hz", "Sampling rate of the inertial sensors.",
           within(10, 5000));
}

} // namespace bris
