// Files of loggers as passages of trains: cut where the sensor vibrates, and joined where several
// sensors recorded the same time.

#include "engine/errors.hpp"
#include "engine/io/whole_file.hpp"
#include "engine/random.hpp"
#include "scenarios/monitoring/logger_passages.hpp"
#include "tests/about.hpp"
#include "tests/temporary_directory.hpp"

#include <doctest/doctest.h>
#include <fmt/format.h>

#include <algorithm>
#include <map>

using namespace bris;

namespace {

constexpr double rate = 100; // Hz

struct Train {
    double begin, end;
};

/// A file of `duration` s in which these trains pass: noise of 0.02 m/s2, under a train 1 m/s2.
/// `start`: s since 1970; 0: times from 0.
std::string recorded(double duration, const std::vector<Train>& trains, double start = 0,
                     std::uint64_t seed = 1) {
    std::string text = start > 0 ? "timestamp,ax [m/s2],ay [m/s2],az [m/s2]\n"
                                 : "t [s],ax [m/s2],ay [m/s2],az [m/s2]\n";
    Random random(seed, 0);
    for (int k = 0; k < static_cast<int>(duration * rate); ++k) {
        const double t = k / rate;
        const bool passes = std::ranges::any_of(
            trains, [&](const Train& train) { return t >= train.begin && t < train.end; });
        const double noise = (passes ? 1 : 0.02) * 1.7 * random.uniform(-1, 1);
        text += fmt::format("{:.3f},0.1,0.2,{:.4f}\n", start + t, 9.81 + noise);
    }
    return text;
}

struct Taken {
    std::vector<Passage> passages;
    std::vector<std::string> notes;

    bool is_noted(const std::string& part) const {
        return std::ranges::any_of(
            notes, [&](const std::string& note) { return note.find(part) != std::string::npos; });
    }
};

Taken take(const std::vector<std::filesystem::path>& files, bool whole = false) {
    Taken taken;
    for_each_logged_passage(
        files, {}, {.every_recording_holds_a_train = whole}, "--recordings",
        [&](Passage&& p) { taken.passages.push_back(std::move(p)); }, taken.notes);
    return taken;
}

double length_of(const Passage& passage) { return passage.recordings.front().time.back(); }

} // namespace

TEST_SUITE("monitoring/logger_passages") {
    TEST_CASE("a file in which several trains passed is cut into passages with a second before and "
              "after, and pauses of a train do not cut it") {
        const TemporaryDirectory folder;
        write_whole(folder / "day.csv", recorded(120, {{20, 28}, {31, 36}, {80, 88}}));
        const Taken taken = take({folder / "day.csv"});
        REQUIRE(taken.passages.size() == 2);
        CHECK(taken.passages[0].name == "day_01");
        CHECK(taken.passages[1].name == "day_02");
        CHECK(length_of(taken.passages[0]) == doctest::Approx(18).epsilon(0.05));
        CHECK(length_of(taken.passages[1]) == doctest::Approx(10).epsilon(0.05));
        CHECK(taken.passages[1].recordings[0].time.front() < 0.01);
        CHECK(taken.is_noted("day: 2 passages in 120 s; the rest is left out"));
        const Taken whole = take({folder / "day.csv"}, true);
        REQUIRE(whole.passages.size() == 1);
        CHECK(whole.passages[0].name == "day");
        CHECK(whole.passages[0].recordings[0].size() == 12000);
    }

    TEST_CASE("a short file of one train is taken as it is, a long one is cut, and one of noise is "
              "one passage with a note") {
        const TemporaryDirectory folder;
        write_whole(folder / "data/a.csv", recorded(30, {{10, 18}}));
        write_whole(folder / "data/b.txt", recorded(240, {{100, 110}}));
        write_whole(folder / "data/c.log", recorded(30, {}));
        write_whole(folder / "data/d.csv", recorded(30, {{0, 30}}));
        write_whole(folder / "data/e.csv", recorded(30, {{10, 10.1}}));
        write_whole(folder / "data/README.txt", "not a logger's");
        write_whole(folder / "data/rock_01.txt", "id = 1\n");
        const Taken taken = take({folder / "data"});
        REQUIRE(taken.passages.size() == 5);
        const std::vector<std::string> names{"a", "b_01", "c", "d", "e"};
        for (std::size_t k = 0; k < names.size(); ++k) CHECK(taken.passages[k].name == names[k]);
        CHECK(length_of(taken.passages[0]) == about(29.99));
        CHECK(length_of(taken.passages[1]) == doctest::Approx(12).epsilon(0.05));
        CHECK(taken.is_noted("c: nothing stands out from its own noise"));
        CHECK(taken.is_noted("d: nothing stands out from its own noise"));
        CHECK(taken.is_noted("e: 1 bursts shorter than 0.5 s are no trains"));
    }

    TEST_CASE("files of several sensors that overlap by their dates are one passage, in the order "
              "of the dates") {
        const TemporaryDirectory folder;
        constexpr double start = 1715076000;
        write_whole(folder / "data/sensor_1/a.csv", recorded(30, {{10, 18}}, start + 1000));
        write_whole(folder / "data/sensor_1/b.csv", recorded(30, {{10, 18}}, start));
        write_whole(folder / "data/sensor_2/a.csv", recorded(30, {{8, 16}}, start + 1002, 2));
        write_whole(folder / "data/sensor_2/b.csv", recorded(20, {{8, 16}}, start + 5, 2));
        const Taken taken = take({folder / "data"});
        REQUIRE(taken.passages.size() == 2);
        CHECK(taken.passages[0].name == "b");
        CHECK(taken.passages[1].name == "a");
        const auto& both = taken.passages[1].recordings;
        REQUIRE(both.size() == 2);
        CHECK(both[1].info.id == 2);
        CHECK(both[0].time.front() == 0);
        CHECK(both[1].time.front() == doctest::Approx(2).epsilon(1e-6));
        CHECK(taken.is_noted("a: 2 files of 2 sensors, of the same time by their dates"));
    }

    TEST_CASE("a file that cannot be read is named with the option, and a folder without files is "
              "refused") {
        const TemporaryDirectory folder;
        write_whole(folder / "data/a.csv", "1,2,3\n1,2,3\n");
        const std::string message = message_of<InputError>([&] { (void)take({folder / "data"}); });
        CHECK(message.starts_with("--recordings: "));
        CHECK(message.find("a.csv: ") != std::string::npos);
        std::filesystem::create_directories(folder / "none");
        CHECK(message_of<InputError>([&] {
                  (void)take({folder / "none"});
              }).find("expected files of a logger") != std::string::npos);
        CHECK(message_of<OutputError>([&] { (void)take({folder / "missing.csv"}); }) != "");
    }
}
