#include "scenarios/ensemble/misfit.hpp"
#include "scenarios/library/ring_estimate.hpp"
#include "scenarios/library/ring_profile.hpp"
#include "tests/about.hpp"
#include "tests/scenarios/ensemble/synthetic_library.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

using namespace bris;

namespace {

/// A library of two rings and three sensor rocks, in the centre, whose specimens widen more above
/// or below by an amount that the upward motion of the rocks tells.
SpecimenLibrary leaning_library() {
    SpecimenLibrary library = testing::synthetic_library(40, 1);
    library.sensors = 3;
    for (LibrarySpecimen& s : library.specimens) {
        Random random(7, s.number);
        for (LibraryTest& test : s.tests) {
            const double lean = 0.004 * random.normal();
            for (std::size_t k = 0; k < library.axis.count; ++k) {
                const double radial =
                    std::sqrt((1 - double{test.volume[k]}) / (1 - library.axis.strain(k))) - 1;
                test.rings[2 * k] = static_cast<float>(0.8 * radial + lean);
                test.rings[2 * k + 1] = static_cast<float>(1.2 * radial - lean);
            }
            test.sensors.clear();
            for (std::size_t n = 0; n < library.axis.coarse_count() * library.sensors; ++n)
                for (const double x :
                     {1e-5 * random.normal(), 1e-5 * random.normal(), lean, 0.0, 0.0, 0.0})
                    test.sensors.push_back(static_cast<float>(x));
        }
    }
    return library;
}

/// A specimen of the library at 110 kPa as a recorded test to 4.2 % of strain.
RecordedTest recorded(const SpecimenLibrary& library, const LibraryTest& like) {
    RecordedTest test;
    test.pressure = 110e3;
    const auto first = test.curves.add_row();
    first[quantity::axial_strain] = first[quantity::volumetric_strain] = 0;
    for (std::size_t r = 0; r < 2; ++r) first.part(quantity::ring_radius, r) = 0.1;
    for (std::size_t k = 0; k < 42; ++k) {
        const auto p = test.curves.add_row();
        p[quantity::axial_strain] = library.axis.strain(k);
        p[quantity::volumetric_strain] = double{like.volume[k]};
        for (std::size_t r = 0; r < 2; ++r)
            p.part(quantity::ring_radius, r) = 0.1 * (1 + double{like.rings[2 * k + r]});
    }
    for (unsigned s = 0; s < 3; ++s) {
        Recording recording;
        recording.info.id = s + 1;
        recording.info.placed_z = 0.25 * (s + 1);
        recording.info.x = 1e-3; // outward is x
        test.recordings.push_back(recording);
        SensorTrajectory t;
        for (int k = 1; k <= 42; ++k) {
            t.strain.push_back(1e-3 * k);
            const std::size_t at = 6 * (7 * 3 + s); // the coarse strain 0.04
            t.displacement.push_back(Vec3(double{like.sensors[at]}, double{like.sensors[at + 1]},
                                          double{like.sensors[at + 2]}));
        }
        test.trajectories.push_back(t);
    }
    return test;
}

} // namespace

TEST_SUITE("library/ring_estimate") {
    TEST_CASE("rings are estimated from the volume and the tracked sensor rocks of a recorded test "
              "as from those of a specimen") {
        const SpecimenLibrary library = leaning_library();
        const LibraryTest& like = library.specimens[5].tests[1];
        const ModelOfTest model{library.settings, 0.39, 110e3};
        RecordedTest test = recorded(library, like);
        const RingEstimate rings = estimate_rings(library, model, test, 0.042);
        REQUIRE(rings.not_made.empty());
        CHECK(rings.without_sensors.empty());
        CHECK(rings.strain == about(0.04).epsilon(1e-9)); // the last at which sensors are kept
        const RingProfile profile(library, 1, 7, RingSensors::tracked);
        const RingProfile::Estimate expected = profile.estimate(like);
        for (std::size_t r = 0; r < 2; ++r) {
            const auto k = static_cast<Eigen::Index>(r);
            CHECK(rings.mean[r] == about(expected.mean[k]).epsilon(1e-4));
            CHECK(rings.low[r] < rings.mean[r]);
            CHECK(rings.high[r] - rings.mean[r] == about(rings.mean[r] - rings.low[r]));
        }
        const auto measured = ring_strains(test.curves, rings.strain);
        REQUIRE(measured.size() == 2);
        CHECK(ring_difference(rings.mean, measured) <
              0.5 * ring_difference(rings.scaled_mean, measured));
        CHECK(sentence_of(rings).find("volume and sensor rocks") != std::string::npos);
        CHECK(ring_strains(test.curves, 0.05).empty());
        CHECK(std::isnan(ring_difference(rings.mean, {})));
    }

    TEST_CASE("rings are estimated from the volume alone where sensor rocks are not tracked, or "
              "stand elsewhere, and not at all without a volume") {
        const SpecimenLibrary library = leaning_library();
        const ModelOfTest model{library.settings, 0.39, 110e3};
        const RecordedTest test = recorded(library, library.specimens[5].tests[1]);
        const auto expect_volume_only = [&](const RecordedTest& changed, const char* reason) {
            const RingEstimate rings = estimate_rings(library, model, changed, 0.042);
            REQUIRE(rings.not_made.empty());
            CHECK(rings.without_sensors.find(reason) != std::string::npos);
            const auto measured = ring_strains(changed.curves, 0.04);
            CHECK(ring_difference(rings.mean, measured) >
                  0.8 * ring_difference(rings.scaled_mean, measured));
        };
        RecordedTest refused = test;
        refused.trajectories.clear(); // as where quality control refuses a sensor
        expect_volume_only(refused, "expected 3 accepted sensors, found 0");
        RecordedTest untracked = test;
        for (Vec3& u : untracked.trajectories[1].displacement) u.setConstant(std::nan(""));
        expect_volume_only(untracked, "sensor 2 has no displacement");
        RecordedTest elsewhere = test;
        elsewhere.recordings[2].info.placed_x = 0.7;
        expect_volume_only(elsewhere, "elsewhere");

        RecordedTest mirrored = test; // by ten times what any of the library's rocks moved
        for (Vec3& u : mirrored.trajectories[0].displacement) u = Vec3(0, 0, -0.1);
        expect_volume_only(mirrored, "sensor 1 was displaced as none in the library");

        RecordedTest no_volume = test;
        for (double& v : no_volume.curves[quantity::volumetric_strain]) v = std::nan("");
        CHECK(estimate_rings(library, model, no_volume, 0.042).not_made.find("volumetric") !=
              std::string::npos);
        CHECK(estimate_rings(library, model, test, 0.004).not_made.find("0.005") !=
              std::string::npos);
        CHECK(sentence_of(estimate_rings(library, {library.settings, 0.3, 110e3}, test, 0.042))
                  .find("porosities") != std::string::npos);
    }
}
