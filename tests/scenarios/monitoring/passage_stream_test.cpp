#include "engine/errors.hpp"
#include "engine/io/whole_file.hpp"
#include "scenarios/monitoring/passage_stream.hpp"
#include "tests/scenarios/monitoring/faulty_stream.hpp"
#include "tests/temporary_directory.hpp"

#include <doctest/doctest.h>
#include <fmt/format.h>

#include <algorithm>

using namespace bris;
using namespace bris::testing;

namespace {

std::vector<StreamPassage> all_of(PassageStream& stream) {
    std::vector<StreamPassage> all;
    while (auto given = stream.next()) all.push_back(std::move(*given));
    return all;
}

} // namespace

TEST_SUITE("monitoring/passage_stream") {
    TEST_CASE(
        "passages are cut at quiet: shifted clocks, idle time and other batches change none") {
        const TrainDay day = make_day(2, 2, 100, 1);
        const DayResult plain = follow(day, day.samples, Way::pipe);
        REQUIRE(plain.passages.size() == 2);
        for (const double shift : {0.013, 12345.678, -77.7}) {
            std::vector<Sent> samples = day.samples;
            for (Sent& s : samples) s.t += shift, s.arrival += shift;
            CHECK(follow(day, samples, Way::pipe).passages == plain.passages);
            const DayResult of_file = follow(day, samples, Way::file);
            CAPTURE(shift);
            CAPTURE(of_file.report);
            CHECK(of_file.passages == plain.passages);
        }
        std::vector<Sent> samples = day.samples;
        for (Sent& s : samples)
            if (s.true_time > 50) s.t += 86400, s.arrival += 86400;
        CHECK(follow(day, samples, Way::pipe).passages == plain.passages);
        const DayResult idle = follow(day, samples, Way::file);
        CAPTURE(idle.report);
        CAPTURE(idle.passages.size());
        CHECK(idle.passages == plain.passages);
        samples = day.samples;
        for (Sent& s : samples) s.arrival = std::ceil(s.arrival);
        CHECK(follow(day, samples, Way::pipe).passages == plain.passages);
    }

    TEST_CASE("a verdict is provisional until all sensors have recorded its time, and late records "
              "revise it") {
        const TrainDay day = make_day(2, 2, 100, 1);
        std::vector<Sent> samples = day.samples;
        for (Sent& s : samples) // sensor 2 sends its first train late
            if (s.sensor == 2 && s.true_time > 12 && s.true_time < 50)
                s.arrival = 120 + 0.01 * s.true_time;
        std::ranges::stable_sort(samples, {}, &Sent::arrival);
        std::deque<Lines::Line> lines;
        for (const Sent& s : samples)
            lines.push_back(
                {lines.size() + 1,
                 fmt::format("{{\"id\":{},\"t\":{},\"seq\":{},\"ax\":{},\"ay\":{},"
                             "\"az\":{}}}",
                             s.sensor, s.t, s.seq, s.force.x(), s.force.y(), s.force.z()),
                 Instant{}, true, s.arrival});
        PassageStreamSettings settings;
        for (const SensorBaseline& b : day.baselines) settings.thresholds[b.id] = b.train_threshold;
        PassageStream stream(std::make_unique<GivenLines>(std::move(lines)), day.infos, settings);
        const auto given = all_of(stream);
        REQUIRE(given.size() >= 3);
        CHECK_FALSE(given[0].is_final);
        CHECK(given[0].revision == 1);
        CHECK(given[0].passage.recordings[0].size() > 1000);
        const auto last = std::ranges::find_if(
            given, [&](const StreamPassage& p) { return p.id == given[0].id && p.is_final; });
        REQUIRE(last != given.end());
        CHECK(last->revision > 1);
        CHECK(last->passage.recordings[1].size() > 1000);
        CAPTURE(stream.report());
        const StreamCounts c = stream.counts();
        CHECK(c.received == samples.size());
        CHECK(c.waiting == 0);
        CHECK(c.left_out == 0);
    }

    TEST_CASE("records of a passage whose verdict is final are counted as too late, and make no "
              "passage of their own") {
        const TrainDay day = make_day(2, 2, 100, 1);
        for (const bool is_long : {false, true}) {
            std::vector<Sent> samples = day.samples;
            std::size_t late = 0;
            for (Sent& s : samples) { // of the first train, from 8 to 14 s
                if (s.sensor == 2 || s.true_time < 11 || s.true_time > (is_long ? 13.5 : 11.5))
                    continue;
                s.arrival = 300 + 0.01 * s.true_time;
                ++late;
            }
            std::ranges::stable_sort(samples, {}, &Sent::arrival);
            PassageStreamSettings settings;
            settings.late = is_long ? 60 : 21600; // the verdict is final, or all is there
            const DayResult found = follow(day, samples, Way::pipe, settings);
            CAPTURE(is_long);
            CAPTURE(found.report);
            CHECK(found.passages.size() == 2);
            CHECK(late >= 100);
            CHECK(found.report.find(fmt::format("{} records too late: ", late)) !=
                  std::string::npos);
            CHECK(found.counts.left_out == late);
            CHECK(found.counts.waiting == 0);
        }
    }

    TEST_CASE("lines that cannot be used are counted by reason, and received = used + left out") {
        SensorInfo info;
        info.id = 4;
        std::string text = "t,id,ax,ay,az\n";
        for (int k = 0; k < 50; ++k) text += fmt::format("{},4,0,0,9.8\n", 100 + 0.1 * k);
        text += "100.2,9,0,0,9.8\nbanana\nnan,4,0,0,9.8\n1e300,4,0,0,9.8\n{\"id\": 4\n";
        for (int k = 0; k < 50; ++k) text += fmt::format("{},4,0,0,9.8\n", 90000 + 0.1 * k);
        text += "100.7,4,0,0,9.8\n";
        const TemporaryDirectory folder;
        write_whole(folder / "s.csv", text + "{\"end\": 1}\n");
        PassageStream stream(folder / "s.csv", {info}, {});
        CHECK(all_of(stream).empty());
        const StreamCounts c = stream.counts();
        CHECK(c.received == 106);
        CHECK(c.quiet == 100);
        CHECK(c.left_out == 6);
        const std::string report = stream.report();
        for (const char* what :
             {"line 52: id: expected the id", "2 records unreadable: line 53",
              "2 records without a time: line 54: sensor 4: t:", "1 record sent again"})
            CHECK_MESSAGE(report.find(what) != std::string::npos, report);
        CHECK_THROWS_AS(PassageStream(folder / "s.csv", {}, {}), InputError);
    }

    TEST_CASE("memory: 64 bytes for a sample of six channels, and the oldest verdicts become final "
              "when more wait than may") {
        const TrainDay day = make_day(1, 3, 100, 1);
        Samples one;
        for (const Sent& s : day.samples) {
            StreamRecord r(1, Instant{}, s.arrival);
            for (std::size_t k = 0; k < stream_fields.size(); ++k)
                for (int i = 0; i < 3; ++i) {
                    if (stream_fields[k] ==
                        std::array{"ax", "ay", "az"}[static_cast<std::size_t>(i)])
                        r.add(k, s.force[i]);
                    if (stream_fields[k] ==
                        std::array{"gx", "gy", "gz"}[static_cast<std::size_t>(i)])
                        r.add(k, s.rate[i]);
                }
            one.add({1, 0, s.t, static_cast<std::int64_t>(s.seq), std::move(r)});
        }
        CHECK(one.bytes() <= 100 * one.size());
        PassageStreamSettings small;
        small.memory = 0.1;
        const DayResult found = follow(day, day.samples, Way::pipe, small);
        CHECK(found.passages == follow(day, day.samples, Way::pipe).passages);
        CHECK(found.counts.waiting == 0);
    }
}
