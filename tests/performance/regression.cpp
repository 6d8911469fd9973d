// Speed of the engine at small size, with the error of the same runs beside it, compared with the
// last measurement on the same kind of machine. A slow-down is printed and never fails: times
// depend on what else the machine does.
#include "engine/assets.hpp"
#include "engine/io/csv.hpp"
#include "engine/io/whole_file.hpp"
#include "engine/random.hpp"
#include "engine/run.hpp"
#include "scenarios/specimens/small_scene.hpp"
#include "scenarios/specimens/sphere_bed.hpp"
#include "systems/output/quantities.hpp"
#include "tests/performance/machine.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>

namespace {

using namespace bris;

struct Regression {
    unsigned rounds = 7;
    std::filesystem::path baseline =
        assets_folder().parent_path() / "tests/performance/results/regression.csv";

    void declare_options(auto& option) {
        option("rounds", rounds, "",
               "Number of timed blocks of each case; the median counts, and their spread is the "
               "noise.",
               within(3, 1000));
        option("baseline", baseline, "", "CSV file of an earlier measurement to compare with.");
    }
};

/// One case: a scene at rest, or in motion, and how many steps are timed.
struct Case {
    std::string name;
    unsigned threads = 1;
    std::uint64_t settle = 0, steps = 0; ///< steps before the timing; of a timed block
    std::function<World()> scene;
    LawName law = LawName::linear_viscous;
    double dt = 1e-5; ///< s
};

/// A bed that is in contact from the start, with some motion.
World bed_of(unsigned spheres) {
    SphereBed bed;
    bed.spheres = spheres;
    bed.start_overlap = 1e-3;
    World world = make_sphere_bed(bed);
    Random random(1, 0);
    for (Vec3& velocity : world.column<Bodies, Velocity>()) velocity = 0.2 * random.direction();
    return world;
}

const std::vector<Case>& cases() {
    static const auto clumps = [] { return bed({.grains = Grains::clumps, .bodies = 400}); };
    static const auto in_facets = [] { return bed({.walls = Walls::facets, .bodies = 400}); };
    static const std::vector<Case> all{
        {"2 000 spheres", 1, 10000, 3000, [] { return bed_of(2000); }},
        {"16 000 spheres", 1, 3000, 400, [] { return bed_of(16000); }},
        {"16 000 spheres", 2, 3000, 800, [] { return bed_of(16000); }},
        {"400 clumps of 6 spheres", 1, 20000, 8000, clumps, LawName::linear_viscous, 2e-5},
        {"400 spheres in a box of facets", 1, 20000, 10000, in_facets, LawName::linear_viscous,
         2e-5},
        {"400 clumps, rolling resistance", 1, 20000, 8000, clumps, LawName::linear_rolling, 2e-5}};
    return all;
}

struct Measurement {
    double median = 0, least = 0; ///< ns for one body and step
    double noise = 0;             ///< half the range of the blocks over their median
    double energy_error = 0;      ///< relative change of an undamped run with the same step
};

std::size_t bodies_of(const World& world) { return world.table<Bodies>().size(); }

/// Mean of kinetic and elastic energy (J) over some steps; the two are half a step apart, so that
/// their sum oscillates from step to step.
double mean_energy(Simulation& simulation) {
    constexpr unsigned steps = 200;
    double sum = 0;
    for (unsigned k = 0; k < steps; ++k) {
        simulation.advance();
        const Quantities q = compute_quantities(simulation.world());
        sum += q.kinetic_energy + q.elastic_energy;
    }
    return sum / steps;
}

/// Relative change of the energy of the same grains in 5 000 steps without weight, friction and
/// dashpots: the accuracy that goes with the time step.
double energy_error(const Case& c) {
    World world = c.scene();
    auto& materials = world.resource<Materials>();
    for (Material& m : materials.list) m.normal_damping = m.shear_damping = m.friction = 0;
    materials.mix();
    world.resource<Gravity>().value.setZero();
    Simulation simulation =
        begin(std::move(world), {.dt = c.dt, .law = LawName::linear_frictionless});
    simulation.advance(100);
    const double before = mean_energy(simulation);
    simulation.advance(5000);
    return std::abs(mean_energy(simulation) / before - 1);
}

Measurement measure(const Case& c, unsigned rounds) {
    Simulation simulation =
        begin(c.scene(), {.dt = c.dt, .law = c.law, .threads = c.threads, .schedule = {}});
    simulation.advance(c.settle);
    std::vector<double> ns;
    const double work = static_cast<double>(c.steps * bodies_of(simulation.world()));
    for (unsigned k = 0; k < rounds; ++k) {
        const double before = simulation.count().wall_time;
        simulation.advance(c.steps);
        ns.push_back(1e9 * (simulation.count().wall_time - before) / work);
    }
    std::ranges::sort(ns);
    const double median = ns[ns.size() / 2];
    return {median, ns.front(), (ns[3 * ns.size() / 4] - ns[ns.size() / 4]) / median,
            energy_error(c)};
}

/// Median and noise of the same case in an earlier file of this kind of machine; NaN: none.
std::pair<double, double> earlier(const std::filesystem::path& file, const Case& c) {
    std::pair<double, double> found{std::nan(""), 0};
    std::ifstream in(file);
    const std::string beginning = fmt::format("\"{}\",\"{}\",{},", processor(), c.name, c.threads);
    for (std::string line; std::getline(in, line);) {
        if (!line.starts_with(beginning)) continue;
        const std::string numbers = line.substr(beginning.size());
        const auto cells = cells_of(numbers);
        found = {std::stod(std::string(cells.at(0))), std::stod(std::string(cells.at(2)))};
    }
    return found;
}

void run(const Regression& settings, const Common& common) {
    std::string csv = "machine,case,threads,median_ns_per_body_step,least_ns_per_body_step,noise,"
                      "energy_error,rounds\n";
    fmt::print("{:34} {:>7} {:>12} {:>8} {:>12}  {}\n", "case", "threads", "ns/body step", "noise",
               "energy error", "against the last measurement on this kind of machine");
    for (const Case& c : cases()) {
        const Measurement m = measure(c, settings.rounds);
        const auto [before, noise] = earlier(settings.baseline, c);
        const double change = m.median / before - 1, allowed = 2 * std::hypot(m.noise, noise);
        const std::string verdict = std::isnan(before) ? "none"
                                    : change > allowed
                                        ? fmt::format("SLOWER by {:.1f} %", 100 * change)
                                        : fmt::format("{:+.1f} %", 100 * change);
        fmt::print("{:34} {:7} {:12.1f} {:7.1f}% {:12.1e}  {}\n", c.name, c.threads, m.median,
                   100 * m.noise, m.energy_error, verdict);
        std::fflush(stdout);
        csv += fmt::format("\"{}\",\"{}\",{},{:.4g},{:.4g},{:.3g},{:.3g},{}\n", processor(), c.name,
                           c.threads, m.median, m.least, m.noise, m.energy_error, settings.rounds);
    }
    write_whole(common.out / "regression.csv", csv);
    fmt::print("written to {}; the file to compare with is {}\n",
               (common.out / "regression.csv").string(), settings.baseline.string());
}

} // namespace

int main(int argc, char** argv) {
    return run_scenario<Regression>(
        argc, argv,
        {"regression", "Measures the speed of the engine at small size, with its error beside it.",
         "it takes some minutes", "it runs several scenes"},
        run);
}
