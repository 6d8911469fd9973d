// A sphere falls onto a plane and rebounds. The height of the first rebound has a closed form.
#include "engine/errors.hpp"
#include "engine/io/series.hpp"
#include "engine/run.hpp"
#include "scenarios/specimens/scene.hpp"
#include "scenarios/specimens/start.hpp"

#include <algorithm>
#include <cmath>

namespace {

using namespace bris;

struct Bounce {
    double height = 0.1, restitution = 0.8, step = 2e-6, duration = 0.3;

    void declare_options(auto& option) {
        option("height", height, "m", "Height from which the sphere falls.", within(0.01, 1));
        option("restitution", restitution, "", "Coefficient of restitution.", within(0.1, 1));
        option("step", step, "s", "Time step.", within(1e-7, 2e-5));
        option("duration", duration, "s", "Simulated time.", within(0.01, 10));
    }
};

struct MotionSample {
    double time, height;
    static constexpr auto columns() {
        using S = MotionSample;
        return std::array{Sampled{&S::time, "time", "s"}, Sampled{&S::height, "height", "m"}};
    }
};

constexpr double radius = 0.01, stiffness = 1e6, sample_interval = 1e-3; // m, N/m, s
constexpr EntityId ball = 1; // bodies are numbered as they are added; the floor is body 0

Simulation make_simulation(const Bounce& s, const Common& common) {
    World world = make_world(Grains::spheres);
    Material material = linear_material(stiffness);
    material.restitution = s.restitution;
    const std::uint32_t index = world.resource<Materials>().add(material);
    add_floor(world, index);
    add_sphere(world, Vec3(0, 0, s.height + radius), radius, index);
    world.add_resource<Gravity>();
    world.resource<Clock>().dt = s.step;
    return start(std::move(world), {.law = LawName::linear_viscous, .threads = common.threads});
}

void run(const Bounce& s, const Common& common) {
    const double touch = std::sqrt(2 * s.height / 9.81), apex = touch * (1 + s.restitution);
    require(s.duration > apex, "--duration: expected more than the time of the first rebound");
    Simulation simulation = make_simulation(s, common);
    SeriesOf<MotionSample> motion("motion");
    const auto sample = [&](Simulation& now, std::uint64_t) {
        motion.add({.time = now.world().resource<Clock>().time(),
                    .height = value_of<Position>(now, ball).z() - radius});
        return true;
    };
    Run run(simulation, common, "bounce");
    run.keep(motion);
    if (!common.resume.empty()) run.resume(common.resume, {"duration_s"});
    run.go({run.timed({.name = "bounce",
                       .steps = steps_of(s.duration, s.step, "duration"),
                       .sample_every = steps_of(sample_interval, s.step, "step"),
                       .sample = sample})});

    const auto &time = motion[&MotionSample::time], &height = motion[&MotionSample::height];
    const auto after = std::ranges::upper_bound(time, touch) - time.begin();
    const double rebound = *std::max_element(height.begin() + after, height.end()),
                 exact = s.restitution * s.restitution * s.height;
    motion.write_csv(common.out / "bounce.csv");
    draw_plots(common.out / "bounce.png", {motion.plot(&MotionSample::height)});
    Summary summary;
    summary.add("rebound_height_m", rebound);
    summary.add("rebound_height_error", rebound / exact - 1);
    run.add_to_summary(summary);
    report_results(common, summary);
}

std::string explain(const Bounce& s, const Common& common) {
    return make_simulation(s, common).schedule().explain();
}

} // namespace

int main(int argc, char** argv) {
    return run_scenario<Bounce>(argc, argv, {"bounce", "A sphere falls onto a plane and rebounds."},
                                run, explain);
}
