#include "scenarios/specimens/small_scene.hpp"
#include "tests/verification/array.hpp"
#include "tests/verification/cases.hpp"
#include "tests/verification/cluster.hpp"
#include "tests/verification/guided_pair.hpp"
#include "tests/verification/impacts.hpp"

#include <fmt/format.h>

namespace bris::detail {

void verify_array(Checks& checks) {
    ImpactArray s;
    s.impact = on_wall(elastic("Al oxide", 3.8e11, 0.23, 4000, 0.98, 0.092), 0.0025, 3.9,
                       LawName::hertz_mindlin_viscous);
    s.impact.steps_per_contact = 200;
    const ImpactArrayResult hertz = run_experiment(s);
    checks.absolute("93 impacts in one scene, Hertz: largest difference to single impacts", "", 0,
                    hertz.largest_difference, 1e-12);
    // if all impacts slide, the loss of tangential velocity is mu (1 + e) v_n with any spring
    s.impact.law = LawName::linear_viscous;
    s.impact.material.normal_stiffness = s.impact.partner_material.normal_stiffness = 2 * 1.72e7;
    s.impact.material.shear_stiffness = s.impact.partner_material.shear_stiffness = 2 * 1.48e7;
    s.impact.steps_per_contact = 2000;
    s.least_angle = 40 * degree;
    const ImpactArrayResult linear = run_experiment(s);
    checks.absolute("93 impacts in one scene, linear: largest difference to single impacts", "", 0,
                    linear.largest_difference, 1e-12);
    double worst = 0;
    for (std::size_t k = 0; k < linear.angle.size(); ++k) {
        const double exact = 1 - 0.092 * 1.98 / std::tan(linear.angle[k]);
        worst = std::max(worst, std::abs(linear.tangential_restitution[k] / exact - 1));
    }
    checks.absolute("linear, 40 to 85 degrees: error of tangential restitution in full sliding", "",
                    0, worst, 5e-3, 0.05);
}

void verify_contact_pair(Checks& checks) {
    ShearLoop loop;
    for (const double amplitude : {1.5e-5, 5e-5}) {
        loop.amplitude = amplitude;
        const ShearLoopResult r = run_experiment(loop);
        // corners of the loop are cut by up to the displacement of a step: 2 pi / steps of the loop
        checks.relative(fmt::format("shear loop of {:g} mm: dissipated work", 1e3 * amplitude), "J",
                        r.exact, r.work, 2 * pi / loop.steps);
        checks.at_most(fmt::format("shear loop of {:g} mm: largest friction over Coulomb's limit",
                                   1e3 * amplitude),
                       "", 1, r.largest_ratio, 1e-14);
    }
    const RigidTurnResult about_normal =
        run_experiment(RigidTurn{.axis = Vec3::UnitZ(), .steps = 20'000});
    checks.absolute("loaded pair rotated about its normal: relative change of |F_t|", "", 0,
                    about_normal.length_drift, 1e-10);
    // a step moves along a chord, which is shorter than the arc by h^3/24 of the branch vector's
    // length d: 2 pi d h^2 / 24 in a full turn
    for (const unsigned steps : {1000u, 4000u}) {
        const RigidTurn turn{.axis = Vec3(1, 2, 0.5), .steps = steps};
        const double h = 2 * pi / steps,
                     bound = 2 * pi * 2 * turn.radius * h * h / 24 / turn.stretch;
        checks.absolute(
            fmt::format("loaded pair rotated by a full turn in {} steps: relative change of |F_t|",
                        steps),
            "", 0, run_experiment(turn).length_drift, 1.1 * bound);
    }
    checks.relative("rolling: torque over its limit", "", 1,
                    run_experiment(RollAndTwist{.twist = false}) / 0.1, 1e-6);
    checks.relative("twisting: torque over its limit", "", 1,
                    run_experiment(RollAndTwist{.roll = false}) / 0.1, 1e-6);
    checks.relative("rolling and twisting: torque over the limit of one", "", std::sqrt(2.0),
                    run_experiment(RollAndTwist{}) / 0.1, 1e-6);
}

void verify_descriptions(Checks& checks) {
    const auto compared = [&](const std::string& name, const Cluster& cluster,
                              const Description& description, double tolerance) {
        const Difference d = compare(cluster, description);
        checks.absolute(name + ": difference of positions over radius", "", 0,
                        d.position_difference, tolerance);
        checks.absolute(name + ": difference of velocities over impact speed", "", 0, d.motion,
                        100 * tolerance);
        checks.at_least(name + ": mean number of touching pairs", "", 5, d.contacts);
    };
    for (const LawName law : {LawName::linear_rolling, LawName::hertz_mindlin_viscous}) {
        const Cluster s{.law = law};
        const std::string name = is_hertz(law) ? "Hertz, " : "linear, ";
        compared(name + "moving frame, 5 m/s", s, {.boost = Vec3(5, -3, 2)}, 1e-10);
        compared(name + "rotated frame", s, {.rotation = exponential_map(Vec3(0.3, -1, 0.7))},
                 1e-10);
        compared(name + "mirrored frame", s, {.mirrored = true}, 1e-10);
        compared(name + "reversed numbering", s, {.reversed = true}, 1e-10);
        compared(name + "units mm, ms and g", s, {.length = 1e3, .time = 1e3, .mass = 1e3}, 1e-10);
        compared(name + "two threads", s, {.threads = 2}, 0);
        // coordinates of 100 m are rounded to 1e-14 m, 1e-12 of a radius; contacts amplify the
        // error by a factor of some hundred
        compared(name + "frame shifted by 100 m", s, {.offset = Vec3(100, -70, 50)}, 1e-9);
    }
    // local damping depends on the frame by definition, so this check proves that a difference
    // shows
    const Difference damped = compare(Cluster{.local_damping = 0.5}, {.boost = Vec3(5, -3, 2)});
    checks.at_least("local damping, moving frame, 5 m/s: difference of positions over radius", "",
                    0.01, damped.position_difference);
}

} // namespace bris::detail
