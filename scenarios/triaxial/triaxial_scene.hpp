#pragma once

#include "engine/scenario.hpp"
#include "engine/simulation.hpp"
#include "scenarios/rocks/own_rocks.hpp"
#include "scenarios/sensors/recording.hpp"
#include "scenarios/specimens/specimen.hpp"
#include "scenarios/triaxial/triaxial.hpp"

#include <filesystem>
#include <string>
#include <vector>

namespace bris {

/// A triaxial test as described by the options.
struct Triaxial {
    unsigned bodies = 400;
    std::vector<double> confining_pressure{55e3, 110e3, 165e3};
    std::string grading = "arema_4";
    std::filesystem::path clumps = {};
    SpecimenSettings specimen = {};
    TriaxialSettings test;
    double least_diameter = 2.7; ///< of the mould, over the size of its largest rock
    std::string sensor_shape = "rock_01";
    std::filesystem::path sensor_poses = {};
    /// Poses of the sensor rocks by a folder of recordings, unless sensor_poses gives others.
    std::vector<GivenPose> recorded_poses = {};
    unsigned frame_stages = 10;

    /// The options that the size of the specimen follows from.
    void declare_mould_options(auto& option) {
        option("bodies", bodies, "", "Number of rocks, sensor rocks included.", within(20, 1e6));
        option("grading", grading, "", help_grading);
        option("clumps", clumps, "", help_clumps);
        option(
            "preparation", test.preparation, "",
            "Density of the specimen, unless --porosity gives it: laboratory, a core porosity of "
            "0.38, with a response like that of ballast in laboratories; report, 0.32, that of "
            "the SmartRock report, taken as that of the core.",
            {"laboratory", "report"});
        option("porosity", test.porosity, "",
               "Porosity of the core (0.6 of the radius, middle half of the height) at the start "
               "of shearing; 0: that of --preparation.",
               within(0, 0.6));
        option(
            "sensor_shape", sensor_shape, "",
            "Shape of the sensor rocks: a clump of --clumps or of assets/clumps or the path of a "
            "file, or several that the sensor rocks take in turn, as "
            "rock_01,rock_02,rock_03,cube.");
    }
    void declare_options(auto& option) {
        option.group("Test");
        option("confining_pressure", confining_pressure, "Pa",
               "Confining pressure, or several, each tested on the same specimen.",
               above(0, 1e9).usually(1e3, 1e7));
        option("stage_strain", test.stage_strain, "", "Axial strain of a stage.",
               within(1e-6, 1e-2));
        option("final_axial_strain", test.final_axial_strain, "",
               "Axial strain at which the test ends.", within(1e-4, 0.3));
        option("tolerance", test.tolerance, "",
               "Unbalanced force ratio below which the specimen is in equilibrium.",
               within(1e-8, 0.1));
        option("pressure_tolerance", test.pressure_tolerance, "",
               "Largest relative error of the pressure of each ring at the end of a stage.",
               within(1e-6, 0.1));
        option("gravity", test.gravity, "",
               "Turn gravity on when consolidation begins. Otherwise there is none, so that the "
               "pressure is the same at all heights (the weight of 400 rocks is 5 kPa at the "
               "bottom).");
        option.group("Specimen");
        declare_mould_options(option);
        option("least_diameter", least_diameter, "",
               "Smallest diameter of the specimen over the size of its largest rock; fewer rocks "
               "are refused. Laboratories ask for 6.",
               within(1, 100));
        option("porosity_tolerance", test.porosity_tolerance, "",
               "Largest difference from the porosity at which it counts as reached.",
               within(1e-4, 0.1));
        option("preparation_friction", test.preparation_friction, "",
               "Friction coefficient of the rocks while the specimen is made; below 0: --friction.",
               within(-1, 100));
        option("taps", test.taps, "",
               "Smallest number of taps with which the preparation ends; 0: none. Taps replace the "
               "contacts that form during compression and make the specimen softer.",
               within(0, 100));
        option("preparation_pressure", test.preparation_pressure, "Pa",
               "Pressure of the top platen while the specimen is made; 0: follows from the contact "
               "stiffness.",
               within(0, 1e9).usually(1e3, 1e8));
        option("trial_pressure", test.trial_pressure, "Pa",
               "Pressure from all sides under which the porosity of the prepared specimen is "
               "checked on a copy; while it is missed, the specimen is prepared again.",
               above(0, 1e9).usually(1e3, 1e7));
        option("longest_preparation", test.longest_preparation, "",
               "Number of steps after which the preparation fails if the porosity is not reached.",
               within(1, 1e9));
        option("sensor_poses", sensor_poses, "",
               "CSV file with the poses of the sensor rocks. Without it there are ten at three "
               "heights, or 7 or 3 in a small specimen.");
        option("membrane", specimen.membrane, "",
               "What holds the specimen while it is tested: rings of rigid elements, of which each "
               "moves by its own servo, or a sleeve of latex under the pressure of the cell. The "
               "specimen is prepared within rings, whatever it is.");
        option("latex_thickness", specimen.latex.thickness, "m", "Thickness of the sleeve.",
               above(0, 0.1).usually(2e-4, 1e-2));
        option("latex_modulus", specimen.latex.young_modulus, "Pa",
               "Young's modulus of the sleeve.", above(0, 1e10).usually(5e5, 1e7));
        option("latex_wrinkles", specimen.latex.wrinkles, "",
               "The sleeve folds instead of taking compression.");
        option("latex_edge", specimen.latex.edge, "",
               "Length of the edges of its triangles over the size of a sensor rock.",
               within(0.05, 2));
        option("servo_per_element", specimen.per_element, "",
               "Control the pressure of each membrane element separately instead of that of each "
               "ring.");
        option.group("Material");
        option("density", specimen.density, "kg/m3", "Density of the rocks.",
               above(0, 1e6).usually(500, 1e4));
        option("sensor_density", specimen.sensor_density, "kg/m3",
               "Density of the sensor rocks; 0: that of the rocks.",
               within(0, 1e6).usually(100, 1e4));
        option("friction", test.friction, "",
               "Coulomb friction coefficient between rocks and between rock and platen.",
               within(0, 100).usually(0, 2));
        option("sensor_friction", specimen.sensor_friction, "",
               "Coulomb friction coefficient of the shells of the sensor rocks; between a shell "
               "and a rock the lower coefficient acts. Below 0: that of the rocks.",
               within(-1, 100));
        option("platen_friction", specimen.platen_friction, "",
               "Coulomb friction coefficient of the platens. Below 0: that of the rocks.",
               within(-1, 100));
        option("clump_stiffness", specimen.clump_stiffness, "N/m",
               "Normal and shear contact stiffness of a rock, as one of two partners.",
               above(0, 1e15).usually(1e5, 1e11));
        option("wall_stiffness", specimen.wall_stiffness, "N/m",
               "Contact stiffness of platens and membrane, as one of two partners.",
               above(0, 1e15).usually(1e5, 1e12));
        option("law", specimen.law, "",
               "Contact law from consolidation on. The specimen is prepared with linear contacts, "
               "whatever it is.");
        option("young_modulus", specimen.young_modulus, "Pa",
               "Young's modulus of rocks, platens and membrane for Hertz laws.",
               above(0, 1e13).usually(1e8, 5e11));
        option("poisson_ratio", specimen.poisson_ratio, "",
               "Poisson ratio of rocks, platens and membrane for Hertz laws.", within(0, 0.5));
        specimen.edges.declare_options(option);
        option("damping", test.damping, "", "Coefficient of local damping.", within(0, 0.95));
        option.group("Numerics");
        option("safety", test.safety, "", "Time step as a fraction of the stable step.",
               within(0.05, 1));
        option("mass_scaling", test.mass_scaling, "",
               "Scale the masses from consolidation on; otherwise they are the true ones.");
        option("move_steps", test.move_steps, "",
               "Number of steps over which the platen moves in a stage.", within(1, 1e6));
        option("frame_stages", frame_stages, "", "Number of stages between frames of the run file.",
               within(1, 1e6));
    }
};

/// The parts of a specimen; the same for every confining pressure.
struct TriaxialScene {
    std::vector<Clump> clumps;
    std::vector<Clump> smart_rocks; ///< shapes of the sensor rocks, taken in turn
    Grading grading;
    RockSample sample;
    SpecimenSettings specimen = {};
    std::vector<SmartRockPose> poses;
};

/// Throws InputError, naming the option, if settings contradict each other: a final strain that is
/// not a whole number of stages, a pressure given twice, a number of steps that is not a multiple
/// of the parts of a stage's ramp.
void check_test(const Triaxial& settings);

/// Chooses the rocks, the size of the mould and the sensor rocks. Throws InputError.
TriaxialScene make_scene(const Triaxial& settings, std::uint64_t seed);

/// Throws InputError if the rocks of `worlds` simulations at once, and the motions of all rocks in
/// `stages_kept` stages, do not fit into `limit` bytes of memory; 0: no limit.
void require_memory_for(const Triaxial& settings, unsigned worlds, std::uint64_t limit,
                        double stages_kept = 0);

/// The scene while its specimen is made: with linear contacts, because rocks that grow overlap so
/// deeply that Hertz contacts explode, and within rings, which are its mould.
TriaxialScene in_mould(TriaxialScene scene);

/// The simulation of a scene with its neighbour lists, energy budget and list of steps, before
/// filling begins.
Simulation make_simulation(const TriaxialScene& scene, unsigned threads);

/// Restores a prepared specimen, whose contacts are linear, in a simulation of its scene. Hertz
/// contacts begin without tangential force.
void restore_specimen(Simulation& simulation, const TriaxialScene& scene, const Archive& specimen);

/// Refuses --friction where the model's friction is estimated. Throws InputError.
void refuse_friction(const Triaxial& settings);

/// The test with the poses of the sensor rocks that a folder of recordings gives. Throws InputError
/// and OutputError.
Triaxial with_recorded_poses(Triaxial test, const std::filesystem::path& recordings);

/// Why the model of the test cannot take its recorded_poses: a text for each; empty: it can.
std::vector<std::string> problems_of_recorded_poses(const Triaxial& test, std::uint64_t seed);

/// Throws InputError unless there are as many descriptions of sensors as sensor rocks in the model.
void require_sensor_for_each(const std::vector<SmartRockPose>& poses,
                             const std::vector<SensorInfo>& infos);

/// The text that --explain prints for a triaxial test.
std::string explain_triaxial(const Triaxial& settings, const Common& common);

} // namespace bris
