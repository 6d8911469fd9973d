#pragma once

#include "engine/scenario.hpp"
#include "engine/simulation.hpp"
#include "scenarios/rocks/grading.hpp"
#include "scenarios/specimens/specimen.hpp"
#include "scenarios/triaxial/triaxial.hpp"

#include <filesystem>
#include <string>
#include <vector>

namespace bris {

/// A triaxial test as a user describes it.
struct Triaxial {
    unsigned bodies = 400;
    std::vector<double> confining_pressure{55e3, 110e3, 165e3};
    std::string grading = "arema_4";
    SpecimenSettings specimen;
    TriaxialSettings test;
    double initial_porosity = 0.37;
    std::string sensor_shape = "rock_01";
    std::filesystem::path sensor_poses;
    unsigned frame_stages = 10;

    void describe(auto& option) {
        option.group("test");
        option("confining_pressure", confining_pressure, "Pa",
               "one or several, each tested on the same specimen", above(0));
        option("stage_strain", test.stage_strain, "", "axial strain of a stage",
               within(1e-6, 1e-2));
        option("final_axial_strain", test.final_axial_strain, "", "at which the test ends",
               within(1e-4, 0.12));
        option("tolerance", test.tolerance, "", "unbalanced force ratio of an equilibrium",
               within(1e-8, 0.1));
        option("pressure_tolerance", test.pressure_tolerance, "",
               "of each ring's pressure at stage ends", within(1e-6, 0.1));
        option("gravity", test.gravity, "",
               "keep weight during the test (a fifth of the lowest pressure)");
        option.group("specimen");
        option("bodies", bodies, "", "rocks, sensor rocks included", within(60, 1e6));
        option("grading", grading, "", "a file of assets/gradings",
               {"arema_24", "arema_25", "arema_3", "arema_4a", "arema_4", "arema_5", "arema_57"});
        option("porosity", test.porosity, "",
               "of the core (0.6 of the radius, middle half of the height)", within(0.2, 0.6));
        option("porosity_tolerance", test.porosity_tolerance, "",
               "within which a porosity counts as reached", within(1e-4, 0.1));
        option("initial_porosity", initial_porosity, "",
               "that sets the size of the mould (a little more below 400 rocks)", within(0.2, 0.7));
        option("compaction_friction", test.compaction_friction, "",
               "between rocks while the specimen is made", at_least(0));
        option("compaction_pressure", test.compaction_pressure, "Pa",
               "of the platen while the specimen is made", above(0));
        option("vibration", test.vibration, "",
               "speed of a rock while the specimen is made: of its bounding radius in a step",
               within(1e-6, 1e-3));
        option("longest_compaction", test.longest_compaction, "",
               "steps, beyond which the porosity is not reached", at_least(1));
        option("sensor_shape", sensor_shape, "",
               "a clump of assets/clumps, or several that the sensor rocks take in turn, as "
               "rock_01,rock_02,rock_03,cube");
        option("sensor_poses", sensor_poses, "",
               "CSV file of the sensor rocks' poses; without it ten between the lifts, or 7 or 3 "
               "in a small specimen");
        option("servo_per_element", specimen.per_element, "",
               "each membrane element on its own, else each ring");
        option.group("material");
        option("density", specimen.density, "kg/m3", "of the rocks", above(0));
        option("sensor_density", specimen.sensor_density, "kg/m3",
               "of the sensor rocks; 0: as the rocks", at_least(0));
        option("friction", test.friction, "", "rock on rock and rock on platen", at_least(0));
        option("sensor_friction", specimen.sensor_friction, "",
               "of the sensor rocks' shells; of a shell and a rock the lower one acts; below 0: as "
               "the rocks",
               at_least(-1));
        option("clump_stiffness", specimen.clump_stiffness, "N/m",
               "normal and shear, of one partner", above(0));
        option("wall_stiffness", specimen.wall_stiffness, "N/m", "of platens and membrane",
               above(0));
        option("damping", test.damping, "", "local damping", within(0, 0.95));
        option.group("numerics");
        option("safety", test.safety, "", "of the stable step in mass scaling", within(0.05, 1));
        option("mass_scaling", test.mass_scaling, "",
               "scaled masses from consolidation on, else true ones");
        option("move_steps", test.move_steps, "", "over which the platen moves in a stage",
               at_least(1));
        option("frame_stages", frame_stages, "", "stages between frames of the run file",
               at_least(1));
    }
};

/// The specimen's parts; the same for every pressure.
struct TriaxialScene {
    std::vector<Clump> clumps;
    std::vector<Clump> smart_rocks; ///< shapes of the sensor rocks, taken in turn
    Grading grading;
    RockSample sample;
    SpecimenSettings specimen;
    std::vector<SmartRockPose> poses;
};

/// Throws InputError, naming the option, where settings do not go together: strains that are no
/// whole number of stages, a pressure twice, steps that do not divide into the parts of a stage's
/// ramp.
void check_test(const Triaxial& settings);

/// Chooses rocks, mould and sensor rocks. Throws InputError.
TriaxialScene make_scene(const Triaxial& settings, std::uint64_t seed);

/// Refuses more rocks than fit in memory, with so many worlds of them at once, and `stages_kept`
/// stages of motions of all rocks; `limit`: bytes, 0 if there is none. Throws InputError.
void require_memory_for(const Triaxial& settings, unsigned worlds, std::uint64_t limit,
                        double stages_kept = 0);

/// The scene with its lists, ledger and steps, before the first rock is poured.
Simulation make_simulation(const TriaxialScene& scene, unsigned threads, bool serial);

/// What --explain prints of a triaxial test.
std::string explain_triaxial(const Triaxial& settings, const Common& common);

} // namespace bris
