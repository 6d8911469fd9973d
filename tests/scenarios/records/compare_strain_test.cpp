#include "scenarios/records/recorded_test.hpp"
#include "tests/scenarios/sensors/example_recordings.hpp"

#include <doctest/doctest.h>

using namespace bris;
using testing::has;

namespace {

/// The shipped test at 55 kPa after `change`, with quality control.
RecordedTest changed(auto&& change) {
    static const RecordedTest whole = [] {
        const auto folder = assets_folder() / "smartrock";
        return read_recorded_test(folder, 55e3, read_sensor_infos(folder), {});
    }();
    RecordedTest test = whole;
    test.findings.clear();
    change(test);
    examine(test, {});
    return test;
}

std::string reasons(const RecordedTest& test, unsigned sensor) {
    std::string text;
    for (const Finding& f : test.findings)
        if (f.sensor == sensor && f.kind == Finding::Kind::refusal)
            text += f.check + ": " + f.text + "\n";
    return text;
}

void scale(std::vector<double>& values, double factor) {
    for (double& x : values) x *= factor;
}

/// Gives the machine a clock by that of the first sensor.
void give_clock(RecordedTest& test) {
    const Recording& r = test.recordings.front();
    for (std::size_t k = 0; k < r.size(); k += 7)
        test.clock.by_time[r.time[k] - r.info.clock_offset] = r.strain[k];
    for (Recording& each : test.recordings) each.info.clock_offset_deviation = 1;
}

} // namespace

TEST_SUITE("records/compare_strain") {
    TEST_CASE("the recordings as they are shipped are accepted, with and without a clock of the "
              "machine") {
        CHECK(changed([](RecordedTest&) {}).refused() == 0);
        CHECK(changed(give_clock).refused() == 0);
    }

    TEST_CASE("strain in per cent is refused, in all sensors and in one") {
        const RecordedTest all = changed([](RecordedTest& test) {
            for (Recording& r : test.recordings) scale(r.strain, 100);
        });
        CHECK(all.refused() == all.recordings.size());
        CHECK(has(reasons(all, 1), "strain: expected -0.05 to 0.5, which a test can reach"));
        CHECK(has(reasons(all, 1), ": is it in per cent?"));
        const RecordedTest one =
            changed([](RecordedTest& test) { scale(test.recordings[2].strain, 100); });
        CHECK(one.refused() == 1);
        CHECK(has(reasons(one, one.recordings[2].info.id), "is it in per cent?"));
    }

    TEST_CASE("strain in per cent of a test so short that 100 times its strain is possible is "
              "refused by the record of the machine") {
        for (const bool with_clock : {false, true}) {
            CAPTURE(with_clock);
            const RecordedTest test = changed([&](RecordedTest& all) {
                all.curves = MeasuredCurves(all.curves.up_to(4e-3));
                for (Recording& r : all.recordings) {
                    const auto samples = static_cast<std::size_t>(
                        std::ranges::count_if(r.strain, [](double e) { return e <= 4e-3; }));
                    for (auto* numbers : {&r.time, &r.strain}) numbers->resize(samples);
                    for (auto* vectors : {&r.force, &r.rate, &r.displacement})
                        vectors->resize(samples);
                    r.sequence.resize(samples);
                    r.attitude.resize(samples);
                }
                if (with_clock) give_clock(all);
                scale(all.recordings[0].strain, 100);
            });
            CHECK(test.refused() == 1);
            CHECK(has(reasons(test, 1), "is it in per cent?"));
        }
    }

    TEST_CASE("a reversed sign of the strain is refused, and so is a strain that the clock of the "
              "machine contradicts") {
        const RecordedTest reversed =
            changed([](RecordedTest& test) { scale(test.recordings[0].strain, -1); });
        CHECK(reversed.refused() == 1);
        CHECK(has(reasons(reversed, 1), "is its sign reversed?"));
        const RecordedTest third = changed([](RecordedTest& test) {
            give_clock(test);
            scale(test.recordings[4].strain, 1.0 / 3);
        });
        CHECK(third.refused() == 1);
        CHECK(has(
            reasons(third, third.recordings[4].info.id),
            "strain: at the same time the records have 0.3333 times the strain of the machine"));
    }

    TEST_CASE("strain that falls, that is not zero before the test, or that is a hundredth of that "
              "of the machine is refused") {
        const RecordedTest falls = changed([](RecordedTest& test) {
            for (double& e : test.recordings[1].strain) e = 0.08 - e;
        });
        CHECK(falls.refused() == 1);
        CHECK(has(reasons(falls, falls.recordings[1].info.id), "strain: expected 0 before the"));
        const RecordedTest back =
            changed([](RecordedTest& test) { std::ranges::reverse(test.recordings[1].strain); });
        CHECK(back.refused() == 1);
        CHECK(has(reasons(back, back.recordings[1].info.id), "strain: expected strains that grow"));
        const RecordedTest shifted = changed([](RecordedTest& test) {
            for (Recording& r : test.recordings)
                for (double& e : r.strain) e += 0.03;
        });
        CHECK(shifted.refused() == shifted.recordings.size());
        CHECK(has(reasons(shifted, 3), "found 0.03 in the first"));
        const RecordedTest small = changed([](RecordedTest& test) {
            for (Recording& r : test.recordings) {
                scale(r.strain, 0.01);
                r.displacement.clear(); // which would contradict it as well
            }
        });
        CHECK(small.refused() == small.recordings.size());
        CHECK(has(reasons(small, 3), "strain: the records reach 0.0008"));
    }

    TEST_CASE("a machine that fails early, or whose own strain is wrong, refuses no sensor") {
        const RecordedTest early = changed(
            [](RecordedTest& test) { test.curves = MeasuredCurves(test.curves.up_to(3e-3)); });
        CHECK(early.refused() == 0);
        const RecordedTest wrong =
            changed([](RecordedTest& test) { scale(test.curves[quantity::axial_strain], 100); });
        CHECK(wrong.refused() == 0);
    }
}
