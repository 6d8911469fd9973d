// Time and error of the solid fraction by voxel size and lines per voxel: rocks of 30 spheres at
// random in a cylinder, overlaps included. One CSV line for each size: processor time and wall time
// of a new field (median), the error of the total and the root mean square error of single voxels
// against a field with 16 x 16 lines per voxel, and the estimate of the error of the total. Errors
// against closed forms are in tests/systems/fields/solid_fraction_test.cpp.
#include "engine/assets.hpp"
#include "engine/io/csv.hpp"
#include "engine/parallel.hpp"
#include "engine/random.hpp"
#include "engine/scenario.hpp"
#include "engine/stopwatch.hpp"
#include "scenarios/rocks/clump_library.hpp"
#include "scenarios/rocks/grading.hpp"
#include "scenarios/specimens/scene.hpp"
#include "systems/fields/solid_fraction.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <ctime>

namespace {

using namespace bris;

struct Benchmark {
    unsigned rocks = 4000, rounds = 5;

    void declare_options(auto& option) {
        option("rocks", rocks, "", "Number of rocks.", within(10, 1e5));
        option("rounds", rounds, "", "Number of times that each field is computed.",
               within(1, 1000));
    }
};

/// Rocks of a grading at random in a cylinder twice as high as wide, as many as leave the porosity
/// of 0.4 if they did not overlap.
World make_rocks(unsigned count, std::uint64_t seed, double& radius) {
    auto clumps = read_clumps(assets_folder() / "clumps");
    std::erase_if(clumps, [](const Clump& c) { return c.name == "cube"; });
    const RockSample sample = sample_rocks(
        read_grading(assets_folder() / "gradings" / "arema_4.csv"), clumps, count, seed);
    radius = std::cbrt(sample.solid_volume / 0.6 / (4 * pi));
    World world = make_world(Grains::clumps);
    const auto material = world.resource<Materials>().add(linear_material(1e7, 1e7, 0.5, 2650));
    for (std::size_t k = 0; k < sample.rocks.size(); ++k) {
        Random random(seed, k);
        const double away = radius * std::sqrt(random.uniform()), angle = random.uniform(0, 2 * pi),
                     z = random.uniform(0, 4 * radius);
        const Clump& shape = clumps[sample.rocks[k].clump];
        add_clump(world, scaled(shape, sample.rocks[k].sieve / shape.sieve), 0,
                  Vec3(away * std::cos(angle), away * std::sin(angle), z), random.rotation(),
                  material);
    }
    return world;
}

double rms_error(const SolidFraction& field, const SolidFraction& reference) {
    double sum = 0, count = 0;
    for (std::uint32_t n = 0; n < field.blocks().voxels(); ++n) {
        if (field.solid()[n] == 0 && reference.solid()[n] == 0) continue;
        sum += std::pow(field.solid()[n] - reference.solid()[n], 2);
        ++count;
    }
    return std::sqrt(sum / count);
}

void run(const Benchmark& benchmark, const Common& common) {
    double radius = 0;
    const World world = make_rocks(benchmark.rocks, common.seed, radius);
    std::vector<std::vector<double>> rows;
    fmt::print("voxel_mm lines cpu_s wall_s voxels error estimate rms_voxel\n");
    for (const double voxel : {10e-3, 5e-3}) {
        const Lattice lattice{Vec3::Constant(0.5 * voxel), voxel};
        SolidFraction reference(lattice, 16);
        Threads threads(common.threads);
        threads.run([&] { reference.update(world); });
        const double exact = reference.volume().value;
        for (const int samples : {2, 3, 4, 6}) {
            std::vector<double> cpu, wall;
            SolidFraction field;
            for (unsigned k = 0; k < benchmark.rounds; ++k) {
                field = SolidFraction(lattice, samples);
                const auto began = this_instant();
                const std::clock_t clock = std::clock();
                threads.run([&] { field.update(world); });
                cpu.push_back(static_cast<double>(std::clock() - clock) / CLOCKS_PER_SEC);
                wall.push_back(seconds_since(began));
            }
            std::ranges::sort(cpu);
            std::ranges::sort(wall);
            const MeasuredVolume v = field.volume();
            rows.push_back({1e3 * voxel, static_cast<double>(samples), cpu[cpu.size() / 2],
                            wall[wall.size() / 2], static_cast<double>(field.blocks().voxels()),
                            v.value / exact - 1, v.error / exact, rms_error(field, reference)});
            fmt::print("{:.4g}\n", fmt::join(rows.back(), " "));
            std::fflush(stdout);
        }
    }
    write_csv(common.out / "fields.csv",
              {"voxel_mm", "lines", "cpu_s", "wall_s", "voxels", "error", "estimate", "rms_voxel"},
              rows, {"solid fraction of rocks of 30 spheres"}, 6);
}

} // namespace

int main(int argc, char** argv) {
    return run_scenario<Benchmark>(argc, argv,
                                   {.name = "fields",
                                    .description = "Time and error of the solid fraction.",
                                    .cannot_resume = "it takes less than a minute",
                                    .cannot_explain = "it simulates nothing"},
                                   run);
}
