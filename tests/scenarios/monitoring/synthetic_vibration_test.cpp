#include "engine/errors.hpp"
#include "scenarios/monitoring/synthetic_vibration.hpp"
#include "scenarios/monitoring/vibration.hpp"
#include "scenarios/sensors/quality_control.hpp"

#include <doctest/doctest.h>

#include <cmath>

using namespace bris;

TEST_SUITE("monitoring/synthetic_vibration") {
    TEST_CASE("synthetic recordings pass quality control and repeat to the bit") {
        const SyntheticVibration settings{.sensors = 3, .duration = 3};
        const Passage one = synthetic_passage(settings, {}, 5, 1, "a"),
                      same = synthetic_passage(settings, {}, 5, 1, "a"),
                      other = synthetic_passage(settings, {}, 5, 2, "a");
        const auto findings = check_recordings(one.recordings, Vec3(0, 0, -9.81));
        for (const Finding& f : findings) CHECK_MESSAGE(f.kind == Finding::Kind::note, f.text);
        for (std::size_t s = 0; s < 3; ++s) {
            CHECK(one.recordings[s].force == same.recordings[s].force);
            CHECK(one.recordings[s].force != other.recordings[s].force);
            CHECK(one.recordings[s].info.attitude().coeffs() ==
                  other.recordings[s].info.attitude().coeffs()); // the same rock
        }
        CHECK_THROWS_AS((void)synthetic_state("muddy"), InputError);
    }

    TEST_CASE("the level is the stated one, and the device adds its noise") {
        // a sensor's level scatters by exp(0.2 N), a passage's by exp(0.1 N): mean over 40 of each
        SyntheticVibration settings{.sensors = 40, .lead = 1, .duration = 4, .pulse = 0};
        settings.sensor_scatter = settings.passage_scatter = 0;
        double squares = 0, n = 0;
        for (unsigned sensor = 1; sensor <= 40; ++sensor) {
            const auto a = synthetic_vertical(settings, {}, 3, 1, sensor);
            for (std::size_t k = 300; k < 900; ++k, ++n) squares += a[k] * a[k]; // 1.5 to 4.5 s
            CHECK(a[50] == 0);                                                   // at rest
        }
        // the envelope's mean square: 1 + 2 x 0.5 m1 + 0.25 m2 with the bells' means over 0.8 s,
        // m1 = 0.06 sqrt(2 pi) / 0.8 and m2 = 0.06 sqrt(pi) / 0.8, neighbours not overlapping
        const double m1 = 0.06 * std::sqrt(2 * pi) / 0.8, m2 = 0.06 * std::sqrt(pi) / 0.8;
        CHECK(squares / n == doctest::Approx(0.25 * (1 + m1 + 0.25 * m2)).epsilon(0.06));
    }
}
