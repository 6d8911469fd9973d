// A torque-free rigid body, compared with Jacobi's solution, or a compound pendulum that swings
// about one of its spheres, compared with its exact period.
#include "scenarios/verification/top.hpp"

#include "engine/errors.hpp"
#include "engine/scenario.hpp"
#include "engine/summary.hpp"
#include "scenarios/verification/names.hpp"

namespace {

using namespace bris;

struct Turning {
    Top top;
    Pendulum pendulum;
    std::string kind = "free";

    void describe(auto& option) {
        option("kind", kind, "",
               "Experiment. free: a rigid body rotates without torque. pendulum: a body swings "
               "about one of its spheres, which lies in a smooth groove.",
               {"free", "pendulum"});
        option.group("Free rotation");
        option("inertia_1", top.inertia.x(), "kg m2", "Smallest principal moment of inertia.",
               above(0, 1e9));
        option("inertia_2", top.inertia.y(), "kg m2", "Middle principal moment of inertia.",
               above(0, 1e9));
        option("inertia_3", top.inertia.z(), "kg m2", "Largest principal moment of inertia.",
               above(0, 1e9));
        option("angular_velocity_1", top.angular_velocity.x(), "rad/s",
               "Initial angular velocity about the axis of the smallest moment.",
               within(-1e7, 1e7));
        option("angular_velocity_2", top.angular_velocity.y(), "rad/s",
               "Initial angular velocity about the axis of the middle moment.", within(-1e7, 1e7));
        option("angular_velocity_3", top.angular_velocity.z(), "rad/s",
               "Initial angular velocity about the axis of the largest moment.", within(-1e7, 1e7));
        option("angle_per_step", top.angle_per_step, "rad",
               "Angle by which the body rotates in a time step.", above(0, 3));
        option("duration", top.duration, "s", "Simulated time.", above(0, 1e6));
        option.group("Pendulum");
        option("arm", pendulum.arm, "m",
               "Distance from the centre of mass to the centre of the sphere in the groove.",
               above(0, 1e3));
        option("ball_radius", pendulum.radius, "m", "Radius of the sphere in the groove.",
               above(0, 1e3));
        option("mass", pendulum.mass, "kg", "Mass of the body.", above(0, 1e9));
        option("inertia", pendulum.inertia.y(), "kg m2",
               "Moment of inertia about the centre of mass, for the axis of the swing.",
               above(0, 1e9));
        option("amplitude", pendulum.amplitude, "rad", "Initial angle of the pendulum.",
               between(0, pi / 4));
        option("gravity", pendulum.gravity, "m/s2", "Acceleration of gravity.", above(0, 1e3));
        option("stiffness_ratio", pendulum.stiffness_ratio, "",
               "Contact stiffness times arm over weight.", above(10, 1e15));
        option("step_share", pendulum.step_share, "",
               "Time step as a fraction of sqrt(m/k), with the contact stiffness k.", above(0, 1));
        option("swings", pendulum.swings, "", "Number of full swings.", within(1, 1000));
    }
};

Summary results_of(const TopResult& r) {
    Summary t;
    t.add("step_s", r.dt);
    t.add("steps", r.steps);
    t.add("angular_velocity_1_rad_per_s", r.angular_velocity.x());
    t.add("angular_velocity_2_rad_per_s", r.angular_velocity.y());
    t.add("angular_velocity_3_rad_per_s", r.angular_velocity.z());
    t.add("angular_velocity_error_rad_per_s", r.angular_velocity_error);
    t.add("attitude_error_rad", r.attitude_error);
    t.add("angular_momentum_drift", r.momentum_drift);
    t.add("energy_drift", r.energy_drift);
    t.add("quaternion_norm_drift", r.norm_drift);
    return t;
}

Summary results_of(const PendulumResult& r) {
    Summary t;
    t.add("period_s", r.period);
    t.add("exact_period_s", r.exact_period);
    t.add("period_error", r.period / r.exact_period - 1);
    t.add("amplitude_drift", r.amplitude_drift);
    t.add("pivot_travel_over_arm", r.pivot_travel);
    t.add("steps", r.steps);
    return t;
}

void check_options(const Turning& settings, const Common&) {
    settings.kind == "free" ? check(settings.top) : check(settings.pendulum);
}

void run(const Turning& settings, const Common& common) {
    const Summary results = settings.kind == "free" ? results_of(run_experiment(settings.top))
                                                    : results_of(run_experiment(settings.pendulum));
    report_results(common, results);
}

std::string explain(const Turning&, const Common&) {
    return explain_step(LawName::linear_frictionless, Grains::clumps);
}

} // namespace

int main(int argc, char** argv) {
    return run_scenario<Turning>(
        argc, argv,
        {"top", "A rigid body rotates without torque, or swings as a compound pendulum.",
         "a run always starts from the beginning"},
        check_options, run, explain);
}
