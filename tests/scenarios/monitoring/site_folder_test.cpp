// From raw files of a logger to an answer, as a newcomer does it.
#include "engine/errors.hpp"
#include "engine/io/whole_file.hpp"
#include "scenarios/monitoring/recorded_passages.hpp"
#include "scenarios/monitoring/site_folder.hpp"
#include "scenarios/monitoring/synthetic_vibration.hpp"
#include "tests/scenarios/faults/process.hpp"
#include "tests/temporary_directory.hpp"

#include <doctest/doctest.h>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <filesystem>

using namespace bris;

namespace {

namespace fs = std::filesystem;

const SyntheticVibration vibration{.sensors = 1, .lead = 1.2, .duration = 5};

/// One sensor's passage as phyphox writes it.
void write_logged(const fs::path& file, const char* state, unsigned number) {
    const Passage p = synthetic_passage(vibration, synthetic_state(state), 3, number, "");
    const Recording& r = p.recordings[0];
    std::string text = "\"Time (s)\",\"Acceleration x (m/s^2)\",\"Acceleration y (m/s^2)\","
                       "\"Acceleration z (m/s^2)\"\n";
    for (std::size_t k = 0; k < r.size(); ++k)
        text += fmt::format("{:.9E},{:.9E},{:.9E},{:.9E}\n", r.time[k], r.force[k].x(),
                            r.force[k].y(), r.force[k].z());
    write_whole(file, text);
}

nlohmann::json summary_in(const fs::path& folder) {
    return nlohmann::json::parse(read_whole(folder / "summary.json"));
}

std::string reading(const fs::path& csv) {
    try {
        (void)read_causes(csv);
    } catch (const InputError& e) {
        return e.what();
    }
    return {};
}

} // namespace

TEST_SUITE("monitoring/site_folder") {
    TEST_CASE(
        "twelve raw files of last month and three of today are an answer in two commands, and "
        "the next day goes on from there") {
        const TemporaryDirectory folder;
        const auto in = [&](const std::string& name) { return (folder.path() / name).string(); };
        std::vector<std::string> month{"monitor", "--site", in("site"), "--baseline"},
            today{"monitor", "--site", in("site"), "--recordings"}, tomorrow = today;
        for (unsigned k = 1; k <= 12; ++k) {
            write_logged(in(fmt::format("march/{:02}.csv", k)), "clean", k);
            month.push_back(in(fmt::format("march/{:02}.csv", k)));
        }
        for (unsigned k = 1; k <= 3; ++k) {
            write_logged(in(fmt::format("april/1_{}.csv", k)), "clean", 20 + k);
            write_logged(in(fmt::format("april/2_{}.csv", k)), "fouled", 30 + k);
            today.push_back(in(fmt::format("april/1_{}.csv", k)));
            tomorrow.push_back(in(fmt::format("april/2_{}.csv", k)));
        }
        const auto run = [&](std::vector<std::string> words, const char* out) {
            words.insert(words.end(), {"--out", in(out), "--quiet"});
            const Outcome outcome = run_process(words);
            CAPTURE(outcome.err);
            REQUIRE(outcome.code == 0);
            return summary_in(in(out));
        };
        (void)run(month, "planned");
        CHECK(fs::exists(in("planned/power.csv")));
        const auto first = run(today, "first");
        CHECK(first["verdict"] == "as the baseline");
        CHECK(first["passages"] == 3);
        const auto second = run(tomorrow, "second");
        CHECK(second["passages"] == 6);
        CHECK((second["verdict"] == "louder" || second["verdict"] == "drifts"));
        CHECK(second["passages_changed"] == 3);
        const auto again = run(tomorrow, "again"); // they are there
        CHECK(again["passages"] == 6);
        month.insert(month.end(), {"--out", in("refused"), "--quiet"});
        const Outcome twice = run_process(month);
        CHECK(twice.code == 2);
        CHECK(twice.err.find("--baseline: expected none, since") != std::string::npos);
    }

    TEST_CASE("passages are kept once, in the order in which they came, with their causes") {
        const TemporaryDirectory folder;
        Passage p = synthetic_passage(vibration, synthetic_state("clean"), 3, 1, "noon");
        p.cause = {"freight", "monday", {{"speed_m_s", 21.5}}};
        CHECK(keep_passage(folder.path(), p));
        CHECK(!keep_passage(folder.path(), p));
        Passage other = synthetic_passage(vibration, synthetic_state("clean"), 3, 2, "noon");
        other.cause.numbers["axle_load_kN"] = 180;
        CHECK(keep_passage(folder.path(), other));
        const auto kept = read_passages(folder.path(), {}, "--site");
        REQUIRE(kept.size() == 2);
        CHECK(kept[0].name == "00001_noon");
        CHECK(kept[1].name == "00002_noon");
        CHECK(kept[0].cause.condition == "freight");
        CHECK(kept[0].cause.session == "monday");
        CHECK(kept[0].cause.numbers == std::map<std::string, double>{{"speed_m_s", 21.5}});
        CHECK(kept[1].cause.numbers == std::map<std::string, double>{{"axle_load_kN", 180}});
        CHECK((kept[0].recordings[0].force[100] - p.recordings[0].force[100]).norm() < 1e-5);
        Passage slow = other;
        slow.recordings[0].info.sampling_rate = 100;
        CHECK_THROWS_AS((void)keep_passage(folder.path(), slow), InputError);
    }

    TEST_CASE("causes that cannot be read are named with their line") {
        const TemporaryDirectory folder;
        const auto csv = folder / "passages.csv";
        CHECK(reading(csv).empty()); // no file: none
        write_whole(csv, "passage, speed_m_s\r\n# a comment\r\nnoon, 20.5\r\n\r\nnight,\r\n");
        const auto causes = read_causes(csv);
        CHECK(causes.at("noon").numbers.at("speed_m_s") == 20.5);
        CHECK(causes.at("night").numbers.empty());
        write_whole(csv, "name,speed_m_s\nnoon,20\n");
        CHECK(reading(csv).find("passages.csv:1: expected names of columns with one 'passage'") !=
              std::string::npos);
        write_whole(csv, "passage,speed_m_s\nnoon,fast\n");
        CHECK(reading(csv).find("passages.csv:2: speed_m_s: expected a number, found 'fast'") !=
              std::string::npos);
        write_whole(csv, "passage,speed_m_s\nnoon,20,3\n");
        CHECK(reading(csv).find(":2: expected 2 cells, found 3") != std::string::npos);
        write_whole(csv, "passage,speed_m_s\nnoon,20\nnoon,21\n");
        CHECK(reading(csv).find(":3: expected each passage once") != std::string::npos);
    }

    TEST_CASE("files after an option are one word, and a folder of BRIS's own form is told apart") {
        CHECK(with_listed_files({"monitor", "--baseline", "a.csv", "b.csv", "--site", "s", "t"},
                                {"--baseline"}) ==
              std::vector<std::string>{"monitor", "--baseline", "a.csv,b.csv", "--site", "s", "t"});
        const TemporaryDirectory folder;
        write_passages(folder / "own",
                       {synthetic_passage(vibration, synthetic_state("clean"), 3, 1, "noon")}, "");
        write_logged(folder / "raw/1.csv", "clean", 1);
        CHECK(RecordingsNamed{(folder / "own").string(), ""}.is_own_folder());
        CHECK(!RecordingsNamed{(folder / "raw").string(), ""}.is_own_folder());
        CHECK(RecordingsNamed{"a,b.csv", ""}.list().size() == 2);
        write_whole(folder / "a,b.csv", "x\n");
        CHECK(RecordingsNamed{(folder / "a,b.csv").string(), ""}.list().size() == 1);
    }
}
