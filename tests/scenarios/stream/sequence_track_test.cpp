#include "engine/errors.hpp"
#include "scenarios/stream/sensor_payload.hpp"
#include "scenarios/stream/sequence_track.hpp"

#include <doctest/doctest.h>

#include <limits>

using namespace bris;
using enum SequenceTrack::Verdict;

namespace {

/// Ten samples at 100 Hz, whose clock showed `start` at sequence number 0.
SequenceTrack::Message message(std::uint32_t sequence, double start = 0) {
    return {sequence, 10, start + 0.01 * sequence, 0.01, sequence};
}

} // namespace

TEST_SUITE("stream/sequence_track") {
    TEST_CASE("gaps are counted, and filled by messages that come late") {
        SequenceTrack track;
        CHECK(track.take(message(100)) == accepted);
        CHECK(track.take(message(140)) == accepted);
        CHECK(track.counters().missing == 30);
        CHECK(track.take(message(120)) == late);
        CHECK(track.counters().missing == 20);
        CHECK(track.take(message(120)) == duplicate);
        CHECK(track.take(message(110)) == late);
        CHECK(track.take(message(130)) == late);
        CHECK(track.counters().missing == 0);
        CHECK(track.counters().gaps == 1);
        CHECK(track.counters().samples == 50);
        SequenceTrack::Message other = message(140);
        other.hash = 1;
        CHECK(track.take(other) == contradiction);
    }

    TEST_CASE("sequence numbers wrap around") {
        SequenceTrack track;
        const double start = -0.01 * 4294967290.0;
        SequenceTrack::Message m = message(0xfffffffau - 0u, start);
        CHECK(track.take(m) == accepted);
        m.sequence += 10; // now 4
        m.time += 0.1;
        CHECK(track.take(m) == accepted);
        CHECK(track.counters().missing == 0);
    }

    TEST_CASE("a sensor that starts anew is believed at the third message, and none is lost") {
        SequenceTrack track;
        for (std::uint32_t k = 0; k < 5; ++k) (void)track.take(message(1000 + 10 * k));
        CHECK(track.take(message(0, 500)) == held_anew);
        CHECK(track.take(message(10, 500)) == held);
        CHECK(track.take(message(20, 500)) == adopted);
        CHECK(track.take(message(30, 500)) == accepted);
        CHECK(track.counters().restarts == 1);
    }

    TEST_CASE("one message with a clock that jumps is left out") {
        SequenceTrack track;
        (void)track.take(message(0, 0));
        CHECK(track.take(message(10, 1e9)) == held_anew);
        CHECK(track.take(message(10, -1e9)) == held_anew);
        CHECK(track.take(message(20, 0)) == accepted);
        CHECK(track.counters().missing == 10);
        CHECK(track.counters().forgotten == 1);
    }

    TEST_CASE("two sensors with one id are recognised, and the first is used") {
        SequenceTrack track;
        unsigned rivals = 0, taken = 0;
        for (std::uint32_t k = 0; k < 20; ++k) {
            taken += static_cast<unsigned>(track.take(message(5000 + 10 * k)) == accepted);
            rivals += static_cast<unsigned>(track.take(message(10 * k, 7000)) == rival);
        }
        CHECK(taken == 20);
        CHECK(rivals == 18);
        CHECK(track.counters().restarts == 0);

        unsigned adoptions = 0; // the first one falls silent
        for (std::uint32_t k = 20; k < 140; ++k)
            adoptions += static_cast<unsigned>(track.take(message(10 * k, 7000)) == adopted);
        CHECK(adoptions == 1);
        CHECK(track.counters().restarts == 1);
    }
}

TEST_SUITE("stream/sensor_payload") {
    TEST_CASE("a payload comes back as it was sent") {
        SensorPayload p{.channels = 0x11, .sequence = 4000000000u, .time = -3.25, .interval = 0.5f};
        p.numbers = {1, 2, 3, 4, 5, 6, 7, 8, std::numeric_limits<float>::quiet_NaN(), 10, 11, 12};
        const SensorPayload q = parse_sensor_payload(bytes_of(p));
        CHECK(q.samples() == 2);
        CHECK(q.sequence == p.sequence);
        CHECK(q.time == p.time);
        const auto lines = stream_lines(3, q);
        REQUIRE(lines.size() == 2);
        CHECK(lines[0] == "{\"t\": -3.25, \"id\": 3, \"seq\": 4000000000, \"ax\": 1, \"ay\": 2, "
                          "\"az\": 3, \"ux\": 4, \"uy\": 5, \"uz\": 6}");
        CHECK(lines[1] == "{\"t\": -2.75, \"id\": 3, \"seq\": 4000000001, \"ax\": 7, \"ay\": 8, "
                          "\"ux\": 10, \"uy\": 11, \"uz\": 12}");
    }

    TEST_CASE("a header that lies is refused") {
        SensorPayload p{.channels = 1, .sequence = 1, .time = 1, .interval = 0.1f};
        p.numbers = {1, 2, 3};
        const std::string good = bytes_of(p);
        const auto changed = [&](std::size_t place, char value) {
            std::string bad = good;
            bad[place] = value;
            return bad;
        };
        CHECK_NOTHROW(parse_sensor_payload(good));
        CHECK_THROWS_AS(parse_sensor_payload(""), InputError);
        CHECK_THROWS_AS(parse_sensor_payload(good.substr(0, 19)), InputError);
        CHECK_THROWS_AS(parse_sensor_payload(good + "x"), InputError);
        CHECK_THROWS_AS(parse_sensor_payload(changed(0, 2)), InputError); // version
        CHECK_THROWS_AS(parse_sensor_payload(changed(1, 0)), InputError); // channels
        CHECK_THROWS_AS(parse_sensor_payload(changed(2, 2)), InputError); // samples
        CHECK_THROWS_AS(parse_sensor_payload(changed(3, 127)), InputError);
        CHECK_THROWS_AS(parse_sensor_payload(changed(15, 127)), InputError); // time
        CHECK_THROWS_AS(parse_sensor_payload(changed(19, -65)), InputError); // interval
    }
}
