// A ball with a sensor collides with others, and a model assimilates its recording. This is the
// analytic check of sensor fusion, after Liu, Huang, Qiu and Shen (2018), J. Comput. Civ. Eng. 32:
// two balls in a head-on collision, two in an oblique collision, and many balls.
#include "scenarios/collision/collide.hpp"

#include "engine/choice.hpp"
#include "engine/errors.hpp"
#include "engine/io/csv.hpp"
#include "engine/scenario.hpp"
#include "engine/summary.hpp"
#include "scenarios/specimens/small_scene.hpp"
#include "systems/fusion/sensor_filter.hpp"

namespace {

using namespace bris;

Material glass() {
    Material m;
    m.name = "ball";
    m.density = 2500;
    m.young_modulus = 1e9;
    m.poisson_ratio = 0.25;
    m.normal_stiffness = 1e6;
    m.shear_stiffness = 8e5;
    m.friction = 0;
    m.restitution = 0.9;
    return m;
}

/// The laws whose coefficients materials alone state: a pair of balls has none of its own.
std::vector<std::string> laws_of_materials() {
    auto names = texts_of(LawName{});
    std::erase_if(names, [](const std::string& name) {
        return !traits(named<LawName>(name)).of_pairs.empty();
    });
    return names;
}

struct CollideSettings {
    Collide collide;
    Material material = glass();
    std::string law = "hertz_mindlin_viscous";

    void declare_options(auto& option) {
        option.group("Balls");
        option("balls", collide.balls, "", "Number of balls, including the one with the sensor.",
               within(2, 1000));
        option("radius", collide.radius, "m", "Radius of a ball.", above(0, 1e3));
        option("offset", collide.offset, "",
               "Distance of the first ball's path from the centre of the ball that it hits, in "
               "radii.",
               within(-1.9, 1.9));
        option("speed", collide.speed, "m/s", "Initial speed of the first ball.", above(0, 1e4));
        option("gap", collide.gap, "m", "Distance that the first ball flies before the collision.",
               above(0, 1e3));
        option("after", collide.after, "s", "Simulated time after the first touch.", above(0, 1e3));
        option("friction", material.friction, "", "Coulomb friction coefficient between balls.",
               within(0, 100));
        option("restitution", material.restitution, "", "Coefficient of restitution between balls.",
               within(0, 1));
        option("law", law, "", "Contact law.", laws_of_materials());
        constexpr double rigid = 1e30; // N/m or Pa: no softer than a rigid wall
        option("density", material.density, "kg/m3", "Density of the balls.", above(0, 1e6));
        option("young_modulus", material.young_modulus, "Pa",
               "Young's modulus of the balls for Hertz laws.", above(0, rigid));
        option("poisson_ratio", material.poisson_ratio, "",
               "Poisson's ratio of the balls for Hertz laws.", above(-1, 0.5));
        option("normal_stiffness", material.normal_stiffness, "N/m",
               "Normal stiffness of the balls for linear laws, in series with the partner's.",
               above(0, rigid));
        option("shear_stiffness", material.shear_stiffness, "N/m",
               "Tangential stiffness of the balls for linear laws, in series with the partner's.",
               within(0, rigid));
        option.group("Model");
        option("model_speed", collide.model_speed, "",
               "Speed of the model's first ball, relative to the true speed.", above(0, 1e3));
        option("model_offset", collide.model_offset, "",
               "Error of the model's path, in radii. It is added to the offset.",
               within(-1.9, 1.9));
        option("model_restitution", collide.model_restitution, "",
               "Coefficient of restitution in the model. Below 0: the true one.", within(-1, 1));
        option.group("Sensor");
        option("filter", collide.filter.kind, "",
               "Filter that turns measurements into corrections. printed: the filter as the "
               "SmartRock report prints it. corrected: the same filter without its errors.");
        option("sampling_rate", collide.sampling_rate, "Hz",
               "Sampling rate of the first ball's sensor.", above(0, 1e7));
        option("position_noise", collide.position_noise, "m",
               "Standard deviation of measured positions. Below 0: positions are not measured.",
               within(-1, 100));
        option("velocity_noise", collide.velocity_noise, "m/s",
               "Standard deviation of measured velocities. Below 0: velocities are not measured.",
               within(-1, 1e4));
        option("position_deviation", collide.filter.position, "m",
               "Standard deviation of the position of the model's first ball at the start.",
               above(0, 100));
        option("velocity_deviation", collide.filter.velocity, "m/s",
               "Standard deviation of the velocity of the model's first ball at the start.",
               above(0, 1e4));
        option("acceleration_density", collide.filter.acceleration_density, "(m/s2)2/Hz",
               "Spectral density of the model error in acceleration (white noise).",
               within(0, 1e15));
        option("gate", collide.filter.gate, "",
               "Probability with which the filter accepts a correct measurement. 1: it accepts all "
               "measurements.",
               within(0.5, 1));
        option("injection_steps", collide.injection_steps, "",
               "Number of time steps over which a correction of the position is applied. 1: direct "
               "insertion.",
               within(1, 1e6));
        option.group("Accuracy");
        option("steps_per_contact", collide.steps_per_contact, "",
               "Number of time steps in the undamped contact time.", above(1, 1e8));
    }
    CollideSettings() {
        collide.filter.velocity = 0.2;
        collide.filter.position = 1e-3;
    }
};

Collide completed(const CollideSettings& settings, const Common& common) {
    Collide s = settings.collide;
    s.law = named<LawName>(settings.law);
    s.material = settings.material;
    s.seed = common.seed;
    return s;
}

void check_options(const CollideSettings& settings, const Common& common) {
    check(completed(settings, common));
}

void run(const CollideSettings& settings, const Common& common) {
    const CollideResult r = run_experiment(completed(settings, common));
    std::vector<std::vector<double>> rows;
    for (std::size_t k = 0; k < r.truth.size(); ++k)
        rows.push_back({static_cast<double>(k), r.truth[k].x(), r.truth[k].y(), r.free[k].x(),
                        r.free[k].y(), r.fused[k].x(), r.fused[k].y()});
    write_csv(common.out / "velocities.csv",
              {"ball", "true_x_m_per_s", "true_y_m_per_s", "free_x_m_per_s", "free_y_m_per_s",
               "fused_x_m_per_s", "fused_y_m_per_s"},
              rows);
    Summary t;
    t.add("free_error_of_others_m_per_s", r.free_error);
    t.add("fused_error_of_others_m_per_s", r.fused_error);
    t.add("error_ratio", r.fused_error / r.free_error);
    t.add("error_of_first_at_touch_m_per_s", r.error_at_touch);
    t.add("error_of_second_m_per_s", r.carried_error);
    t.add("error_of_second_by_momentum_m_per_s", r.expected_error);
    t.add("error_of_second_beside_momentum_m_per_s", (r.carried - r.expected).norm());
    t.add("measurements_accepted", r.accepted);
    t.add("measurements_refused", r.refused);
    t.add("fusion_work_J", r.fusion_work);
    t.add("energy_error_J", r.energy_error);
    t.add("steps", r.steps);
    report_results(common, t);
}

/// A step of two balls on a plane.
std::string explain(const CollideSettings& settings, const Common& common) {
    const Collide s = completed(settings, common);
    World world = make_world(Grains::spheres);
    const auto material = world.resource<Materials>().add(s.material);
    add_floor(world, material);
    for (const double x : {0.0, 2 * s.radius})
        add_sphere(world, Vec3(x, 0, s.radius), s.radius, material);
    return begin(std::move(world), {.dt = 1e-5, .law = s.law, .unlimited = true})
        .schedule()
        .explain();
}

} // namespace

int main(int argc, char** argv) {
    return run_scenario<CollideSettings>(
        argc, argv,
        {"collide",
         "A ball with a sensor collides with others, and a model assimilates its recording.",
         "a run of a collision takes only a moment"},
        check_options, run, explain);
}
