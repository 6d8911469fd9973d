// S2: a torque-free rigid body, compared with Jacobi's solution. S3: a gas of 64 smooth elastic
// spheres, whose energy must be constant.
#include "engine/choice.hpp"
#include "engine/random.hpp"
#include "scenarios/specimens/small_scene.hpp"
#include "tests/performance/time_vs_error/scene.hpp"
#include "tests/verification/gas.hpp"
#include "tests/verification/top.hpp"

#include <fmt/format.h>

namespace bris::time_vs_error {

namespace {

/// Seed 1 is the standard top with moments 1, 2, 3 and angular velocity (1, 0, 1). The tops of
/// other seeds are random.
Top top_of(std::uint64_t seed) {
    Top top;
    if (seed == 1) return top;
    Random random(seed, 1);
    const double middle =
        random.uniform(1.3, 2.2); // the largest moment must be below the sum of the others
    top.inertia = Vec3(1, middle, random.uniform(middle + 0.1, middle + 0.8));
    top.angular_velocity = random.direction() * std::sqrt(2.0);
    return top;
}

Outcome run_top(const Settings& settings, std::uint64_t seed) {
    Top top = top_of(seed);
    top.duration = 20;
    top.angle_per_step = settings.number("step");
    TopResult r;
    Outcome outcome;
    outcome.wall_time = median_time(9, 0.3, [&] { r = run_experiment(top); });
    outcome.steps = r.steps;
    outcome.measured = {{r.attitude_error, 0}, {r.momentum_drift, 0}, {r.energy_drift, 0}};
    outcome.fingerprint = fingerprint_of(outcome.measured);
    return outcome;
}

Outcome run_gas(const Settings& settings, std::uint64_t seed) {
    Gas gas;
    gas.material = linear_material(1e6);
    gas.material.young_modulus = 1e8;
    gas.material.poisson_ratio = 0.25;
    gas.law = named<LawName>(settings.word("law"));
    gas.steps_per_contact = 1 / settings.number("step");
    gas.contacts_long = 60;
    gas.seed = seed;
    GasResult r;
    Outcome outcome;
    outcome.wall_time = median_time(1, 0, [&] { r = run_experiment(gas); });
    outcome.steps = r.steps;
    outcome.contacts = r.contacts;
    outcome.measured = {{r.largest_change, 0}, {r.largest_gain, 0}};
    outcome.fingerprint = fingerprint_of(outcome.measured);
    // a collision lasts one contact time
    outcome.note = fmt::format("about {:.0f} collisions", r.contacts * gas.contacts_long);
    return outcome;
}

} // namespace

Scene free_top() {
    Scene scene{"S2", "free rotation, T = 20 s", {{"step", "0.05"}}, {}, {}, run_top, "20 s"};
    scene.kinds = {{"attitude_rad", 1e-4, false, true},
                   {"momentum", 1e-6, false, true},
                   {"energy", 1e-4, false, true}};
    scene.knobs = {{"step (rad)", "step", {"0.4", "0.2", "0.1", "0.05", "0.02", "0.01", "0.005"}}};
    return scene;
}

Scene gas() {
    Scene scene{"S3",
                "gas of 64 elastic spheres",
                {{"step", "0.02"}, {"law", "linear_frictionless"}},
                {},
                {},
                run_gas,
                "run"};
    scene.kinds = {{"energy_change", 1e-3, false, true}, {"energy_gain", 1e-3, false, true}};
    const std::vector<std::string> steps{"0.1", "0.05", "0.02", "0.01", "0.005"};
    for (const std::string law : {"linear", "hertz"})
        scene.knobs.push_back({"step, " + law, "step", steps, {{"law", law + "_frictionless"}}});
    return scene;
}

} // namespace bris::time_vs_error
