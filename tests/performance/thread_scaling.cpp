// The settled bed of spheres with one thread and with more: blocks of steps, interleaved, median;
// one CSV line per size and thread count, the error beside the time.
#include "engine/errors.hpp"
#include "engine/scenario.hpp"
#include "engine/simulation.hpp"
#include "engine/stopwatch.hpp"
#include "systems/broadphase/lists.hpp"
#include "systems/build/sphere_bed.hpp"
#include "systems/output/record.hpp"
#include "systems/steps.hpp"
#include "tests/performance/compiler.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <map>
#include <memory>

namespace {

using namespace bris;

struct Scaling {
    std::vector<double> spheres{2000, 16000};
    std::vector<double> threads{1, 2};
    unsigned rounds = 5;
    std::uint64_t steps = 1000;
    std::filesystem::path out = std::filesystem::path(BRIS_ASSETS).parent_path() /
                                "tests/performance/results/thread_scaling.csv";

    void describe(auto& option) {
        option("spheres", spheres, "", "sizes of the bed, as 2000,16000,128000", within(1, 50e6));
        option("threads", threads, "", "to compare, as 1,2", within(1, 4096));
        option("rounds", rounds, "", "blocks timed for each", within(5, 1000));
        option("steps", steps, "", "of a block", within(1, 1e9));
        option("out", out, "", "CSV file to append to");
    }
};

constexpr double gravity = 9.81;

/// The bed of `settle`.
World make_scene(unsigned spheres) {
    SphereBed bed;
    bed.spheres = spheres;
    return make_sphere_bed(bed);
}

Simulation start(World world, unsigned threads, bool timed) {
    add_lists(world, LawName::linear_viscous);
    Simulation simulation(std::move(world), steps(LawName::linear_viscous), threads,
                          {.timed = timed});
    simulation.on_restore(invalidate_lists);
    return simulation;
}

/// A packed bed at rest: compacted under ten times its weight with local damping, then let go at
/// its own weight, at last without damping.
Archive make_bed(unsigned spheres, unsigned threads) {
    World world = make_scene(spheres);
    // by about a fifth of its height the lattice sinks
    const double height =
        std::ceil(spheres / std::pow(std::ceil(std::cbrt(0.5 * spheres)), 2)) * 2.05 * SphereBed{}.radius;
    const auto fall = static_cast<std::uint64_t>(std::sqrt(2 * 0.2 * height / (10 * gravity)) / SphereBed{}.step);
    world.add_resource(LocalDamping{0.3});
    world.resource<Gravity>().value *= 10;
    Simulation falling = start(std::move(world), threads, false);
    falling.advance(3 * fall);
    falling.world().resource<Gravity>().value /= 10;
    falling.world().resource<LocalDamping>().fraction = 0.7;
    falling.advance(2 * fall);
    // another world without the damping: its system must not be in the times
    Simulation still = start(make_scene(spheres), threads, false);
    still.restore(falling.snapshot());
    still.advance(1000);
    return still.snapshot();
}

struct Measured {
    unsigned threads = 1;
    std::unique_ptr<Simulation> simulation;
    std::vector<double> wall = {}; ///< s, of each block
    double contacts = 0;           ///< sum over blocks
};

std::vector<Measured> measure_all(const Scaling& s, const Archive& bed, unsigned spheres,
                                  bool& same_bits) {
    std::vector<Measured> all;
    for (const double threads : s.threads) {
        const auto count = static_cast<unsigned>(threads);
        all.push_back(
            {count, std::make_unique<Simulation>(start(make_scene(spheres), count, true))});
        all.back().simulation->restore(bed);
        all.back().simulation->advance(s.steps / 10 + 1); // warm caches and lists
    }
    same_bits = true;
    for (unsigned round = 0; round < s.rounds; ++round) {
        for (Measured& m : all) {
            const auto began = this_instant();
            m.simulation->advance(s.steps);
            m.wall.push_back(seconds_since(began));
            m.contacts += static_cast<double>(measure(m.simulation->world()).contacts);
        }
        const auto expected = fingerprint(all.front().simulation->snapshot());
        for (const Measured& m : all)
            same_bits = same_bits && fingerprint(m.simulation->snapshot()) == expected;
    }
    return all;
}

std::string first_of(const char* file, const std::string& key) {
    std::ifstream in(file);
    for (std::string line; std::getline(in, line);)
        if (line.starts_with(key)) {
            const auto colon = key.empty() ? std::string::npos : line.find(": ");
            return colon == std::string::npos ? line.substr(0, line.find(' '))
                                              : line.substr(colon + 2);
        }
    return "unknown";
}

std::string flags() {
#if defined(__AVX512F__)
    return "native (AVX-512)";
#elif defined(__AVX__)
    return "native (AVX)";
#else
    return "baseline";
#endif
}

constexpr auto header =
    "scene,spheres,threads,steps,rounds,wall_s,least_wall_s,particle_steps_per_s,"
    "contact_evaluations_per_s,floor_force_error,fingerprint,same_bits,load,compiler,flags,cpu,"
    "node_seconds\n";

/// One line; the seconds of each node are those of one block, on all threads.
std::string line_of(const Scaling& s, unsigned spheres, Measured& m, bool same_bits,
                    const std::string& load) {
    std::sort(m.wall.begin(), m.wall.end());
    const double wall = 0.5 * (m.wall[(m.wall.size() - 1) / 2] + m.wall[m.wall.size() / 2]);
    const auto steps = static_cast<double>(s.steps), blocks = static_cast<double>(s.rounds);
    const Quantities q = measure(m.simulation->world());
    std::string nodes;
    const double warm = static_cast<double>(s.steps / 10 + 1);
    for (const auto& [name, seconds] : m.simulation->schedule().seconds())
        nodes += fmt::format("{}{}={:.4g}", nodes.empty() ? "" : ";", name,
                             seconds * steps / (steps * blocks + warm));
    return fmt::format("settle,{},{},{},{},{:.5g},{:.5g},{:.5g},{:.5g},{:.3g},{},{},{},\"{}\",\"{}"
                       "\",\"{}\",\"{}\"\n",
                       spheres, m.threads, s.steps, s.rounds, wall, m.wall.front(),
                       spheres * steps / wall, m.contacts / blocks * steps / wall,
                       std::abs(q.boundary_force.z() / q.weight.z() - 1),
                       hexadecimal(fingerprint(m.simulation->snapshot())), same_bits ? "yes" : "no",
                       load, compiler(), flags(), first_of("/proc/cpuinfo", "model name"), nodes);
}

void append(const std::filesystem::path& path, const std::string& line) {
    if (path.has_parent_path()) std::filesystem::create_directories(path.parent_path());
    const bool fresh = !std::filesystem::exists(path);
    std::ofstream out(path, std::ios::app);
    out << (fresh ? header : "") << line << std::flush;
    if (!out) throw OutputError(fmt::format("cannot append to '{}'", path.string()));
}

void run(const Scaling& s) {
    bool all_same = true;
    for (const double number : s.spheres) {
        const auto spheres = static_cast<unsigned>(number);
        const auto most =
            static_cast<unsigned>(*std::max_element(s.threads.begin(), s.threads.end()));
        const Archive bed = make_bed(spheres, most);
        const std::string load = first_of("/proc/loadavg", "");
        bool same_bits = true;
        auto all = measure_all(s, bed, spheres, same_bits);
        all_same = all_same && same_bits;
        for (Measured& m : all) {
            const std::string line = line_of(s, spheres, m, same_bits, load);
            fmt::print("{}", line);
            std::fflush(stdout);
            append(s.out, line);
        }
    }
    if (!all_same)
        throw SimulationError("expected the same bits for every number of threads, found others");
}

} // namespace

int main(int argc, char** argv) {
    return detail::exit_code_of("thread_scaling", [&] {
        Scaling settings;
        Options options;
        settings.describe(options);
        if (options.parse({argv + 1, argv + argc}))
            run(settings);
        else
            fmt::print("{}",
                       options.help("thread_scaling",
                                    "time a settled bed of spheres on several numbers of threads"));
    });
}
