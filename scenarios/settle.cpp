// Spheres settle in a box under gravity. This is the bed on which speed is measured.
#include "engine/errors.hpp"
#include "engine/io/plot.hpp"
#include "engine/io/series.hpp"
#include "engine/memory.hpp"
#include "engine/run.hpp"
#include "scenarios/specimens/check_scene.hpp"
#include "scenarios/specimens/memory_estimate.hpp"
#include "scenarios/specimens/relax.hpp"
#include "scenarios/specimens/sphere_bed.hpp"
#include "scenarios/specimens/start.hpp"
#include "systems/contact/stable_step.hpp"
#include "systems/output/frames.hpp"
#include "systems/output/quantities.hpp"
#include "systems/sleep/sleep.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace {

using namespace bris;

struct Settle {
    SphereBed bed;
    double duration = 0.5, sleep = 0;
    bool relax = false;

    void describe(auto& option) {
        bed.describe(option);
        option("duration", duration, "s", "Simulated time.", above(0, 1e6));
        option("sleep", sleep, "",
               "Unbalanced force, relative to the weight, below which a sphere falls asleep. It "
               "wakes at twice this value. 0: no sphere sleeps.",
               within(0, 10));
        option("relax", relax, "",
               "Relax deep overlaps of the start before the simulation begins.");
    }
};

constexpr std::uint64_t samples = 200, samples_per_frame = 4;
constexpr LawName law = LawName::linear_viscous;

/// The bed with its neighbour lists and steps. If `relaxed`, the option --relax applies.
Simulation make_simulation(const Settle& settings, const Common& common, bool relaxed) {
    SphereBed bed = settings.bed;
    bed.seed = common.seed;
    require_memory("spheres", bed.spheres, bytes_of_spheres(bed.spheres), common.memory_limit);
    World world = make_sphere_bed(bed);
    if (relaxed && settings.relax) {
        const Relaxed r = relax(world, law, {.threads = common.threads});
        fmt::print("relaxed in {} steps: largest overlap from {:.3g} to {:.3g} of a diameter\n",
                   r.steps, r.first_overlap, r.overlap);
        if (!r.done) throw SimulationError(r.left);
    }
    Simulation simulation =
        start(std::move(world),
              {.law = law, .threads = common.threads, .schedule = {.serial = common.serial}});
    if (settings.sleep > 0) {
        const double weight = simulation.world().resource<Gravity>().value.norm();
        add_sleep(simulation.world(), {.acceleration = settings.sleep * weight});
        simulation.prepare();
    }
    const double stable = stable_step_of_first_contact(simulation.world());
    require(bed.step <= stable,
            fmt::format("--step: expected at most the stable step {:.3g} s, found {:.3g} s", stable,
                        bed.step));
    return simulation;
}

/// Vertical force of all spheres on the box over their weight: 1 at rest.
double floor_force_over_weight(const Quantities& q) {
    return q.weight.z() < 0 ? q.boundary_force.z() / q.weight.z() : 0;
}

Quantities take_sample(const World& world, Series& motion) {
    const Clock& clock = world.resource<Clock>();
    const double stable = stable_step(world);
    if (clock.dt > stable)
        throw SimulationError(
            fmt::format("step {}, time {:.6g} s: --step: expected at most the stable step {:.3g} s "
                        "of the contacts that have formed, found {:.3g} s",
                        clock.step, clock.time(), stable, clock.dt));
    const Quantities now = compute_quantities(world);
    motion.add({clock.time(), now.kinetic_energy, now.elastic_energy, floor_force_over_weight(now),
                now.coordination, now.unbalanced_ratio, stable});
    return now;
}

void draw(const World& world, const Series& motion, const Common& common) {
    const auto panel = [&](const char* title, const char* label, const char* column, bool log) {
        return Plot{.title = title,
                    .x_label = "time (s)",
                    .y_label = label,
                    .curves = {{.x = motion.column("time"), .y = motion.column(column)}},
                    .y_logarithmic = log};
    };
    draw_plots(common.out / "settle_history.png",
               {panel("Decay of the motion", "kinetic energy (J)", "kinetic_energy", true),
                panel("Weight carried by the floor", "floor force / weight",
                      "floor_force_over_weight", false)});
    View view = view_by_coordination(world);
    view.caption = fmt::format("{} spheres after {:.3g} s. Blue to yellow: 0 to 8 contacts.",
                               view.balls.size(), world.resource<Clock>().time());
    draw_picture(common.out / "settle.png", {&view, 1});
}

void run(const Settle& settings, const Common& common) {
    Simulation simulation = make_simulation(settings, common, common.resume.empty());
    const World& world = simulation.world();
    const std::uint64_t total = steps_of(settings.duration, settings.bed.step, "duration"),
                        sample_every = std::max<std::uint64_t>(1, total / samples);
    Series motion("motion", {{"time", "s"},
                             {"kinetic_energy", "J"},
                             {"elastic_energy", "J"},
                             {"floor_force_over_weight", ""},
                             {"coordination", ""},
                             {"unbalanced_ratio", ""},
                             {"stable_step", "s"}});
    Progress progress = make_progress(common);
    Run run(simulation, common, "settle", progress_slot(progress));
    run.keep(motion);
    if (common.resume.empty()) {
        check_overlaps(simulation.world());
    } else {
        run.resume(common.resume, {"duration_s"});
        run.require_steps_left(total, "duration");
    }
    FrameWriter frames(run.file("settle", ".vtkhdf"), common.settings);
    if (!run.is_resumed()) frames.add(world);
    Quantities last;
    const auto sample = [&](Simulation&, std::uint64_t step) {
        last = take_sample(world, motion);
        if (step % (samples_per_frame * sample_every) == 0 || step == total) frames.add(world);
        return true;
    };
    const auto status = [&](const World&) {
        return fmt::format("{:.4f} s, floor force / weight {:.4f}", world.resource<Clock>().time(),
                           floor_force_over_weight(last));
    };
    run.go({run.timed({"settle", total, sample_every, sample, status})});
    draw(world, motion, common);
    motion.write_csv(common.out / "settle.csv");
    motion.write_track(frames.file());
    frames.file().close();
    Summary summary;
    const StepCount& count = simulation.count();
    summary.add("particle_steps_per_s",
                static_cast<double>(count.steps) * settings.bed.spheres / count.wall_time);
    summary.add("floor_force_over_weight", floor_force_over_weight(last));
    summary.add("floor_force_error", std::abs(floor_force_over_weight(last) - 1));
    add_quantities(summary, last);
    if (settings.sleep > 0) summary.add("sleepers", sleepers(world));
    summary.add("rebuilds", world.resource<ListState>().rebuilds);
    summary.add("prunes", world.resource<ListState>().prunes);
    run.describe(summary);
    report_results(common, summary);
}

std::string explain(const Settle& settings, const Common& common) {
    return make_simulation(settings, common, false).schedule().explain();
}

} // namespace

int main(int argc, char** argv) {
    return run_scenario<Settle>(argc, argv, {"settle", "Spheres settle in a box under gravity."},
                                run, explain);
}
