// The first request to stop ends every program within two seconds, whatever it does at that moment:
// no half-written file, no temporary file and no process stays.

#include "engine/ensemble.hpp"
#include "engine/io/whole_file.hpp"
#include "engine/random.hpp"
#include "engine/ranks.hpp"
#include "engine/stopwatch.hpp"
#include "tests/scenarios/faults/process.hpp"

#include <doctest/doctest.h>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <csignal>
#include <cstdint>
#include <fstream>
#include <map>
#include <string>
#include <sys/stat.h>
#include <thread>
#include <unistd.h>
#include <vector>

using namespace bris;

namespace {

namespace fs = std::filesystem;
using Words = std::vector<std::string>;

constexpr double longest = 2; // s
#ifdef BRIS_SANITIZED
constexpr double slower = 10;
#else
constexpr double slower = 1;
#endif

/// What a program of scenarios/ gets beyond its defaults, so that it takes its time.
Words more_words(const std::string& program, const fs::path& checkpoint) {
    const std::map<std::string, Words> more{
        {"clumps", {"--count", "300"}},
        {"collide", {"--balls", "1000", "--steps-per-contact", "100000"}},
        {"export_fields", {"--from", checkpoint.string(), "--voxel", "0.001", "--samples", "64"}},
        {"live_demo", {"--port", "0"}},
        {"settle", {"--spheres", "20000", "--duration", "100"}},
        {"stress", {"--full"}},
        {"verify", {"--case", "elastic_impact"}}};
    const auto found = more.find(program);
    return found == more.end() ? Words{} : found->second;
}

std::vector<std::string> programs() {
    std::vector<std::string> names;
    for (const auto& entry : fs::directory_iterator(fs::path(BRIS_SOURCE) / "scenarios"))
        if (entry.path().extension() == ".cpp") names.push_back(entry.path().stem().string());
    std::ranges::sort(names);
    return names;
}

/// A program that is asked to stop at some moment.
struct Stop {
    Words words; ///< without --out
    int signal = SIGINT;
    double after = 0; ///< s
    int own_code = 0; ///< exit code if it has ended by itself before
};

/// What went wrong; empty: nothing.
std::string fault_of(const Stop& stop) {
    const TemporaryDirectory folder;
    const fs::path out = folder / "out", temporary = folder / "tmp";
    fs::create_directory(temporary);
    Words words = stop.words;
    words.insert(words.end(), {"--out", out.string(), "--quiet"});
    Process process(words, [&] { return setenv("TMPDIR", temporary.c_str(), 1) == 0; });
    std::this_thread::sleep_for(std::chrono::duration<double>(stop.after));
    const double used_before = process.processor_time();
    const Instant asked = this_instant();
    process.send(stop.signal);
    const Outcome outcome = process.wait(stop.after + 60 * slower);
    const double waited = seconds_since(asked), used = outcome.processor_time - used_before;
    const std::string what =
        fmt::format("{}, signal {} after {:.2f} s: exit code {}, signal {}, {:.2f} s, of the "
                    "processor {:.2f} s, \"{}\"",
                    fmt::join(stop.words, " "), stop.signal, stop.after, outcome.code,
                    outcome.signal, waited, used, outcome.err);
    // before main, the system ends the program
    const bool was_loaded = fs::exists(out) || outcome.code >= 0;
    if (!was_loaded && outcome.signal == stop.signal) return {};
    if (outcome.code == 4 && outcome.err.find("mosquitto") != std::string::npos) return {};
    if (outcome.code != 130 && outcome.code != stop.own_code) return "ended otherwise: " + what;
    // on a loaded machine the processor time counts
    if (outcome.hung || (waited > longest * slower && used > longest * slower))
        return "too late: " + what;
    const std::string line = stop.words[0] + ": interrupted";
    if (outcome.code == 130 && outcome.err.find(line) == std::string::npos)
        return "without a line: " + what;
    for (const auto& at : {out, temporary})
        if (fs::exists(at))
            for (const auto& entry : fs::recursive_directory_iterator(at))
                if (at == temporary || entry.path().extension() == ".tmp")
                    return fmt::format("left behind: {}: {}", entry.path().string(), what);
    return {};
}

void check(const std::vector<Stop>& stops) {
    std::vector<std::string> faults(stops.size());
    run_ensemble(stops.size(), std::max(1U, std::thread::hardware_concurrency()),
                 [&](std::size_t k) { faults[k] = fault_of(stops[k]); });
    for (const std::string& fault : faults) CHECK(fault == "");
}

Words words_of(const std::string& program, const fs::path& checkpoint) {
    Words words{program};
    const Words more = more_words(program, checkpoint);
    words.insert(words.end(), more.begin(), more.end());
    return words;
}

/// The checkpoint of a small bed.
fs::path bed_in(const fs::path& folder) {
    REQUIRE(run_process({"settle", "--spheres", "300", "--duration", "0.001", "--out",
                         (folder / "bed").string(), "--quiet"})
                .code == 0);
    return folder / "bed/settle.ckpt.h5";
}

/// A CSV file of one row of many columns.
fs::path wide_csv(const fs::path& folder, unsigned columns) {
    const fs::path path = folder / "wide.csv";
    std::ofstream file(path);
    file << "time,ax";
    for (unsigned k = 0; k < columns; ++k) file << ",c" << k;
    for (int row = 0; row < 20; ++row) {
        file << "\n" << 0.01 * row << ",1";
        for (unsigned k = 0; k < columns; ++k) file << ",0";
    }
    return path;
}

/// A binary STL file of a sphere of 4 n^2 triangles.
fs::path fine_mesh(const fs::path& folder, unsigned n) {
    std::string bytes(80, ' ');
    const std::uint32_t count = 4 * n * n;
    bytes.append(reinterpret_cast<const char*>(&count), sizeof count);
    const auto point = [&](unsigned i, unsigned j) {
        const double polar = 3.14159265358979 * i / n,
                     azimuth = 3.14159265358979 * (j % (2 * n)) / n;
        const double ring = i % n == 0 ? 0 : std::sin(polar);
        for (const double x :
             {ring * std::cos(azimuth), ring * std::sin(azimuth), std::cos(polar)}) {
            const auto number = static_cast<float>(0.03 * x);
            bytes.append(reinterpret_cast<const char*>(&number), sizeof number);
        }
    };
    for (unsigned i = 0; i < n; ++i)
        for (unsigned j = 0; j < 2 * n; ++j)
            for (const bool upper : {true, false}) {
                bytes.append(12, '\0'); // the normal
                point(i, j);
                if (upper) point(i + 1, j);
                point(i + 1, j + 1);
                if (!upper) point(i, j + 1);
                bytes.append(2, '\0');
            }
    const fs::path path = folder / "fine.stl";
    write_whole(path, bytes);
    return path;
}

} // namespace

TEST_SUITE("faults/stopping") {
    TEST_CASE("every program ends at the first interrupt or termination") {
        const TemporaryDirectory folder;
        const fs::path bed = bed_in(folder.path());
        std::vector<Stop> stops;
        for (const std::string& program : programs()) {
            Random random(5, stops.size());
            stops.push_back({words_of(program, bed), stops.size() % 2 == 0 ? SIGINT : SIGTERM,
                             0.05 + 0.9 * random.uniform()});
        }
        check(stops);
    }

    TEST_CASE("a run on ranks ends at the first interrupt or termination, and does not wait for "
              "ranks that have ended") {
        if (!Ranks::available()) return;
        for (const int signal : {SIGINT, SIGTERM}) {
            const Instant began = this_instant();
            constexpr double after = 4; // s, when the ranks compute
            CHECK(fault_of({{"settle", "--ranks", "2", "--spheres", "20000", "--duration", "100"},
                            signal,
                            after}) == "");
            CHECK(seconds_since(began) - after < 8 * slower); // mpirun may wait for 10 s
        }
    }

    TEST_CASE("a program that reads a file of very many columns ends at once") {
        const TemporaryDirectory folder;
        const auto csv = wide_csv(folder.path(), 300'000).string();
        // the columns are not those of a recording, which a fast machine finds out sooner
        check({{{"recordings", "--new", csv}, SIGINT, 0.5, 2},
               {{"material_card", "--test", csv}, SIGTERM, 0.2, 2}});
    }
}

TEST_SUITE("slow") {
    TEST_CASE("every program ends at the first request, at many moments") {
        const TemporaryDirectory folder;
        const fs::path bed = bed_in(folder.path());
        std::vector<Stop> stops;
        for (const std::string& program : programs())
            for (const double span : {0.05, 0.3, 1.0, 3.0, 10.0})
                for (const int signal : {SIGINT, SIGTERM}) {
                    Random random(9, stops.size());
                    stops.push_back({words_of(program, bed), signal, span * random.uniform()});
                }
        check(stops);
    }

    TEST_CASE("readers, fits and pictures end at the first request, at many moments") {
        const TemporaryDirectory folder;
        const auto csv = wide_csv(folder.path(), 300'000).string();
        const auto mesh = fine_mesh(folder.path(), 700).string();
        const std::vector<Words> commands{{"recordings", "--new", csv},
                                          {"clumps", "--mesh", mesh},
                                          {"clumps", "--mesh", mesh, "--restarts", "100"},
                                          {"recordings"},
                                          {"monitor"}};
        std::vector<Stop> stops;
        for (const Words& words : commands)
            for (int k = 0; k < 20; ++k) {
                Random random(13, stops.size());
                stops.push_back({words, k % 2 == 0 ? SIGINT : SIGTERM, 3 * random.uniform()});
            }
        check(stops);
    }
}
