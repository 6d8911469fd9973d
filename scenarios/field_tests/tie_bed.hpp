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

/// Settings of push tests of a single tie. x: along the track, y: along the tie, in the direction
/// of the push, z: up. The planes through the middle of the tie and of the crib are mirrors, so
/// that half of a bay is modelled; forces and masses of results are those of a whole tie.
struct TieBed {
    double tie_length = 2.59, tie_width = 0.27, tie_height = 0.23, tie_mass = 320;
    double spacing = 0.61, base = 0.3, shoulder = 0.35, slope = 1.5;
    BedRocks rocks = {.grading = "arema_3", .scale = 1.2, .smallest = 0.03};
    std::string material = "granite";
    double porosity = 0.42, porosity_tolerance = 0.005, preparation_pressure = 50e3;
    std::vector<double> vci{0};
    std::string shoulders = "both";
    double displacement = 0.02, speed = 0.02, interval = 1e-4;
    double safety = 0.5, tolerance = 2e-3;
    FoulingOptions fouling = {.settings = {.voxel = 0.02}};
    WriteOption written = {};

    void declare_options(auto& option);
    double width() const { return 0.5 * spacing; } ///< m, of the half bay
};

/// Throws InputError for settings that do not fit together.
void check_tie_bed(const TieBed& bed);

/// The simulation of a bed with its rocks still parked. Throws InputError.
Simulation make_tie_bed(const TieBed& bed, std::uint64_t seed, unsigned threads);

/// A test of a bed: its void contaminant index (%), and whether the tie has a shoulder.
struct TieTest {
    double vci = 0;
    bool with_shoulder = true;
};

/// How far a test has come; State.
struct TieState {
    static constexpr auto name = "tie_test";
    static constexpr bool is_state = true;
    double steps = 0;          ///< since the plate was lifted
    double start_y = 0, z = 0; ///< m, position of the tie when the push begins
    double pushed = 0;         ///< m, displacement of the end of the spring that pushes
    void save(Archive& archive) const {
        put_fields(archive, "tie_test", std::tie(steps, start_y, z, pushed));
    }
    void load(const Archive& archive) {
        get_fields(archive, "tie_test", std::tie(steps, start_y, z, pushed));
    }
};

/// Fills the voids of a made bed with fines; with `fill` false only the fields are added, for a
/// checkpoint to be loaded.
void add_fines(Simulation& simulation, const TieBed& bed, const TieTest& test, std::uint64_t seed,
               bool fill);

/// A sample of a push. Forces are those that resist it, on a whole tie.
struct PushSample {
    double displacement, force, base_force, crib_force, end_force, other_force, support, lift,
        unbalanced_ratio;
    static constexpr auto columns() {
        using S = PushSample;
        return std::array{Sampled{&S::displacement, "displacement", "m"},
                          Sampled{&S::force, "force", "N"},
                          Sampled{&S::base_force, "base_force", "N"},
                          Sampled{&S::crib_force, "crib_force", "N"},
                          Sampled{&S::end_force, "end_force", "N"},
                          Sampled{&S::other_force, "other_force", "N"},
                          Sampled{&S::support, "support", "N"},
                          Sampled{&S::lift, "lift", "m"},
                          Sampled{&S::unbalanced_ratio, "unbalanced_ratio", ""}};
    }
};

/// Phases of a test on a made bed: the plate is lifted, rocks beyond the profile of the bed are
/// taken away and the bed comes to rest; then the tie is pushed. `curve` gets a sample at the
/// beginning and after each interval of displacement; `frame` is called at each tenth of it. Both
/// must outlive the phases.
std::vector<Phase> push_phases(const TieBed& bed, const TieTest& test, SeriesOf<PushSample>& curve,
                               const std::function<void(const World&)>& frame);

void TieBed::declare_options(auto& option) {
    option.group("Tie and bed");
    option("tie_length", tie_length, "m", "Length of the tie.", within(0.3, 4));
    option("tie_width", tie_width, "m", "Width of the tie.", within(0.05, 0.5));
    option("tie_height", tie_height, "m", "Height of the tie, to which cribs are filled.",
           within(0.05, 0.5));
    option("tie_mass", tie_mass, "kg", "Mass of the tie.", within(10, 2000));
    option("spacing", spacing, "m", "Distance of ties, of which half is modelled.", within(0.3, 2));
    option("base", base, "m", "Depth of the ballast below the tie.", within(0.05, 1));
    option("shoulder", shoulder, "m", "Width of the shoulder at its top.", within(0.05, 1));
    option("slope", slope, "", "Run over rise of the slope beyond the shoulder.", within(1, 4));
    option("grading", rocks.grading, "", help_grading);
    option("clumps", rocks.clumps, "", help_clumps);
    option("rock_scale", rocks.scale, "", "Factor on all sizes of rocks.", within(0.1, 4));
    option("smallest_rock", rocks.smallest, "m",
           "Sieve size below which the grading is truncated, before scaling.", within(0, 0.06));
    option("material", material, "",
           "Rock of the ballast: granite, limestone (assets/materials) or the path of a file. The "
           "tie and the floor have its friction.");
    option("porosity", porosity, "", "Porosity of the ballast below the tie and the crib.",
           within(0.25, 0.6));
    option("porosity_tolerance", porosity_tolerance, "",
           "Accepted difference of the porosity where friction cannot be reduced further.",
           within(1e-4, 0.1));
    option("preparation_pressure", preparation_pressure, "Pa",
           "Pressure of plate and tie while the bed is made.", within(1e3, 1e6));
    option.group("Test");
    option("vci", vci, "%", "Void contaminant index or indices. Each is tested on the same bed.",
           within(0, 150));
    option("shoulders", shoulders, "",
           "Tests with shoulder, without it (no ballast above the lower side of the tie beyond its "
           "end), or both on the same bed.",
           {"both", "with", "without"});
    option("displacement", displacement, "m", "Displacement of the tie at the end.",
           within(1e-4, 0.2));
    option("speed", speed, "m/s", "Speed of the push.", within(1e-4, 1));
    option("interval", interval, "m", "Displacement between samples.", within(1e-6, 0.01));
    option("tolerance", tolerance, "",
           "Unbalanced force ratio at which the bed is at rest before the push.",
           within(1e-6, 0.1));
    option("safety", safety, "", "Time step over the stable step for which masses are scaled.",
           within(0.05, 0.8));
    fouling.declare_options(option);
    option.group("Files");
    written.declare_options(option, write_of_clumps);
}

} // namespace bris
