#include "components/body.hpp"
#include "components/kinds.hpp"
#include "components/sphere.hpp"
#include "engine/assets.hpp"
#include "scenarios/rocks/clump_library.hpp"
#include "scenarios/rocks/mass_properties.hpp"
#include "scenarios/specimens/scene.hpp"
#include "tests/verification/cases.hpp"
#include "tests/verification/surface_integral.hpp"
#include "tests/verification/top.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>

namespace bris::detail {

namespace {

/// Differences, relative to its size, between the mass properties with which a clump moves and
/// those of the spheres with which it touches others.
struct ClumpError {
    double mass = 0, centre = 0, inertia = 0;
};

ClumpError error_of(const Clump& clump) {
    World world = make_world(Grains::clumps);
    const double density = 2750;
    const auto material = world.resource<Materials>().add(linear_material(1e6, 1e6, 0.5, density));
    const EntityId body =
        add_clump(world, clump, 0, Vec3::Zero(), Quat(Quat::Identity()), material);
    std::vector<Ball> balls;
    const auto parent = world.column<Spheres, ParentId>();
    for (Row k = 0; k < parent.size(); ++k)
        if (parent[k] == body) balls.push_back(world.column<Spheres, LocalBall>()[k]);
    const MassProperties found = surface_integrals(balls, 40000);
    const Mat3 inertia = value_of<Inertia>(world, body).asDiagonal();
    return {std::abs(density * found.volume / value_of<Mass>(world, body) - 1),
            found.centre.norm() / clump.sieve,
            (density * found.inertia - inertia).norm() / inertia.norm()};
}

} // namespace

void verify_top(Checks& checks) {
    // Jacobi's solution for I = (1, 2, 3), angular velocity (1, 0, 1) and identity attitude at t =
    // 0
    const FreeTop exact(Vec3(1, 2, 3), Vec3(1, 0, 1));
    const Vec3 at_ten(-9.210699984443332e-01, 3.893970441153297e-01, 9.744006605830824e-01);
    const Quat turned(8.614411740654798e-01, 1.073407576201552e-01, 2.209473217943740e-01,
                      -4.444989835422690e-01);
    checks.absolute("Jacobi's solution at t = 10: error of angular velocity", "rad/s", 0,
                    (exact.angular_velocity(10) - at_ten).norm(), 1e-12);
    checks.absolute("Jacobi's solution at t = 10: error of attitude", "rad", 0,
                    2 * (exact.attitude(10, 4000).conjugate() * turned).vec().norm(), 1e-11);
    checks.relative("period of the angular velocity", "s", 6.935667541031740, exact.period(),
                    1e-13);

    Top top;
    const TopResult r = run_experiment(top);
    checks.absolute("0.05 rad per step, t = 10: error of attitude", "rad", 0, r.attitude_error,
                    1e-3, 1e-4);
    checks.absolute("0.05 rad per step, t = 10: error of angular velocity", "rad/s", 0,
                    r.angular_velocity_error, 1e-3);
    checks.absolute("0.05 rad per step, t = 10: drift of angular momentum", "", 0, r.momentum_drift,
                    1e-14, 1e-14);
    checks.absolute("0.05 rad per step, t = 10: drift of energy", "", 0, r.energy_drift, 1e-5,
                    1e-4);
    top.angle_per_step = 0.1;
    checks.at_least("order in dt of the attitude error", "", 4,
                    std::log2(run_experiment(top).attitude_error / r.attitude_error), 0.3);
    top = {.inertia = Vec3(1, 1.35, 1.6),
           .angular_velocity = Vec3(0.9, 0.3, 0.8),
           .angle_per_step = 0.05,
           .duration = 20};
    checks.absolute("I = (1, 1.35, 1.6), t = 20: error of attitude", "rad", 0,
                    run_experiment(top).attitude_error, 1e-3, 1e-4);
    top.angular_velocity = Vec3(1e-3, 1.2, 1e-3); // flips periodically (Dzhanibekov effect)
    checks.absolute("rotation about the middle axis, t = 20: error of attitude", "rad", 0,
                    run_experiment(top).attitude_error, 1e-3);
    top.angle_per_step = 1e-2;
    top.duration = 2e3;
    const TopResult drift = run_experiment(top);
    checks.absolute("2 10^5 steps: drift of the quaternion's norm", "", 0, drift.norm_drift, 1e-14);
    checks.absolute("2 10^5 steps: drift of energy", "", 0, drift.energy_drift, 1e-6);
}

void verify_pendulum(Checks& checks) {
    for (const double amplitude : {0.01, 0.2, 0.6}) {
        Pendulum s;
        s.amplitude = amplitude;
        const PendulumResult r = run_experiment(s);
        checks.relative(fmt::format("period at an amplitude of {} rad", amplitude), "s",
                        r.exact_period, r.period, 1e-5, 1e-3);
        checks.absolute(fmt::format("drift of an amplitude of {} rad", amplitude), "", 0,
                        r.amplitude_drift, 1e-5);
    }
}

void verify_mass_properties(Checks& checks) {
    const std::vector<Ball> dumbbell{{Vec3(0, 0, -0.5), 1}, {Vec3(0, 0, 0.5), 1}};
    const MassProperties two = union_properties(dumbbell);
    checks.relative("two unit spheres, 1 m apart: volume", "m3", 7.0685834706, two.volume, 1e-5);
    checks.relative("two unit spheres: moment of inertia about the axis", "m5", 3.0041479750,
                    two.inertia(2, 2), 1e-5);
    checks.relative("two unit spheres: moment of inertia across the axis", "m5", 5.2130803096,
                    two.inertia(0, 0), 1e-5);
    // thirty spheres from a congruential generator with seed 20260101; their exact properties come
    // from an independent quadrature
    std::uint64_t state = 20260101;
    const auto uniform = [&] {
        state = state * 6364136223846793005u + 1442695040888963407u;
        return static_cast<double>(state >> 11) * 0x1p-53;
    };
    std::vector<Ball> balls;
    while (balls.size() < 30) {
        const double x = 2 * uniform() - 1, y = 2 * uniform() - 1, z = 2 * uniform() - 1;
        if (x * x + y * y + z * z <= 1)
            balls.push_back({{0.7 * x, 0.525 * y, 0.385 * z}, 0.25 + 0.2 * uniform()});
    }
    const MassProperties thirty = union_properties(balls);
    Vec3 moments = principal_axes(thirty.inertia).moments;
    std::sort(moments.begin(), moments.end());
    checks.relative("thirty spheres: volume", "m3", 2.05183007628935, thirty.volume, 1e-5, 1e-3);
    checks.relative("thirty spheres: smallest principal moment", "m5", 0.43984187194670005,
                    moments[0], 1e-5, 1e-3);
    checks.relative("thirty spheres: middle principal moment", "m5", 0.5918501957691908, moments[1],
                    1e-5, 1e-3);
    checks.relative("thirty spheres: largest principal moment", "m5", 0.6331898178576105,
                    moments[2], 1e-5, 1e-3);
    checks.absolute(
        "thirty spheres: error of the centre of mass", "m", 0,
        (thirty.centre - Vec3(0.022828962235314883, 0.06147086599256847, 0.017259660955615014))
            .norm(),
        1e-5);
    ClumpError worst;
    for (const Clump& clump : read_clumps(assets_folder() / "clumps")) {
        const ClumpError e = error_of(clump);
        worst = {std::max(worst.mass, e.mass), std::max(worst.centre, e.centre),
                 std::max(worst.inertia, e.inertia)};
    }
    checks.absolute("clumps of the library in a scene, spheres against mass: largest error", "", 0,
                    worst.mass, 5e-4);
    checks.absolute("clumps of the library in a scene: centre of mass over size, largest error", "",
                    0, worst.centre, 2e-4);
    checks.absolute("clumps of the library in a scene: moments of inertia, largest error", "", 0,
                    worst.inertia, 5e-4);
}

} // namespace bris::detail
