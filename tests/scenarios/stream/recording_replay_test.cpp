#include "engine/errors.hpp"
#include "scenarios/stream/recording_replay.hpp"

#include <doctest/doctest.h>

using namespace bris;

TEST_SUITE("stream/recording_replay") {
    TEST_CASE("a configuration is read, and a wrong one is refused by name") {
        const NodeConfiguration c = parse_configuration(
            R"({"revision": 7, "rate_hz": 50, "strategy": "triggered", "threshold": 2.5})");
        CHECK(c.revision == 7);
        CHECK(c.rate_hz == 50);
        CHECK(c.strategy == "triggered");
        CHECK(c.threshold == 2.5);
        for (const char* bad :
             {"", "[]", "{",
              R"({"revision": 1, "rate_hz": 0, "strategy": "continuous", "threshold": 1})",
              R"({"revision": 1, "rate_hz": 1, "strategy": "often", "threshold": 1})",
              R"({"revision": 1, "rate_hz": 1, "strategy": "continuous", "threshold": -1})",
              R"({"revision": 1, "rate_hz": "1", "strategy": "continuous", "threshold": 1})"})
            CHECK_THROWS_AS(parse_configuration(bad), InputError);
    }
}
