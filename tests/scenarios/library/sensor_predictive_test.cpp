#include "engine/errors.hpp"
#include "engine/random.hpp"
#include "scenarios/library/sensor_predictive.hpp"
#include "tests/about.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

using namespace bris;

namespace {

constexpr double scatter = 1e-4; // m, of each component

/// Specimens whose ten sensor rocks move outward by 0.02 m times the dilation, and downward by 2
/// mm, with a normal scatter.
SpecimenLibrary moving(std::size_t specimens) {
    SpecimenLibrary library;
    library.pressures = {1e5};
    library.rings = 1;
    library.sensors = 10;
    for (std::uint64_t k = 1; k <= specimens; ++k) {
        Random random(3, k);
        LibrarySpecimen s;
        s.number = k;
        LibraryTest& test = s.tests.emplace_back();
        const double dilation = random.uniform(0.5, 1.5);
        for (std::size_t i = 0; i < library.axis.count; ++i)
            test.volume.push_back(static_cast<float>(-dilation * library.axis.strain(i)));
        for (std::size_t c = 0; c < library.axis.coarse_count(); ++c)
            for (std::size_t r = 0; r < library.sensors; ++r) {
                const double strain = library.axis.coarse_strain(c);
                for (const double mean : {0.02 * dilation * strain, 0.0, -0.025 * strain})
                    test.sensors.push_back(static_cast<float>(mean + scatter * random.normal()));
                for (int k3 = 0; k3 < 3; ++k3) test.sensors.push_back(0);
            }
        library.add(std::move(s));
    }
    return library;
}

} // namespace

TEST_SUITE("library/sensor_predictive") {
    TEST_CASE("the displacement of a sensor rock is predicted from the volume, and one that no "
              "specimen has had is suspected") {
        const SpecimenLibrary library = moving(60);
        const std::size_t last = library.axis.coarse_count() - 1;
        const SensorPredictive predictive(library, 0, last);
        for (std::size_t s = 0; s < library.sensors; ++s) {
            const Vec3 mean = predictive.mean(s, -0.1); // a dilation of 0.1 / 0.08
            // means of 60 rocks
            CHECK(mean.x() == about(0.02 * 0.1).scale(1).epsilon(6 * scatter / std::sqrt(60)));
            CHECK(mean.z() == about(-0.002).scale(1).epsilon(6 * scatter / std::sqrt(60)));
            // the volume explains the outward displacement but for the scatter
            CHECK(predictive.deviation(s).x() == about(scatter).epsilon(0.35));
            CHECK(predictive.distance(s, {-0.1, mean}) < 0.2);
            CHECK(predictive.distance(s, {-0.1, mean + Vec3(10 * scatter, 0, 0)}) > 1);
            CHECK(predictive.distance(s, {-0.1, Vec3(mean.x(), mean.y(), -mean.z())}) > 1);
            for (const LibrarySpecimen& specimen : library.specimens)
                CHECK(predictive.distance(s, SensorPredictive::motion_in(library, specimen.tests[0],
                                                                         last, s)) <= 1);
        }
        CHECK_THROWS_AS(SensorPredictive(moving(10), 0, last), InputError);
    }

    TEST_CASE(
        "recordings of other specimens are hardly ever suspected, those with a fault are where "
        "it moves them beyond the scatter") {
        const auto scores = score_suspicions(moving(40));
        REQUIRE(scores.size() == 16); // eight faults at two strains
        for (const SuspicionScore& s : scores) {
            CAPTURE(s.fault);
            // one of 400 is the farthest; 40 tests
            if (s.fault == "none") CHECK(s.tests <= 0.1);
            if (s.fault == "times 1000" || s.fault == "z mirrored") CHECK(s.tests > 0.999);
            // in the centre nothing moves sideways
            if (s.fault == "x and y exchanged" && s.strain > 0.07) CHECK(s.beside > 0.9);
        }
        SpecimenLibrary few = moving(40);
        few.sensors = 9;
        CHECK(score_suspicions(few).empty());
    }
}
