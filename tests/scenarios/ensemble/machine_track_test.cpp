#include "scenarios/ensemble/machine_track.hpp"

#include <doctest/doctest.h>
#include <fmt/format.h>

#include <cmath>

using namespace bris;

namespace {

StreamRecord record(double strain, double t = no_arrival, double arrival = no_arrival) {
    const std::string text = std::isnan(t)
                                 ? fmt::format(R"({{"axial_strain": {}}})", strain)
                                 : fmt::format(R"({{"axial_strain": {}, "t": {}}})", strain, t);
    return *RecordParser().parse({1, text, this_instant(), true, arrival});
}

constexpr double step = 1e-4, seconds = 1.2; // of the machine, from record to record

/// A machine that has sent so many records at its rate.
MachineTrack started(int records, bool has_t = true, bool arrives = false) {
    MachineTrack track;
    for (int k = 0; k < records; ++k)
        CHECK(track
                  .take(record(step * k, has_t ? seconds * k : no_arrival,
                               arrives ? 1e9 + seconds * k : no_arrival))
                  .used.size() == 1);
    return track;
}

} // namespace

TEST_SUITE("ensemble/machine_track") {
    TEST_CASE("copies of one impossible record change nothing, however many there are") {
        for (const int before : {1, 4, 40})
            for (const int copies : {1, 2, 3, 100})
                for (const bool has_t : {true, false}) {
                    MachineTrack track = started(before, has_t);
                    for (int k = 0; k < copies; ++k) {
                        const auto decision = track.take(record(0.5, has_t ? 80 : no_arrival));
                        CHECK(decision.used.empty());
                        CHECK(decision.is_ahead);
                    }
                    const auto next =
                        track.take(record(step * before, has_t ? seconds * before : no_arrival));
                    CHECK(next.used.size() == 1);
                    CHECK_FALSE(next.is_gap);
                    CHECK(track.reached() == step * before);
                }
    }

    TEST_CASE("different records that agree, beyond what the machine can travel, are left out") {
        for (const bool by_arrival : {false, true}) {
            MachineTrack track = started(20, !by_arrival, by_arrival);
            for (int k = 0; k < 50; ++k) {
                const double time = 19 * seconds + 0.01 * (k + 1);
                CHECK(track
                          .take(by_arrival ? record(0.5 + step * k, no_arrival, 1e9 + time)
                                           : record(0.5 + step * k, time))
                          .is_ahead);
            }
            CHECK(track.reached() == step * 19);
        }
    }

    TEST_CASE("after an outage the test continues with the third record, if the machine can have "
              "travelled so far") {
        for (const int lost : {40, 1000}) {
            MachineTrack track = started(20);
            for (int k = 0; k < 2; ++k)
                CHECK(track.take(record(step * (20 + lost + k), seconds * (20 + lost + k)))
                          .used.empty());
            const int third = 20 + lost + 2;
            const auto decision = track.take(record(step * third, seconds * third));
            REQUIRE(decision.used.size() == 3);
            CHECK(decision.is_gap);
            CHECK(decision.used.front().number("axial_strain") == step * (20 + lost));
            CHECK(track.reached() == step * third);
        }
    }

    TEST_CASE("one record does not carry the test ahead of the machine's pace, within 0.2 % too") {
        MachineTrack track = started(20);
        CHECK(track.take(record(step * 19 + 1.9e-3, seconds * 20)).is_ahead);
        CHECK(track.take(record(step * 20, seconds * 20)).used.size() == 1);
        CHECK(track.reached() == step * 20);
    }

    TEST_CASE("a machine that goes ten times as fast from some time on is followed") {
        MachineTrack track = started(20);
        std::size_t used = 0;
        for (int k = 1; k <= 60; ++k)
            used += track.take(record(step * (19 + 10 * k), seconds * (19 + k))).used.size();
        CHECK(used >= 58);
    }

    TEST_CASE("a wrong time stops nothing, and one that began again neither") {
        MachineTrack track = started(20);
        CHECK(track.take(record(step * 20, 1e9)).used.size() == 1);
        for (int k = 21; k < 40; ++k)
            CHECK(track.take(record(step * k, seconds * (k < 30 ? k : k - 30))).used.size() == 1);
        for (int k = 100; k < 103; ++k) (void)track.take(record(step * k, 0.1 * (k - 99)));
        CHECK(track.reached() == step * 102); // its clock began again: agreement is enough
    }
}
