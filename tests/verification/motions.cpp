#include "engine/math.hpp"
#include "scenarios/collision/impact.hpp"
#include "scenarios/specimens/small_scene.hpp"
#include "tests/verification/bounce.hpp"
#include "tests/verification/cases.hpp"
#include "tests/verification/impacts.hpp"
#include "tests/verification/rolling_sphere.hpp"

#include <fmt/format.h>

namespace bris::detail {

void verify_bouncing(Checks& checks) {
    struct Contact {
        double stiffness, restitution, begin, in, end, out, overlap;
    };
    // closed forms of a damped linear contact under gravity
    constexpr Contact list[]{{1e4, 1.0, 0.2855686245854129, 2.8014282071829006, 0.3968390511194056,
                              2.8014282072380388, 0.1037499709379679},
                             {1e4, 0.6, 0.2855686245854129, 2.8014282071829006, 0.4012990088045103,
                              1.4919542968856032, 0.08196613494837121},
                             {5e4, 0.9, 0.2855686245854129, 2.8014282071829006, 0.3335751016095159,
                              2.5020331902115767, 0.04132086625795494},
                             {1e5, 0.7, 0.2855686245854129, 2.8014282071829006, 0.3194999803226648,
                              1.9203298613605386, 0.02565683249318441},
                             {1e5, 0.6, 0.2855686245854129, 2.8014282071829006, 0.3198176825979741,
                              1.6262071827447162, 0.024058377516974608}};
    for (const Contact& c : list) {
        Bounce s;
        s.stiffness = c.stiffness;
        s.restitution = c.restitution;
        s.steps_per_contact = 2000;
        const BounceRecord r = run_experiment(s).at(0);
        const auto name = [&](const char* what) {
            return fmt::format("DEM01 k = {:g} N/m, e = {}: {}", c.stiffness, c.restitution, what);
        };
        checks.relative(name("beginning of contact"), "s", c.begin, r.begin, 1e-9);
        checks.relative(name("speed at the beginning of contact"), "m/s", c.in, r.speed_in, 1e-9);
        checks.relative(name("end of contact"), "s", c.end, r.end, 5e-4, 0.05);
        checks.relative(name("speed at the end of contact"), "m/s", c.out, r.speed_out, 5e-4, 0.05);
        checks.relative(name("largest overlap"), "m", c.overlap, r.overlap, 5e-4, 0.05);
    }
    // DEM02: for k bounces the apex height tends to r + (h0 - r) e^(2k), with a difference of first
    // order in 1 / sqrt(stiffness)
    const auto height = [](double stiffness, unsigned bounces, double e) {
        Bounce s;
        s.stiffness = stiffness;
        s.restitution = e;
        s.bounces = bounces;
        s.steps_per_contact = 2000;
        return run_experiment(s).back().apex;
    };
    const double hard = 0.1 + 0.4 * std::pow(0.9, 6);
    const double soft = height(5e4, 3, 0.9) - hard, middle = height(5e5, 3, 0.9) - hard,
                 stiff = height(5e6, 3, 0.9) - hard;
    checks.relative("DEM02 k = 5e6 N/m, e = 0.9: height of the third apex", "m", hard, hard + stiff,
                    0.01, 0.05);
    checks.absolute("DEM02 k = 5e4 to 5e5 N/m: order in 1/sqrt(k) of the difference to hard "
                    "contacts",
                    "", 1, 2 * std::log10(std::abs(soft / middle)), 0.1);
    checks.absolute("DEM02 k = 5e5 to 5e6 N/m: order in 1/sqrt(k) of the difference to hard "
                    "contacts",
                    "", 1, 2 * std::log10(std::abs(middle / stiff)), 0.1);
    checks.relative("DEM02 e = 1: height of the sixteenth apex", "m", 0.5, height(5e4, 16, 1),
                    9.4e-4, 9.4e-4);
}

void verify_stack(Checks& checks) {
    for (const double e : {1.0, 0.9, 0.5}) {
        Stack s;
        s.restitution = e;
        const StackResult r = run_experiment(s);
        checks.absolute(fmt::format("DEM03 e = {}: largest error of height over displacement", e),
                        "", 0, r.largest_error / r.travel, 5e-4, 0.05);
        Stack fine = s;
        fine.step = 0.5 * s.step;
        checks.absolute(fmt::format("DEM03 e = {}: order of the error in dt", e), "", 2,
                        std::log2(r.largest_error / run_experiment(fine).largest_error), 0.15);
    }
}

namespace {

/// A sphere of diameter 1 mm and density 1e4 kg/m3, as in MFiX DEM04.
RollingSphere grain_on_plane(double friction) {
    RollingSphere s;
    s.radius = 5e-4;
    s.material = linear_material(1e4, 8e3, friction, 1e4);
    s.material.normal_damping = s.material.shear_damping = 5e3;
    s.law = LawName::linear_viscous;
    return s;
}

void check_slope(Checks& checks, double degrees, double rolling_friction) {
    RollingSphere s = grain_on_plane(0.5);
    s.law = LawName::linear_rolling;
    s.slope = degrees * degree;
    s.material.rolling_friction = s.material.twisting_friction = rolling_friction;
    s.duration = 0.05;
    const double exact =
        5.0 / 7 * s.gravity * (std::sin(s.slope) - rolling_friction * std::cos(s.slope));
    checks.relative(fmt::format("slope {} degrees, rolling friction {}: acceleration", degrees,
                                rolling_friction),
                    "m/s2", exact, run_experiment(s).acceleration, 1e-3);
}

} // namespace

void verify_rolling(Checks& checks) {
    for (const double friction : {0.2, 0.5, 1.0}) {
        RollingSphere s = grain_on_plane(friction);
        s.speed = 0.1;
        const double slip_time = 2.0 / 7 * s.speed / (friction * s.gravity);
        s.duration = 3 * slip_time;
        s.step = 0.02;
        const RollingSphereResult r = run_experiment(s);
        const auto name = [&](const char* what) {
            return fmt::format("DEM04 friction {}: {}", friction, what);
        };
        checks.relative(name("duration of slip over v0/(mu g)"), "", 2.0 / 7,
                        r.slip_end * friction * s.gravity / s.speed, 5e-3, 4e-4);
        checks.relative(name("final speed over v0"), "", 5.0 / 7, r.speed / s.speed, 2e-4, 5e-6);
        checks.relative(name("final R omega over v0"), "", 5.0 / 7,
                        r.angular_velocity * s.radius / s.speed, 2e-4, 1e-5);
        checks.at_most(name("largest ratio of friction to normal force"), "", friction,
                       r.friction_ratio, 1e-14 * friction);
    }
    check_slope(checks, 15, 0);
    check_slope(checks, 15, 0.05);
    check_slope(checks, 30, 0.1);

    RollingSphere at_rest = grain_on_plane(0.5); // tan 5 degrees = 0.087 < 0.1
    at_rest.law = LawName::linear_rolling;
    at_rest.slope = 5 * degree;
    at_rest.material.rolling_friction = 0.1;
    at_rest.policy.rolling_damping_ratio = 0.3;
    at_rest.duration = 0.1;
    checks.absolute("slope 5 degrees, rolling friction 0.1: acceleration", "m/s2", 0,
                    run_experiment(at_rest).acceleration, 1e-9);

    RollingSphere flat = grain_on_plane(0.5); // rolls from the start and slows down
    flat.law = LawName::linear_rolling;
    flat.material.rolling_friction = 0.1;
    flat.speed = 0.1;
    flat.angular_velocity = flat.speed / flat.radius;
    flat.duration = 0.1;
    checks.relative("flat floor, rolling friction 0.1: acceleration", "m/s2", -5.0 / 7 * 0.1 * 9.81,
                    run_experiment(flat).acceleration, 1e-3);
    flat.policy.rolling_damping_ratio = 0.3;
    flat.duration = 0.5; // it stops after 0.143 s
    const RollingSphereResult stopped = run_experiment(flat);
    checks.at_most("flat floor, after stopping: kinetic energy over initial kinetic energy", "",
                   1e-12, stopped.kinetic_energy / stopped.first_kinetic_energy);

    RollingSphere twisting = grain_on_plane(0.5);
    twisting.law = LawName::linear_rolling;
    twisting.material.twisting_friction = 0.1;
    twisting.twist = 100;
    twisting.duration = 0.01;
    checks.relative("rotation about the normal, twisting friction 0.1: acceleration", "rad/s2",
                    -2.5 * 0.1 * 9.81 / twisting.radius,
                    run_experiment(twisting).twist_acceleration, 1e-3);
}

void verify_local_damping(Checks& checks) {
    for (const double fraction : {0.1, 0.5, 0.7}) {
        checks.relative(
            fmt::format("damping {}: acceleration of a falling sphere over g", fraction), "",
            1 - fraction, run_experiment(DampedFall{.fraction = fraction, .speed = -3}), 1e-12);
        checks.relative(fmt::format("damping {}: acceleration of a rising sphere over g", fraction),
                        "", 1 + fraction,
                        run_experiment(DampedFall{.fraction = fraction, .speed = 3}), 1e-12);
        for (const LawName law : {LawName::linear_frictionless, LawName::hertz_frictionless}) {
            Material m = is_hertz(law) ? elastic("glass", 4.8e10, 0.2, 2800) : linear_material(1e6);
            Impact s = on_wall(m, 0.01, 1, law);
            if (!is_hertz(law)) s.partner_material = m;
            s.local_damping = fraction;
            s.steps_per_contact = 1000;
            checks.relative(fmt::format("damping {}, {}: restitution", fraction,
                                        is_hertz(law) ? "Hertz" : "linear"),
                            "", std::sqrt((1 - fraction) / (1 + fraction)),
                            run_experiment(s).normal_restitution, 1e-4, 0.01);
        }
    }
}

} // namespace bris::detail
