#pragma once

#include "engine/io/series.hpp"
#include "engine/options.hpp"
#include "engine/run.hpp"
#include "engine/simulation.hpp"
#include "scenarios/field_tests/rock_bed.hpp"
#include "scenarios/rocks/own_rocks.hpp"
#include "scenarios/specimens/fouling_options.hpp"
#include "scenarios/specimens/write_option.hpp"

#include <array>
#include <functional>
#include <string>
#include <vector>

namespace bris {

/// Settings of direct shear tests. The lower half of the box moves along x; the upper half is
/// fixed, and its top plate is free along z only: it does not tilt.
struct ShearBox {
    double length = 0.305, width = 0.305, height = 0.203;
    double least_box = 6;
    BedRocks rocks = {};
    std::string material = "granite";
    double wall_friction = 0;
    double porosity = 0.38, porosity_tolerance = 0.005, preparation_pressure = 50e3;
    std::vector<double> normal_stress{25e3, 50e3, 100e3};
    std::vector<double> vci{0};
    double displacement = 0.03, speed = 0.03, interval = 1e-4;
    double safety = 0.5, tolerance = 2e-3;
    std::string fines = "field";
    double fines_size = 0.01, fines_friction = 0.5;
    FoulingOptions fouling = {.settings = {.voxel = 0.01}};
    WriteOption written = {};

    void declare_options(auto& option);
    double area() const { return length * width; }
    /// m, height of the plane between the halves.
    double plane() const { return 0.5 * height; }
};

/// Throws InputError for settings that do not fit together.
void check_shear_box(const ShearBox& box);

/// The halves of a box.
struct BoxHalves {
    static constexpr auto name = "shear_box";
    EntityId lower = nobody, upper = nobody; ///< sides and flange of each half
    EntityId floor = nobody;                 ///< of the lower half
};

/// How far a test has come; State.
struct ShearState {
    static constexpr auto name = "shear_test";
    static constexpr bool is_state = true;
    double steps = 0;        ///< of consolidation
    double start_height = 0; ///< m, of the plate when shearing begins
    double start_vci = 0;    ///< %, void contaminant index when shearing begins
    double displacement = 0; ///< m, of the lower half
    void save(Archive& archive) const {
        put_fields(archive, "shear_test", std::tie(steps, start_height, start_vci, displacement));
    }
    void load(const Archive& archive) {
        get_fields(archive, "shear_test", std::tie(steps, start_height, start_vci, displacement));
    }
};

/// The simulation of a box with its rocks still parked. Throws InputError.
Simulation make_shear_box(const ShearBox& box, std::uint64_t seed, unsigned threads);
/// The same with given rocks.
Simulation make_shear_box(const ShearBox& box, const std::vector<Clump>& clumps,
                          const RockSample& sample, std::uint64_t seed, unsigned threads);

/// A test of one specimen: its normal stress (Pa) and its void contaminant index (%).
struct ShearTest {
    double normal_stress = 50e3, vci = 0;
};

/// Fills the voids of a made specimen with fines, where the test or the options ask for them. With
/// `fill` false only the fields are added, for a checkpoint to be loaded. Fines as grains are
/// bodies instead.
void add_fines(Simulation& simulation, const ShearBox& box, const ShearTest& test,
               std::uint64_t seed, bool fill);

/// Void contaminant index (%) of a test at present: of its field, or of its grains, with the void
/// ratio that fines have in place.
double contaminant_index(const World& world, const ShearBox& box);

/// A sample of a shear test.
struct ShearSample {
    double displacement, shear_stress, normal_stress, stress_ratio, plane_normal_stress, dilation,
        shear_force_lower_half, shear_force_upper_half, normal_force_lower_half,
        normal_force_upper_half, weight_of_rocks, work_put_in, energy_stored, work_lost,
        kinetic_energy, coordination_number, unbalanced_ratio, inertial_number;
    static constexpr auto columns() {
        using S = ShearSample;
        return std::array{Sampled{&S::displacement, "displacement", "m"},
                          Sampled{&S::shear_stress, "shear_stress", "Pa"},
                          Sampled{&S::normal_stress, "normal_stress", "Pa"},
                          Sampled{&S::stress_ratio, "stress_ratio", ""},
                          Sampled{&S::plane_normal_stress, "plane_normal_stress", "Pa"},
                          Sampled{&S::dilation, "dilation", "m"},
                          Sampled{&S::shear_force_lower_half, "shear_force_lower_half", "N"},
                          Sampled{&S::shear_force_upper_half, "shear_force_upper_half", "N"},
                          Sampled{&S::normal_force_lower_half, "normal_force_lower_half", "N"},
                          Sampled{&S::normal_force_upper_half, "normal_force_upper_half", "N"},
                          Sampled{&S::weight_of_rocks, "weight_of_rocks", "N"},
                          Sampled{&S::work_put_in, "work_put_in", "J"},
                          Sampled{&S::energy_stored, "energy_stored", "J"},
                          Sampled{&S::work_lost, "work_lost", "J"},
                          Sampled{&S::kinetic_energy, "kinetic_energy", "J"},
                          Sampled{&S::coordination_number, "coordination_number", ""},
                          Sampled{&S::unbalanced_ratio, "unbalanced_ratio", ""},
                          Sampled{&S::inertial_number, "inertial_number", ""}};
    }
};

/// Phases of a test on a made specimen: growth of fines that are grains, consolidation under the
/// normal stress, and shear. `curve` gets a sample at the beginning and after each interval of
/// displacement; `frame` is called at each tenth of the displacement. Both must outlive the phases.
std::vector<Phase> shear_phases(const ShearBox& box, const ShearTest& test,
                                SeriesOf<ShearSample>& curve,
                                const std::function<void(const World&)>& frame);

void ShearBox::declare_options(auto& option) {
    option.group("Box and specimen");
    option("length", length, "m", "Inner length of the box, along which it is sheared.",
           within(0.02, 2));
    option("width", width, "m", "Inner width of the box.", within(0.02, 2));
    option("height", height, "m", "Height of the specimen. The box is divided at half of it.",
           within(0.02, 2));
    option("least_box", least_box, "",
           "Least length and width of the box over the size of its largest rock.", within(2, 100));
    option("grading", rocks.grading, "", help_grading);
    option("clumps", rocks.clumps, "", help_clumps);
    option("rock_scale", rocks.scale, "", "Factor on all sizes of rocks.", within(0.01, 4));
    option("smallest_rock", rocks.smallest, "m",
           "Sieve size below which the grading is truncated, before scaling. 0: its finest sieve.",
           within(0, 0.06));
    option("material", material, "",
           "Rock of the ballast: granite, limestone (assets/materials) or the path of a file. "
           "Floor and plate have its friction.");
    option("wall_friction", wall_friction, "",
           "Friction of the end walls of both halves; front and back are frictionless.",
           within(0, 2));
    option("porosity", porosity, "", "Porosity of the core of the specimen after preparation.",
           within(0.25, 0.6));
    option("porosity_tolerance", porosity_tolerance, "",
           "Accepted difference of the porosity where friction cannot be reduced further.",
           within(1e-4, 0.1));
    option("preparation_pressure", preparation_pressure, "Pa",
           "Pressure of the plate while the specimen is made.", within(1e3, 1e6));
    option.group("Test");
    option("normal_stress", normal_stress, "Pa",
           "Normal stress or stresses of the tests, by the plate and its weight.",
           within(1e3, 1e7));
    option("vci", vci, "%",
           "Void contaminant index or indices of the tests. Each normal stress is tested with each "
           "of them, on the same specimen.",
           within(0, 150));
    option("displacement", displacement, "m", "Displacement of the lower half at the end.",
           within(1e-4, 0.5));
    option("speed", speed, "m/s", "Speed of the lower half.", within(1e-4, 1));
    option("interval", interval, "m", "Displacement between samples.", within(1e-6, 0.01));
    option("tolerance", tolerance, "", "Unbalanced force ratio at which consolidation ends.",
           within(1e-6, 0.1));
    option("safety", safety, "",
           "Time step over the stable step for which masses are scaled. The sum of the masses is "
           "the true one when shearing begins.",
           within(0.05, 0.8));
    fouling.declare_options(option);
    option(
        "fines", fines, "",
        "Fines of --vci as a field that weakens contacts by the laws above, or as grains: spheres "
        "that fill the same part of the voids and move and carry forces as rocks do.",
        {"field", "grains"});
    option("fines_size", fines_size, "m", "Diameter of the grains.", within(1e-3, 0.02));
    option("fines_friction", fines_friction, "", "Friction between grains.", within(0, 2));
    option.group("Files");
    written.declare_options(option, write_of_clumps);
}

} // namespace bris
