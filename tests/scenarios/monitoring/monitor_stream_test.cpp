// The monitor as a program: a stream with one impossible time stamp.
#include "engine/io/whole_file.hpp"
#include "tests/scenarios/faults/process.hpp"
#include "tests/temporary_directory.hpp"

#include <doctest/doctest.h>
#include <fmt/format.h>

#include <string>

using namespace bris;

TEST_SUITE("monitoring/stream") {
    TEST_CASE("one impossible time stamp is counted, all sensors go on, and what was not judged is "
              "said: exit code 5 where it is required") {
        const TemporaryDirectory folder;
        const auto in = [&](const char* name) { return (folder.path() / name).string(); };
        REQUIRE(run_process({"monitor", "--write-example", in("ex"), "--example-state", "clean",
                             "--example-sensors", "4", "--example-passages", "1",
                             "--example-duration", "4", "--out", in("made"), "--quiet"})
                    .code == 0);
        std::string text; // as of loggers that send one sample a second
        for (int k = 0; k < 160; ++k) {
            const double t = k == 40 ? 1e9 : k / 4 + 0.3 * (k % 4);
            text +=
                fmt::format("{{\"id\": {}, \"t\": {}, \"ax\": 0.1, \"ay\": 0.0, \"az\": 9.81}}\n",
                            k % 4 + 1, t);
        }
        write_whole(folder.path() / "stream.nd", text + "{\"end\": 1}\n");
        const auto run = [&](const std::string& required) {
            return run_process({"monitor", "--baseline", in("ex/baseline"), "--stream",
                                in("stream.nd"), "--window", "5", "--late", "0", "--require",
                                required, "--out", in("out"), "--quiet"});
        };
        const Outcome ended = run("nothing");
        CAPTURE(ended.err);
        CHECK(ended.code == 0);
        const std::string page = read_whole(in("out/monitor.html"));
        CHECK(page.find("1 record of an impossible time: line 41: sensor 1") != std::string::npos);
        for (const char* what : {"sensor 1: 39 records passed", "sensor 2: 40 records passed",
                                 "sensor 3: 40 records passed", "sensor 4: 40 records passed"})
            CHECK_MESSAGE(page.find(what) != std::string::npos, page);
        const std::string summary = read_whole(in("out/summary.json"));
        CHECK(summary.find("\"verdict\": \"not enough data\"") != std::string::npos);
        CHECK(summary.find("no train passed") != std::string::npos);
        const Outcome required = run("all");
        CHECK(required.code == 5);
        CHECK(is_one_line_of(required.err, "monitor"));
        CHECK(required.err.find("1 of 160 records left out") != std::string::npos);
    }
}
