#pragma once

#include "engine/options.hpp"
#include "engine/run.hpp"
#include "scenarios/library/specimen_library.hpp"
#include "scenarios/triaxial/triaxial_scene.hpp"

#include <cstdint>
#include <filesystem>

namespace bris {

/// The specimens of a library: how many, and the ranges of their parameters.
struct LibraryDesign {
    unsigned specimens = 80;
    double lowest_friction = 0.4, highest_friction = 1;
    double lowest_stiffness = 0.4, highest_stiffness = 1.6;
    double lowest_porosity = 0.36, highest_porosity = 0.42;
    double strain_step = 1e-3;
    unsigned packings = 4;

    void declare_options(auto& option);
};

/// One point of a design.
struct DesignPoint {
    RockParameters rocks;
    double porosity;    ///< of the core
    std::uint64_t seed; ///< of the packing
};

/// Point `number` of a design (1 ... specimens): friction uniform in its logarithm, stiffness and
/// porosity uniform, along a low-discrepancy sequence that `seed` shifts. `attempt`: number of
/// packings of this point that failed before. Every point, attempt and `seed` up to 10^6 has a seed
/// of the packing of its own, above 10^9, and so apart from the small seeds that users choose.
DesignPoint design_point(const LibraryDesign& design, std::uint64_t number, std::uint64_t attempt,
                         std::uint64_t seed);

/// Throws InputError, naming the option, if a range is empty, or if the strains of the library are
/// not at the ends of stages.
void check_design(const LibraryDesign& design, const Triaxial& test);

/// A library without specimens, for a design and a test.
SpecimenLibrary empty_library(const LibraryDesign& design, const Triaxial& test,
                              const Common& common);

/// Makes and tests all specimens of a design that the library does not have, `common.threads` at a
/// time. Each is added to the library and saved in `file` as soon as it is done. A packing that
/// fails (SimulationError) is replaced by another one of the same parameters; after
/// `design.packings` of them the point is given up. The results do not depend on the number of
/// threads or on interruptions. Throws Interrupted, OutputError, InputError.
void complete_library(SpecimenLibrary& library, const std::filesystem::path& file,
                      const LibraryDesign& design, const Triaxial& test, const Common& common);

void LibraryDesign::declare_options(auto& option) {
    option.group("Library");
    option("specimens", specimens, "", "Number of specimens of the library.", within(1, 1e5));
    option("lowest_friction", lowest_friction, "",
           "Lowest friction coefficient between rocks. Friction is uniform in its logarithm.",
           within(0.01, 100));
    option("highest_friction", highest_friction, "", "Highest friction coefficient.",
           within(0.01, 100));
    option("lowest_stiffness", lowest_stiffness, "",
           "Lowest contact stiffness of rocks, relative to --clump-stiffness.", within(1e-3, 1e3));
    option("highest_stiffness", highest_stiffness, "",
           "Highest contact stiffness of rocks, relative to --clump-stiffness.", within(1e-3, 1e3));
    option("lowest_porosity", lowest_porosity, "",
           "Lowest porosity of the core at the start of shearing.", within(0.2, 0.6));
    option("highest_porosity", highest_porosity, "",
           "Highest porosity of the core at the start of shearing.", within(0.2, 0.6));
    option("strain_step", strain_step, "",
           "Axial strain between the values of curves that the library keeps.", within(1e-5, 0.01));
    option("packings", packings, "",
           "Number of packings that are tried for each specimen before it is given up.",
           within(1, 9));
}

} // namespace bris
