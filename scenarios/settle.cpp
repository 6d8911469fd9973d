// Spheres settle in a box under gravity: the bed on which speed is measured, and the shortest way
// to see a whole run, from options to pictures.
#include "engine/checkpoint_keeper.hpp"
#include "engine/errors.hpp"
#include "engine/io/plot.hpp"
#include "engine/io/series.hpp"
#include "engine/memory.hpp"
#include "engine/progress.hpp"
#include "engine/scenario.hpp"
#include "engine/stopwatch.hpp"
#include "scenarios/specimens/check_scene.hpp"
#include "scenarios/specimens/memory_estimate.hpp"
#include "scenarios/specimens/relax.hpp"
#include "scenarios/specimens/sphere_bed.hpp"
#include "systems/broadphase/lists.hpp"
#include "systems/contact/stable_step.hpp"
#include "systems/output/frames.hpp"
#include "systems/output/porosity.hpp"
#include "systems/output/quantities.hpp"
#include "systems/sleep/sleep.hpp"
#include "systems/steps.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>

namespace {

using namespace bris;

struct Settle {
    SphereBed bed;
    double duration = 0.5, sleep = 0;
    bool relax = false;

    void describe(auto& option) {
        option("spheres", bed.spheres, "", "how many", within(1, 50e6));
        option("radius", bed.radius, "m", "mean of all", above(0));
        option("size_spread", bed.size_spread, "", "radii lie within radius * (1 -+ this), evenly",
               Range{.low = 0, .high = 1, .high_accepted = false});
        option("normal_stiffness", bed.normal_stiffness, "N/m",
               "of a contact; the tangential one is 2/7 of it", above(0));
        option("friction", bed.friction, "", "Coulomb coefficient", at_least(0));
        option("damping_rate", bed.damping_rate, "1/s",
               "of the normal dashpot; half of it, tangential", at_least(0));
        option("density", bed.density, "kg/m3", "of the spheres", above(0));
        option("step", bed.step, "s", "time step", above(0));
        option("duration", duration, "s", "simulated", above(0));
        option("sleep", sleep, "",
               "share of its weight up to which forces on a sphere may be out of balance when it "
               "falls asleep, twice that when it wakes; 0: none sleeps",
               at_least(0));
        option("start_overlap", bed.start_overlap, "",
               "of the mean diameter, by which neighbours overlap at the start", within(0, 1));
        option("relax", relax, "", "let a start with deep overlaps come to rest first");
    }
};

constexpr std::uint64_t samples = 200, samples_per_frame = 4, longest_block = 50;

constexpr LawName law = LawName::linear_viscous;

void relax_start(World& world, unsigned threads) {
    const Relaxed r = relax(world, law, {.threads = threads});
    fmt::print("relaxed in {} steps: largest overlap from {:.3g} to {:.3g} of a diameter, kinetic "
               "energy up to {:.3g} of {:.3g} J stored\n",
               r.steps, r.first_overlap, r.overlap, r.peak_energy, r.stored_energy);
    if (!r.done) throw SimulationError(r.left);
}

/// The bed, checked; a resumed one need not start well.
World make_scene(const Settle& settings, const Common& common) {
    require_memory("spheres", settings.bed.spheres, bytes_of_spheres(settings.bed.spheres),
                   common.memory_limit);
    SphereBed bed = settings.bed;
    bed.seed = common.seed;
    World world = make_sphere_bed(bed);
    check_scene(world, law);
    const bool starts = common.resume.empty() && !common.explain;
    if (starts && settings.relax) relax_start(world, common.threads);
    add_lists(world, law);
    if (settings.sleep > 0)
        add_sleep(world, {.acceleration = settings.sleep * world.resource<Gravity>().value.norm()});
    if (starts) check_overlaps(world);
    return world;
}

/// Share of solids in the inner part of the bed, away from walls, floor and surface.
double solid_fraction(const World& world, double radius) {
    double height = 0, width = 0;
    const BodyFrame frame = frame_of_bodies(world);
    for (const Vec3& x : frame.positions) {
        height += 2 * x.z() / static_cast<double>(frame.positions.size());
        width = std::max(width, 2 * (std::abs(x.x()) + radius));
    }
    const CylinderRegion inside{width / 2 - 2 * radius, 2 * radius, 0.8 * height};
    return inside.radius > radius && inside.high > inside.low + radius
               ? 1 - porosity(world, inside, 120)
               : 0;
}

class Settling {
public:
    Settling(const Settle& settings, const Common& common)
        : settings_(settings), common_(common), total_(steps_of(settings)),
          sample_every_(std::max<std::uint64_t>(1, total_ / samples)),
          simulation_(make_scene(settings, common), steps(law), common.threads,
                      {.serial = common.serial}),
          keeper_({common.out / "settle.ckpt.h5", common.scenario, common.settings,
                   [this](Archive& archive) { series_.save(archive); }}) {
        simulation_.on_restore(forget_lists);
        const double stable = stable_step_of_first_contact(simulation_.world());
        require(settings.bed.step <= stable,
                fmt::format("--step: expected at most the stable step {:.3g} s, found {:.3g} s",
                            stable, settings.bed.step));
    }

    std::string explain() { return simulation_.schedule().explain(); }

    void run() {
        const auto began = this_instant();
        begin();
        try {
            go();
        } catch (const SimulationError& error) {
            const auto path = keeper_.save_stopped(simulation_);
            throw SimulationError(fmt::format("{} (state in {})", error.what(), path.string()));
        }
        keeper_.save(simulation_);
        draw();
        report(began);
    }

private:
    static std::uint64_t steps_of(const Settle& s) {
        const double number = std::round(s.duration / s.bed.step);
        require(number >= 1 && number < 1e15,
                fmt::format("--duration: expected 1 to 1e15 steps of {:.3g} s, found {:.3g}",
                            s.bed.step, number));
        return static_cast<std::uint64_t>(number);
    }

    const World& world() const { return simulation_.world(); }
    std::uint64_t now() const { return world().resource<Clock>().step; }

    void begin() {
        std::string name = "settle";
        if (!common_.resume.empty()) {
            series_.load(resume(simulation_, common_.resume, common_.scenario, common_.settings,
                                {"duration_s"})
                             .state);
            require(
                now() < total_,
                fmt::format(
                    "--duration: expected more than the {:.6g} s of the checkpoint, found {:.6g} s",
                    world().resource<Clock>().time(), settings_.duration));
            name += fmt::format("_from_{}", now()); // the frames until then are in a file already
        }
        first_step_ = now();
        frames_ = std::make_unique<FrameWriter>(common_.out / (name + ".vtkhdf"), common_.settings);
        if (first_step_ == 0) frames_->add(world()); // contacts are known from the first step on
    }

    void go() {
        Progress progress(1, common_.quiet ? Progress::Style::quiet : Progress::Style::automatic);
        while (now() < total_) {
            const std::uint64_t next =
                std::min(total_, (now() / sample_every_ + 1) * sample_every_);
            const auto began = this_instant();
            simulation_.advance(std::min(next - now(), longest_block));
            stepping_ += seconds_since(began);
            if (now() == next) {
                sample();
                if (next % (samples_per_frame * sample_every_) == 0 || next == total_)
                    frames_->add(world());
            }
            progress.report(0, static_cast<double>(now()) / static_cast<double>(total_),
                            fmt::format("settle {:.4f} s, step {}, floor force / weight {:.4f}",
                                        world().resource<Clock>().time(), now(),
                                        floor_force_over_weight()));
            keeper_.attend(simulation_);
        }
    }

    void sample() {
        const double stable = stable_step(world());
        if (settings_.bed.step > stable)
            throw SimulationError(fmt::format(
                "step {}, time {:.6g} s: --step: expected at most the stable step {:.3g} s of the "
                "contacts that have formed, found {:.3g} s",
                now(), world().resource<Clock>().time(), stable, settings_.bed.step));
        last_ = measure(world());
        series_.add({world().resource<Clock>().time(), last_.kinetic_energy, last_.elastic_energy,
                     floor_force_over_weight(), last_.coordination, last_.unbalanced_ratio,
                     stable});
    }

    /// Force of all grains on the box over their weight, along gravity: 1 at rest.
    double floor_force_over_weight() const {
        return last_.weight.z() < 0 ? last_.boundary_force.z() / last_.weight.z() : 0;
    }

    void draw() {
        const auto& time = series_.column("time");
        draw_plots(common_.out / "settle_history.png",
                   {{.title = "motion dies away",
                     .x_label = "time (s)",
                     .y_label = "kinetic energy (J)",
                     .curves = {{.x = time, .y = series_.column("kinetic_energy")}},
                     .y_logarithmic = true},
                    {.title = "the floor takes over the weight",
                     .x_label = "time (s)",
                     .y_label = "floor force / weight",
                     .curves = {{.x = time, .y = series_.column("floor_force_over_weight")}}}});
        const BodyFrame frame = frame_of_bodies(world());
        View view = view_of_bodies(world(), frame, [&](std::size_t place) {
            return scale_colour(std::min(1.0, static_cast<double>(frame.coordination[place]) / 8));
        });
        view.caption = fmt::format("{} spheres after {:.3g} s, blue to yellow: 0 to 8 contacts",
                                   settings_.bed.spheres, frame.time);
        draw_picture(common_.out / "settle.png", {&view, 1});
        series_.write_csv(common_.out / "settle.csv");
        series_.write_track(frames_->file());
        frames_->file().close();
    }

    void report(Instant began) const {
        const auto& lists = world().resource<ListState>();
        const auto done = static_cast<double>(now() - first_step_);
        Summary summary;
        summary.add("wall_s", seconds_since(began));
        summary.add("stepping_s", stepping_);
        summary.add("particle_steps_per_s", done * settings_.bed.spheres / stepping_);
        summary.add("floor_force_over_weight", floor_force_over_weight());
        summary.add("floor_force_error", std::abs(floor_force_over_weight() - 1));
        add_quantities(summary, last_);
        summary.add("solid_fraction", solid_fraction(world(), settings_.bed.radius));
        if (settings_.sleep > 0) summary.add("sleepers", sleepers(world()));
        summary.add("steps", now());
        summary.add("refreshes", lists.refreshes);
        summary.add("prunes", lists.prunes);
        summary.add("fingerprint", hexadecimal(fingerprint(simulation_.snapshot())));
        report_results(common_, summary);
    }

    Settle settings_;
    Common common_;
    std::uint64_t total_, sample_every_, first_step_ = 0;
    Simulation simulation_;
    Series series_{"motion",
                   {{"time", "s"},
                    {"kinetic_energy", "J"},
                    {"elastic_energy", "J"},
                    {"floor_force_over_weight", ""},
                    {"coordination", ""},
                    {"unbalanced_ratio", ""},
                    {"stable_step", "s"}}};
    CheckpointKeeper keeper_;
    std::unique_ptr<FrameWriter> frames_;
    Quantities last_;
    double stepping_ = 0; // s, wall
};

} // namespace

int main(int argc, char** argv) {
    return run_scenario<Settle>(argc, argv, "settle", "spheres settle in a box under gravity",
                                [](const Settle& settings, const Common& common) {
                                    Settling settling(settings, common);
                                    if (common.explain)
                                        std::puts(settling.explain().c_str());
                                    else
                                        settling.run();
                                });
}
