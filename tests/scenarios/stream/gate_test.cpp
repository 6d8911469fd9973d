#include "scenarios/stream/gate.hpp"

#include <doctest/doctest.h>
#include <fmt/format.h>

#include <string>

using namespace bris;

TEST_SUITE("stream/gate") {
    TEST_CASE("a record of a time that was used is a copy only if all of its numbers are the same, "
              "with their signs") {
        SensorInfo info;
        info.id = 1;
        info.sampling_rate = 10;
        Gate gate({info});
        RecordParser parser;
        std::uint64_t line = 0;
        const auto take = [&](double t, const std::string& force) {
            const auto text = fmt::format("{{\"id\": 1, \"t\": {}, {}}}", t, force);
            (void)gate.take(*parser.parse({++line, text, Instant{}, true}));
        };
        for (int k = 0; k < 20; ++k) take(k / 10.0, R"("ax": 1, "ay": 2, "az": 9.8)");
        take(1.5, R"("ax": 1, "ay": 2, "az": 9.8)");
        CHECK(gate.accounts().count(LeftOut::again) == 1);
        take(1.5, R"("ax": -1, "ay": -2, "az": 9.8)");
        gate.end();
        CHECK(gate.accounts().count(LeftOut::again) == 1);
        CHECK(gate.accounts().count(LeftOut::contradiction) == 1);
    }
}
