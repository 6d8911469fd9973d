#pragma once

#include "engine/assets.hpp"
#include "scenarios/rocks/clump_library.hpp"
#include "scenarios/triaxial/triaxial.hpp"
#include "scenarios/triaxial/triaxial_scene.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <filesystem>

namespace bris::testing {

inline constexpr double pressure = 110e3; // Pa

/// A scene of 160 rocks: too few to represent ballast, enough for every mechanism of the test.
inline TriaxialScene small_scene(const SpecimenSettings& specimen = {}) {
    const std::filesystem::path assets = assets_folder();
    TriaxialScene s;
    s.clumps = read_clumps(assets / "clumps");
    std::erase_if(s.clumps, [](const Clump& c) { return c.name == "cube"; });
    s.sample = sample_rocks(read_grading(assets / "gradings" / "arema_4.csv"), s.clumps, 150, 3);
    s.specimen = specimen;
    s.specimen.seed = 3;
    s.smart_rocks = {scaled(s.clumps[0], 0.02)};
    s.specimen.radius =
        radius_for(s.sample.solid_volume + 10 * s.smart_rocks[0].volume, 0.42, s.specimen.sectors);
    s.specimen.height = 4 * s.specimen.radius;
    s.poses =
        smart_rock_poses({s.specimen.radius, s.specimen.height, s.smart_rocks[0].bounding_radius},
                         s.specimen.seed, 10);
    return s;
}

inline TriaxialSettings short_test() {
    TriaxialSettings settings;
    settings.confining_pressure = pressure;
    settings.porosity = 0.38; // reached quickly; density does not matter here
    settings.porosity_tolerance = 0.04;
    settings.final_axial_strain = 0.002;
    settings.tolerance = 3e-4;
    return settings;
}

/// A specimen before the confining pressure is applied.
inline Archive prepared(const TriaxialScene& scene) {
    Simulation simulation = make_simulation(scene, 1);
    TriaxialTest test(simulation, short_test());
    while (test.state().phase < TriaxialPhase::consolidate) REQUIRE(test.advance());
    return simulation.snapshot();
}

} // namespace bris::testing
