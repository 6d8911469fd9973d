// S29: scenes that are made, run, saved, loaded and removed again and again leave no memory and no
// open files behind.
#include "engine/errors.hpp"
#include "engine/estimation/linear_fit.hpp"
#include "engine/interrupt.hpp"
#include "engine/io/checkpoint.hpp"
#include "engine/io/csv.hpp"
#include "engine/stopwatch.hpp"
#include "scenarios/specimens/small_scene.hpp"
#include "systems/output/frames.hpp"
#include "tests/stability/cases.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <fstream>
#include <string>
#include <unistd.h>
#include <vector>

namespace bris {

namespace {

namespace fs = std::filesystem;

/// Resident memory of this process, bytes.
double resident_memory() {
    std::ifstream file("/proc/self/statm");
    double pages = 0, resident = 0;
    file >> pages >> resident;
    return resident * static_cast<double>(sysconf(_SC_PAGE_SIZE));
}

std::size_t open_files() {
    const auto all = fs::directory_iterator("/proc/self/fd");
    return static_cast<std::size_t>(std::distance(begin(all), end(all)));
}

/// A folder for the files of the scenes.
struct Folder {
    fs::path path = fs::temp_directory_path() / fmt::format("bris_soak_{}", getpid());
    Cleanup cleanup{[this] { remove(); }};
    Folder() { fs::create_directories(path); }
    ~Folder() { remove(); }
    void remove() {
        std::error_code ignored;
        fs::remove_all(path, ignored);
    }
    Folder(const Folder&) = delete;
    Folder& operator=(const Folder&) = delete;
};

World scene(std::uint64_t number) {
    const Grains grains = number % 2 == 0 ? Grains::spheres : Grains::clumps;
    const auto bodies = static_cast<unsigned>(20 + number % 7 * 10);
    if (number % 3 == 0) return tumbling({.grains = grains, .bodies = bodies, .seed = number});
    return bed({.grains = grains,
                .walls = number % 3 == 1 ? Walls::facets : Walls::planes,
                .bodies = bodies,
                .seed = number});
}

/// Makes a scene, runs it, and writes and reads each kind of file. One of four scenes is stopped by
/// a file that cannot be read.
void load_and_run(std::uint64_t number, const fs::path& folder) {
    const SmallSceneSettings settings{.dt = 2e-5, .law = LawName::linear_viscous};
    Simulation simulation = begin(scene(number), settings);
    FrameWriter frames(folder / "soak.vtkhdf", {});
    std::vector<std::vector<double>> table;
    for (int k = 0; k < 5; ++k) {
        simulation.advance(60);
        frames.add(simulation.world());
        table.push_back({static_cast<double>(k), 1.0 / (k + 1)});
    }
    frames.file().close();
    write_csv(folder / "soak.csv", {"k", "x"}, table);
    (void)read_csv(folder / "soak.csv");
    const fs::path file = folder / "soak.ckpt.h5";
    write_checkpoint(file, {"soak", number, {}, simulation.snapshot()});
    if (number % 4 == 0) fs::resize_file(file, fs::file_size(file) / 2);
    try {
        Simulation again = begin(scene(number), settings);
        again.restore(read_checkpoint(file).state);
        again.advance(60);
    } catch (const InputError&) { // the truncated file
    }
}

struct Soak {
    std::uint64_t scenes = 0;
    std::vector<double> hours, megabytes; ///< resident memory over time
    std::size_t files_before = 0, files_after = 0;
    double growth_per_hour() const { // after a third of the time all buffers have their size
        return fit_line(hours, megabytes, hours.back() / 3, hours.back()).slope;
    }
};

Soak soak_for(double seconds) {
    constexpr std::uint64_t first = 30; // scenes until all kinds have been loaded
    const Folder folder;
    Soak soak;
    for (; soak.scenes < first; ++soak.scenes) load_and_run(soak.scenes, folder.path);
    soak.files_before = open_files();
    const Instant began = this_instant();
    for (double now = 0; now < seconds || soak.hours.size() < 20; now = seconds_since(began)) {
        load_and_run(soak.scenes++, folder.path);
        soak.hours.push_back(now / 3600);
        soak.megabytes.push_back(resident_memory() / 1e6);
    }
    soak.files_after = open_files();
    return soak;
}

} // namespace

StressRows stress_soak(const StressSettings& s) {
    const Soak soak = soak_for(s.full ? 60 * s.soak_minutes : 2);
    const std::string what = fmt::format("{} scenes loaded and run in {:.3g} minutes", soak.scenes,
                                         60 * soak.hours.back());
    const double first = soak.megabytes[soak.megabytes.size() / 3], last = soak.megabytes.back();
    const double slope = soak.growth_per_hour();
    // a few seconds cannot tell 1 MB per hour from the noise of the allocator
    const bool flat = s.full ? slope < 1 : last - first < 2;
    return {{"S29", what + ": resident memory",
             s.full ? "grows by less than 1 MB per hour" : "grows by less than 2 MB",
             fmt::format("{:.1f} to {:.1f} MB, slope {:.3g} MB per hour", first, last, slope),
             flat},
            {"S29", what + ": open files", "as many as before",
             fmt::format("{} before, {} after", soak.files_before, soak.files_after),
             soak.files_before == soak.files_after}};
}

} // namespace bris
