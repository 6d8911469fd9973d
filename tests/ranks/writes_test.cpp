// Only the first rank writes files; the others wait for it, however long it takes.
#include "engine/io/checkpoint.hpp"
#include "engine/io/gnuplot.hpp"
#include "engine/io/run_file.hpp"
#include "engine/io/whole_file.hpp"
#include "engine/ranks.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <thread>
#include <unistd.h>

using namespace bris;

namespace {

namespace fs = std::filesystem;

/// A folder of this rank alone.
fs::path own_folder() {
    const fs::path folder =
        fs::temp_directory_path() / ("bris_rank_writes_" + std::to_string(getpid()));
    fs::create_directories(folder);
    return folder;
}

} // namespace

TEST_SUITE("ranks/writes") {
    TEST_CASE("only the first rank has files") {
        const fs::path folder = own_folder();
        write_whole(folder / "text", "x");
        const std::vector<double> numbers{1, 2, 3};
        Archive state;
        state.put("bodies/x", std::span<const double>(numbers));
        write_checkpoint(folder / "a.ckpt.h5", {"none", 1, {}, state});
        RunFile frames(folder / "a.vtkhdf");
        frames.begin_part(1, {}, {}, {});
        for (const double time : {0.0, 1.0}) {
            frames.begin_frame(std::vector<float>{1, 2, 3}, {});
            frames.end_frame(time);
        }
        frames.close();
        (void)draw_with_gnuplot(folder / "a.png", 100, 100, "plot x\n", "");
        std::vector<std::string> found;
        for (const auto& entry : fs::directory_iterator(folder))
            found.push_back(entry.path().filename().string());
        std::ranges::sort(found);
        if (Ranks::is_first())
            CHECK(found ==
                  std::vector<std::string>{"a.ckpt.h5", "a.png", "a.vtkhdf", "a.xdmf", "text"});
        else
            CHECK(found.empty());
        fs::remove_all(folder);
        Ranks::meet();
    }

    TEST_CASE("the other ranks wait for a file that takes its time") {
        Ranks::meet();
        const auto began = std::chrono::steady_clock::now();
        if (Ranks::writes()) std::this_thread::sleep_for(std::chrono::milliseconds(300));
        Ranks::meet();
        const std::chrono::duration<double> took = std::chrono::steady_clock::now() - began;
        CHECK(took.count() > 0.29);
    }
}
