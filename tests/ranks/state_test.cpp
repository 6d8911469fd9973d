// State that is divided among ranks passes piece by piece to the first one, which writes it.
#include "engine/io/checkpoint.hpp"
#include "engine/io/whole_file.hpp"
#include "engine/ordering.hpp"
#include "engine/ranks.hpp"
#include "engine/state.hpp"
#include "engine/state_of_world.hpp"
#include "tests/engine/things.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <thread>
#include <tuple>
#include <unistd.h>

using namespace bris;

namespace {

struct Nothing {
    static constexpr auto name = "nothing";
};
struct Count {
    static constexpr auto name = "count";
    static constexpr bool is_state = true;
    double value = 0;
    void save(Archive& archive) const { put_fields(archive, "count", std::tie(value)); }
    void load(const Archive& archive) { get_fields(archive, "count", std::tie(value)); }
};
struct Fines : Count {
    static constexpr auto name = "fines";
    static constexpr bool changes_in_whole_steps_only = true;
    void save(Archive& archive) const { put_fields(archive, "fines", std::tie(value)); }
};

/// Things with these ids, a table without rows, and two resources.
World world_of(const std::vector<std::uint32_t>& ids, double count, double fines) {
    World world;
    for (Table* table : {&world.table<Things>(), &world.table<Nothing>()}) {
        table->add<Name>();
        table->add<Heat>();
    }
    world.table<Things>().resize(ids.size());
    for (Row r = 0; r < ids.size(); ++r) {
        world.column<Things, Name>()[r] = ids[r];
        world.column<Things, Heat>()[r] = 0.1 * ids[r];
    }
    world.add_resource<Count>().value = count;
    world.add_resource<Fines>().value = fines;
    return world;
}

/// Ids in several blocks, some of which are empty; every other one, or all, or those of one rank.
std::vector<std::uint32_t> ids_of(unsigned first, unsigned each) {
    std::vector<std::uint32_t> ids;
    for (std::uint32_t k = first; k < 2000; k += each)
        ids.push_back(k < 1500 ? 311 * k : 70000 * k); // beyond 2^27
    return ids;
}

/// The present world, whole on all ranks, and this rank's part with its rows in another order.
struct Divided {
    World whole = world_of(ids_of(0, 1), 5, 7);
    World part = world_of(ids_of(Ranks::rank(), Ranks::size()), 6, 0);
    Divided() {
        std::vector<Row> order = all_rows(part.table<Things>().size());
        std::reverse(order.begin(), order.end());
        part.table<Things>().keep(order);
    }
    StateOfWorld state() const {
        return {part, whole,
                [](const World&, const Table& table) { return all_rows(table.size()); }};
    }
};

std::filesystem::path file_of(const char* name) {
    return std::filesystem::temp_directory_path() /
           ("bris_" + std::string(name) + std::to_string(getpid()) + ".ckpt.h5");
}

} // namespace

TEST_SUITE("ranks") {
    TEST_CASE("the State of parts is that of the whole, and so are the bytes of its checkpoint") {
        const Divided divided;
        World expected = divided.whole;
        expected.resource<Count>().value = 6; // that of the first rank's part
        const auto whole = file_of("whole"), parts = file_of("parts");
        const Checkpoint head{"none", 3, {{"x", 1.0}}, {}};
        const StateOfWorld state = divided.state(), undivided(expected);
        const std::uint64_t found = fingerprint(state);
        write_checkpoint(parts, head, &state);
        Ranks::meet(); // all or none of the ranks
        write_checkpoint(whole, head, &undivided);
        Ranks::meet();
        if (!Ranks::is_first()) return;
        CHECK(found == fingerprint(save_state(expected)));
        CHECK(fingerprint(undivided) == found);
        CHECK(read_whole(parts) == read_whole(whole));
        CHECK(fingerprint(read_checkpoint(parts).state) == found);
        write_checkpoint(whole, {"none", 3, {{"x", 1.0}}, save_state(expected)});
        CHECK(read_whole(parts) == read_whole(whole)); // from memory
        for (const auto& path : {whole, parts}) std::filesystem::remove(path);
    }

    TEST_CASE("the ranks wait for whoever takes the pieces") {
        const Divided divided;
        std::size_t pieces = 0, rows = 0;
        divided.state().for_pieces([&](const StatePiece& piece) {
            if (pieces++ == 2) std::this_thread::sleep_for(std::chrono::milliseconds(100));
            if (piece.array->path == "things/id")
                rows += piece.bytes.size() / sizeof(std::uint32_t);
        });
        CHECK(rows == (Ranks::is_first() ? 2000 : 0));
        CHECK((pieces > 1000) == Ranks::is_first());
    }
}
