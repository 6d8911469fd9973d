// Spheres settle in a box under gravity. This is the bed on which speed is measured.
#include "engine/io/series.hpp"
#include "engine/memory.hpp"
#include "engine/ranks.hpp"
#include "engine/report.hpp"
#include "engine/run.hpp"
#include "scenarios/specimens/check_scene.hpp"
#include "scenarios/specimens/last_quantities.hpp"
#include "scenarios/specimens/memory_estimate.hpp"
#include "scenarios/specimens/relax.hpp"
#include "scenarios/specimens/sphere_bed.hpp"
#include "scenarios/specimens/start.hpp"
#include "scenarios/specimens/write_option.hpp"
#include "systems/output/quantities.hpp"
#include "systems/slabs/slabs.hpp"
#include "systems/sleep/sleep.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace {

using namespace bris;

struct Settle {
    SphereBed bed;
    double duration = 0.5, sleep = 0;
    bool relax = false;
    WriteOption written;

    void declare_options(auto& option) {
        bed.declare_options(option);
        option("duration", duration, "s", "Simulated time.", above(0, 1e6));
        option("sleep", sleep, "",
               "Unbalanced force, relative to the weight, below which a sphere falls asleep. It "
               "wakes at twice this value. 0: no sphere sleeps.",
               within(0, 10));
        option("relax", relax, "",
               "Relax deep overlaps of the start before the simulation begins.");
        written.declare_options(option, write_of_spheres);
    }
};

constexpr std::uint64_t samples = 200, samples_per_frame = 4;
constexpr LawName law = LawName::linear_viscous;

/// Whether frames are made of the whole world.
bool looks(const Settle& settings) {
    const Extras extras = settings.written.extras();
    return extras.surfaces || extras.contacts;
}

Simulation make_simulation(const Settle& settings, const Common& common) {
    SphereBed bed = settings.bed;
    bed.seed = common.seed;
    const unsigned ranks = looks(settings) || settings.relax ? 1 : Ranks::size();
    require_memory("spheres", bed.spheres, bytes_of_spheres(bed.spheres, ranks),
                   common.memory_limit);
    World world = make_sphere_bed(bed);
    const bool starts = common.resume.empty(), relaxes = starts && settings.relax;
    if (relaxes && !common.explain) relax_start(world, law, common);
    Simulation simulation =
        start(std::move(world), {.law = law, .threads = common.threads, .sleep = settings.sleep});
    check_first_step(simulation.world());
    if (starts && !(relaxes && common.explain)) check_overlaps(simulation.divide_now());
    return simulation;
}

struct MotionSample {
    double time, kinetic_energy, elastic_energy, floor_force_over_weight, coordination,
        unbalanced_ratio, stable_step;
    static constexpr auto columns() {
        using S = MotionSample;
        return std::array{Sampled{&S::time, "time", "s"},
                          Sampled{&S::kinetic_energy, "kinetic_energy", "J"},
                          Sampled{&S::elastic_energy, "elastic_energy", "J"},
                          Sampled{&S::floor_force_over_weight, "floor_force_over_weight", ""},
                          Sampled{&S::coordination, "coordination", ""},
                          Sampled{&S::unbalanced_ratio, "unbalanced_ratio", ""},
                          Sampled{&S::stable_step, "stable_step", "s"}};
    }
};

/// What is left of a simulation when its memory is free.
struct Outcome {
    SeriesOf<MotionSample> motion{"motion"};
    View view = {};
    Report summary = {};
};

void draw(const Outcome& found, const Common& common) {
    const SeriesOf<MotionSample>& motion = found.motion;
    Plot energy = motion.plot(&MotionSample::kinetic_energy, "Decay of the motion");
    energy.y_logarithmic = true;
    draw_plots(common.out / "settle_history.png",
               {energy, motion.plot(&MotionSample::floor_force_over_weight,
                                    "Weight carried by the floor")});
    draw_picture(common.out / "settle.png", {&found.view, 1});
}

void check_options(const Settle& settings, const Common&) {
    (void)steps_of(settings.duration, settings.bed.step, "duration");
}

Report summary_of(const Settle& settings, const Simulation& simulation, LastQuantities& last,
                  const Run& run) {
    const World& world = simulation.observed();
    const StepCount& count = simulation.count();
    Report summary;
    summary.add("particle_steps_per_s",
                static_cast<double>(count.steps) * settings.bed.spheres / count.wall_time);
    const double carried = last.quantities().boundary_force_over_weight();
    summary.add("floor_force_over_weight", carried);
    summary.add("floor_force_error", std::abs(carried - 1));
    add_quantities(summary, last.quantities());
    if (settings.sleep > 0) summary.add("sleepers", sleepers(world));
    if (Ranks::size() > 1) summary.add("share_of_ghosts", share_of_ghosts(world));
    summary.add("rebuilds", world.resource<ListState>().rebuilds);
    summary.add("prunes", world.resource<ListState>().prunes);
    run.add_to_summary(summary);
    summary.show({"floor_force_over_weight", "coordination", "contacts", "largest_overlap_m",
                  "unbalanced_ratio", "steps", "wall_time_s", "particle_steps_per_s"});
    return summary;
}

Outcome simulate(const Settle& settings, const Common& common) {
    Outcome outcome;
    SeriesOf<MotionSample>& motion = outcome.motion;
    Simulation simulation = make_simulation(settings, common);
    const std::uint64_t total = steps_of(settings.duration, settings.bed.step, "duration"),
                        sample_every = std::max<std::uint64_t>(1, total / samples);
    Run run(simulation, common, "settle");
    LastQuantities last(simulation);
    run.keep(motion);
    run.keep(last);
    if (!common.resume.empty()) {
        run.resume(common.resume, {"duration_s"});
        run.require_steps_left(total, "duration");
        simulation.divide_now();
    }
    FrameWriter frames(run.file("settle", ".vtkhdf"), common.settings, settings.written.extras());
    const bool draws_whole = looks(settings);
    if (draws_whole) simulation.look();
    if (!run.is_resumed())
        frames.add(draws_whole ? std::as_const(simulation).world() : simulation.observed());
    double coordination = 0; // in the last sample
    const auto sample = [&](Simulation&, std::uint64_t step) {
        const bool draws = step % (samples_per_frame * sample_every) == 0 || step == total;
        if (draws && draws_whole) simulation.look();
        simulation.observe();
        check_stable_step(simulation.observed(), last.stable_step());
        const Quantities& q = last.quantities();
        coordination = q.coordination;
        motion.add({.time = simulation.observed().resource<Clock>().time(),
                    .kinetic_energy = q.kinetic_energy,
                    .elastic_energy = q.elastic_energy,
                    .floor_force_over_weight = q.boundary_force_over_weight(),
                    .coordination = q.coordination,
                    .unbalanced_ratio = q.unbalanced_ratio,
                    .stable_step = last.stable_step()});
        if (draws) frames.add(simulation.observed());
        return true;
    };
    const auto status = [&](const World&) {
        return fmt::format("coordination number {:.2f}", coordination);
    };
    run.go({run.timed({.name = "settle",
                       .steps = total,
                       .sample_every = sample_every,
                       .sample = sample,
                       .status = status,
                       .looks = false})});
    const World& world = simulation.observed();
    outcome.view = view_by_coordination(world);
    outcome.view.caption =
        fmt::format("{} spheres after {:.3g} s. Blue to yellow: 0 to 8 contacts.",
                    settings.bed.spheres, world.resource<Clock>().time());
    motion.write_csv(common.out / "settle.csv");
    motion.write_track(frames.file());
    frames.file().close();
    outcome.summary = summary_of(settings, simulation, last, run);
    return outcome;
}

void run(const Settle& settings, const Common& common) {
    Outcome found = simulate(settings, common);
    gather(found.view);
    draw(found, common);
    report_results(common, found.summary);
}

std::string explain(const Settle& settings, const Common& common) {
    return make_simulation(settings, common).schedule().explain();
}

} // namespace

int main(int argc, char** argv) {
    const ScenarioInfo info{
        .name = "settle", .description = "Spheres settle in a box under gravity.", .divides = true};
    return run_scenario<Settle>(argc, argv, info, check_options, run, explain);
}
