#include "engine/errors.hpp"
#include "engine/io/whole_file.hpp"
#include "scenarios/monitoring/passage.hpp"
#include "scenarios/monitoring/sensor_verdict.hpp"
#include "scenarios/monitoring/synthetic_vibration.hpp"
#include "tests/engine/io/encoded.hpp"
#include "tests/scenarios/records/sheet.hpp"
#include "tests/temporary_directory.hpp"

#include <doctest/doctest.h>
#include <fmt/format.h>

#include <cmath>

using namespace bris;

namespace {

std::string reading(const TemporaryDirectory& folder) {
    return message_of<InputError>([&] { (void)read_passages(folder.path(), {}, "--baseline"); });
}

} // namespace

TEST_SUITE("monitoring/passage") {
    TEST_CASE("passages are read as they were written, in the order of their names") {
        const TemporaryDirectory folder;
        const SyntheticVibration settings{.sensors = 2, .duration = 2};
        std::vector<Passage> written;
        for (const char* name : {"b", "a"})
            written.push_back(
                synthetic_passage(settings, {}, 1, name == std::string("a") ? 1 : 2, name));
        write_passages(folder.path(), written, "synthetic");
        const auto read = read_passages(folder.path(), {}, "--recordings");
        REQUIRE(read.size() == 2);
        CHECK(read[0].name == "a");
        for (std::size_t k = 0; k < 2; ++k) {
            const auto &back = read[k].recordings, &before = written[1 - k].recordings;
            REQUIRE(back.size() == 2);
            for (std::size_t s = 0; s < 2; ++s) {
                CHECK(back[s].info.id == before[s].info.id);
                REQUIRE(back[s].size() == before[s].size());
                CHECK(back[s].sequence == before[s].sequence);
                for (std::size_t i = 0; i < back[s].size(); i += 37)
                    CHECK((back[s].force[i] - before[s].force[i]).norm() < 1e-5); // seven digits
            }
        }
    }

    TEST_CASE("a folder that cannot be read is refused with the option, the file and its line") {
        TemporaryDirectory folder;
        CHECK(reading(folder).find("--baseline: expected recordings.csv") == 0);
        write_whole(folder / "recordings.csv", "t,id,ax,ay,az\n0,1,0,0,9.8\n");
        CHECK(reading(folder).find("rock_NN.txt") != std::string::npos);
        write_whole(folder / "rock_01.txt", "id = 1\nsampling_rate = fast\n");
        CHECK(reading(folder).find("rock_01.txt:2: ") != std::string::npos);
        write_whole(folder / "rock_01.txt", "id = 1\n");
        CHECK(reading(folder).empty());
        write_whole(folder / "recordings.csv",
                    "t,id,ax,ay,az\n0,1,0,0,9.8\n0.005,1,0,banana,9.8\n");
        CHECK(reading(folder).find("recordings.csv:3: ") != std::string::npos);
        write_whole(folder / "recordings.csv", "t,id,ax,ay,az\n0,7,0,0,9.8\n");
        CHECK(reading(folder).find("recordings.csv:2: id: expected") != std::string::npos);
        write_whole(folder / "rock_02.txt", "id = 1\n");
        CHECK(reading(folder).find("rock_02.txt: id: expected another") != std::string::npos);
        CHECK_THROWS_AS((void)read_passages(folder / "none", {}, "--baseline"), OutputError);
    }

    TEST_CASE(
        "passages with columns of text, in units that columns.txt states, in another encoding, "
        "or in single precision have the same features") {
        using testing::Sheet;
        const SyntheticVibration settings{.sensors = 2, .lead = 1.2, .duration = 4};
        const TemporaryDirectory folder;
        std::vector<Passage> clean;
        for (unsigned k = 1; k <= 8; ++k)
            clean.push_back(synthetic_passage(settings, synthetic_state("clean"), 7, k, "clean"));
        const auto baselines = baselines_of(clean, {});
        write_passages(folder.path(),
                       {synthetic_passage(settings, synthetic_state("fouled"), 7, 20, "passage")},
                       "written");
        const auto csv = folder / "passage/recordings.csv";
        const Sheet written = Sheet::read(csv);
        const auto judged = [&] {
            return judge_passage(read_passages(folder.path(), {}, "--recordings").front(),
                                 baselines, {});
        };
        const PassageResult before = judged();
        const auto check_same = [&](double tolerance) {
            const PassageResult after = judged();
            for (std::size_t s = 0; s < before.sensors.size(); ++s) {
                const SensorResult &a = before.sensors[s], &b = after.sensors[s];
                CHECK(a.verdict == b.verdict);
                CHECK(a.level_ratio() > 0);
                for (std::size_t f = 0; f < a.features.size(); ++f)
                    if (std::isfinite(a.features[f].p))
                        CHECK(std::abs(a.features[f].difference - b.features[f].difference) <=
                              tolerance);
                CHECK(std::abs(a.outlier_shares[0] - b.outlier_shares[0]) <= tolerance);
            }
        };
        Sheet other = written;
        other.insert(2, "place", {"\"km 12,4\"", "true", ""});
        for (const std::string& encoding : testing::encodings()) {
            write_whole(csv, testing::encoded(other.text(), encoding));
            check_same(0);
        }
        write_whole(folder / "columns.txt",
                    "delimiter = comma\nt = \"Zeit [\u00b5s]\", us\nid = id\n"
                    "seq = seq\nax = ax, mg\nay = ay, mg\naz = az, mg\n"
                    "gx = gx, deg/s\ngy = gy, deg/s\ngz = gz, deg/s\n");
        other.change([](const std::string& name, double x) {
            return fmt::format("{}", name == "t"      ? 1e6 * x
                                     : name[0] == 'a' ? 1e3 * x / standard_gravity
                                     : name[0] == 'g' ? x * 180 / pi
                                                      : x);
        });
        other.names[0] = "Zeit [\u00b5s]";
        write_whole(csv, testing::encoded(other.text(), "Latin-1"));
        check_same(1e-9);
        std::filesystem::remove(folder / "columns.txt");
        other = written;
        other.change(testing::in_single_precision);
        write_whole(csv, other.text());
        check_same(1e-5);
    }
}
