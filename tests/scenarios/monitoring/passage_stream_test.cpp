#include "engine/errors.hpp"
#include "engine/io/whole_file.hpp"
#include "engine/random.hpp"
#include "scenarios/monitoring/passage_stream.hpp"
#include "scenarios/monitoring/synthetic_vibration.hpp"
#include "tests/temporary_directory.hpp"

#include <doctest/doctest.h>
#include <fmt/format.h>

#include <algorithm>

using namespace bris;

namespace {

std::string line_of(const Recording& r, std::size_t k, double later = 0) {
    return fmt::format("{{\"id\": {}, \"t\": {}, \"seq\": {}, \"ax\": {}, \"ay\": {}, \"az\": {}, "
                       "\"gx\": {}, \"gy\": {}, \"gz\": {}}}\n",
                       r.info.id, r.time[k] + later, r.sequence[k], r.force[k].x(), r.force[k].y(),
                       r.force[k].z(), r.rate[k].x(), r.rate[k].y(), r.rate[k].z());
}

} // namespace

TEST_SUITE("monitoring/passage_stream") {
    TEST_CASE(
        "a stream is cut into windows that hold every record once, in whatever order it came") {
        const Passage passage =
            synthetic_passage({.sensors = 3, .duration = 7}, synthetic_state("clean"), 1, 1, "p");
        std::vector<std::pair<double, std::string>> lines;
        Random random(4, 0);
        std::vector<SensorInfo> infos;
        for (const Recording& r : passage.recordings) {
            infos.push_back(r.info);
            for (std::size_t k = 0; k < r.size(); ++k)
                lines.emplace_back(r.time[k] + 0.5 * random.uniform(), line_of(r, k)); // delays
        }
        std::ranges::sort(lines);
        std::string text = "# begins\n\n{\"end\": 0}\n";
        for (const auto& [time, line] : lines) text += line;
        const TemporaryDirectory folder;
        write_whole(folder / "s.ndjson", text + lines.back().second + "{\"end\": 1}\n");
        PassageStream stream(folder / "s.ndjson", infos, {.window = 2, .late = 1});
        std::vector<std::size_t> counts(3, 0);
        std::size_t windows = 0;
        double last = -1;
        while (const auto window = stream.next()) {
            ++windows;
            REQUIRE(window->recordings.size() == 3);
            double latest = last;
            for (std::size_t s = 0; s < 3; ++s) {
                const Recording& r = window->recordings[s];
                CHECK(std::ranges::is_sorted(r.time));
                for (std::size_t k = 0; k < r.size(); ++k) {
                    const std::size_t n = counts[s]++;
                    CHECK(r.time[k] == passage.recordings[s].time[n]);
                    CHECK(r.force[k] == passage.recordings[s].force[n]);
                    latest = std::max(latest, r.time[k]);
                }
            }
            CHECK(latest <= 2.02 * static_cast<double>(windows) + 0.5);
            last = latest;
        }
        CHECK(windows == 6); // from 1 s before the first record to 10 s
        for (std::size_t s = 0; s < 3; ++s) CHECK(counts[s] == passage.recordings[s].size());
        CHECK(stream.report().find("1 time: sensor") != std::string::npos); // sent again
    }

    TEST_CASE("lines that cannot be used are counted, and idle hours are skipped") {
        SensorInfo info;
        info.id = 4;
        std::string text = "t,id,ax,ay,az\n";
        for (int k = 0; k < 5; ++k) text += fmt::format("{},4,0,0,9.8\n", 100 + 0.1 * k);
        text += "100.2,9,0,0,9.8\nbanana\nnan,4,0,0,9.8\n1e300,4,0,0,9.8\n{\"id\": 4\n";
        for (int k = 0; k < 5; ++k) text += fmt::format("{},4,0,0,9.8\n", 90000 + 0.1 * k);
        text += "100.7,4,0,0,9.8\n";
        const TemporaryDirectory folder;
        write_whole(folder / "s.csv", text + "{\"end\": 1}\n");
        PassageStream stream(folder / "s.csv", {info}, {.window = 10, .late = 1});
        const auto first = stream.next(), second = stream.next();
        REQUIRE((first && second));
        CHECK(first->recordings[0].size() == 5);
        CHECK(second->recordings[0].size() == 5);
        CHECK_FALSE(stream.next());
        const std::string report = stream.report();
        for (const char* what : {"line 7: id: expected the id", "2 times: line 8: ",
                                 "2 times: line 9: sensor 4: t:", "t = 100.7 s is before"})
            CHECK_MESSAGE(report.find(what) != std::string::npos, report);
        CHECK_THROWS_AS(PassageStream(folder / "s.csv", {}, {}), InputError);
    }
}
