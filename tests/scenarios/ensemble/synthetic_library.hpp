#pragma once

#include "engine/random.hpp"
#include "scenarios/library/specimen_library.hpp"

#include <cmath>

namespace bris::testing {

/// A library of curves in closed form: ln q and volume depend on friction, and on two numbers of
/// the packing, one of which acts from the beginning and one only beyond 2 % of strain.
inline SpecimenLibrary synthetic_library(std::size_t specimens, std::uint64_t seed) {
    SpecimenLibrary library;
    library.settings = {{"bodies", "400"}, {"grading", "arema_4"}};
    library.pressures = {55e3, 110e3};
    library.rings = 2;
    library.sensors = 1;
    for (std::uint64_t k = 1; k <= specimens; ++k) {
        Random random(seed, k);
        LibrarySpecimen s{
            .number = k,
            .seed = 1000 * seed + k,
            .redrawn = 0,
            .rocks = {std::exp(random.uniform(std::log(0.4), 0)), random.uniform(0.4, 1.6)},
            .porosity = random.uniform(0.36, 0.42),
            .core_porosity = 0.39,
            .diameter = 0.15,
            .tests = {}};
        const double early = 0.1 * random.normal(), late = 0.1 * random.normal();
        for (const double pressure : library.pressures) {
            LibraryTest& test = s.tests.emplace_back();
            for (std::size_t i = 0; i < library.axis.count; ++i) {
                const double e = library.axis.strain(i);
                const double ln_q = std::log(4 * pressure * (1 - std::exp(-e / 0.01))) +
                                    std::log(s.rocks.friction / 0.6) + early +
                                    (e > 0.02 ? late : 0);
                test.q.push_back(static_cast<float>(std::exp(ln_q)));
                test.smoothed_q.push_back(test.q.back());
                test.volume.push_back(static_cast<float>(-e * s.rocks.friction * (1 + early)));
                for (const double part : {1.0, 2.0})
                    test.rings.push_back(static_cast<float>(part * e * s.rocks.friction));
            }
            test.sensors.assign(library.axis.coarse_count() * 6, 0.001F * static_cast<float>(k));
            test.field.assign(library.axis.coarse_count() * 2 * FieldCells::count, 0.5F);
        }
        library.add(std::move(s));
    }
    return library;
}

} // namespace bris::testing
