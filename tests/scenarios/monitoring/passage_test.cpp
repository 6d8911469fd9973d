#include "engine/errors.hpp"
#include "engine/io/whole_file.hpp"
#include "scenarios/monitoring/passage.hpp"
#include "scenarios/monitoring/synthetic_vibration.hpp"
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
}
