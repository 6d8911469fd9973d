#include "components/laws/table.hpp"
#include "tests/about.hpp"
#include "tests/support.hpp"

#include <doctest/doctest.h>

using namespace bris;
using namespace bris::testing;

namespace {

/// One contact of the linear law, the same in all lanes.
struct Contact {
    double kn = 1e6, ks = 5e5, friction = 0.5, dt = 1e-3;
    SpringLanes spring{};

    Vec3 step(const Vec3& normal, double overlap, const Vec3& u, double twist) {
        ContactLanes c{lanes(normal.x()), lanes(normal.y()), lanes(normal.z()),
                       lanes(overlap),    lanes(1),          lanes(0.005)};
        c.ux = lanes(u.x());
        c.uy = lanes(u.y());
        c.uz = lanes(u.z());
        c.twist = lanes(twist);
        const CoefficientLanes k{lanes(kn), lanes(ks), lanes(friction), lanes(0),
                                 lanes(0),  lanes(0),  lanes(0)};
        RollLanes no_roll{};
        const ForceLanes f =
            Linear::force(c, k, RollingLanes{}, LawStep({}, dt, false), spring, no_roll);
        return {f.x[0], f.y[0], f.z[0]};
    }
};

Vec3 tangential(const Vec3& force, const Vec3& normal) {
    return force - force.dot(normal) * normal;
}

/// Largest relative change of the tangential force, and its final angle error (rad), when a loaded
/// pair is rotated once about `axis` as one rigid body in `steps` steps.
struct Turned {
    double length, angle;
};
Turned turn_once(const Vec3& axis, const Vec3& normal, const Vec3& stretch, int steps) {
    Contact contact;
    contact.friction = 1e9;
    contact.spring = {lanes(stretch.x()), lanes(stretch.y()), lanes(stretch.z()), lanes(1)};
    const double rate = 2 * pi / (steps * contact.dt);
    Vec3 first = Vec3::Zero(), last = Vec3::Zero();
    double worst = 0;
    for (int k = 0; k <= steps; ++k) {
        const Vec3 n = exponential_map(2 * pi * k / steps * axis) * normal;
        // rigid rotation: no relative velocity at the contact, both bodies have the same angular
        // velocity
        last = tangential(contact.step(n, 1e-4, Vec3::Zero(), k > 0 ? rate * axis.dot(n) : 0), n);
        if (k == 0) first = last;
        worst = std::max(worst, std::abs(last.norm() / first.norm() - 1));
    }
    return {worst, std::acos(std::clamp(first.normalized().dot(last.normalized()), -1.0, 1.0))};
}

/// Growth factor of the amplitude of a free tangential oscillation over a number of steps, and that
/// number.
std::pair<double, int> tangential_growth(double omega_dt) {
    const double radius = 0.01, kn = 1e6, ks = 4e5, g = 100;
    World world = make_world(Grains::spheres);
    const auto material = add_material(world, linear_material(kn, ks, 1e6));
    add_floor(world, material);
    const EntityId ball = add_sphere(world, Vec3::Zero(), radius, material);
    const double mass = value_of<Mass>(world, ball), overlap = mass * g / kn,
                 arm = radius - 0.5 * overlap;
    const double dt =
        omega_dt / std::sqrt(ks / mass + ks * arm * arm / value_of<SphereInertia>(world, ball));
    value_of<Position>(world, ball) = Vec3(0, 0, radius - overlap);
    value_of<Velocity>(world, ball) = Vec3(1e-4, 0, 0);
    world.add_resource<Gravity>({Vec3(0, 0, -g)});
    Simulation sim = begin(std::move(world), {.dt = dt});
    // the largest force over many periods
    const auto amplitude = [&] {
        double most = 0;
        for (int k = 0; k < 1000; ++k) {
            sim.advance();
            most = std::max(most, std::abs(value_of<Force>(sim, ball).x()));
        }
        return most;
    };
    const double before = amplitude();
    sim.advance(1000);
    return {amplitude() / before, 2000};
}

} // namespace

TEST_SUITE("physics/tangential") {
    TEST_CASE("friction never exceeds the Coulomb limit") {
        Random random(23, 0);
        double worst = 0;
        for (int run = 0; run < 50; ++run) {
            Contact contact;
            contact.friction = random.uniform(0, 1);
            Vec3 normal = random.direction();
            for (int k = 0; k < 200; ++k) {
                normal = (normal + 0.1 * random.direction()).normalized();
                const double overlap = random.uniform(0, 1e-4);
                const Vec3 force =
                    contact.step(normal, overlap, 0.3 * random.direction(), 30 * random.normal());
                const double limit = contact.friction * contact.kn * overlap;
                worst = std::max(worst, tangential(force, normal).norm() - limit * (1 + 1e-14) -
                                            1e-14 * force.norm());
            }
        }
        CHECK(worst <= 0);
    }

    TEST_CASE("a loaded pair that rotates once as one rigid body keeps its tangential force") {
        const Vec3 n(0, 0, 1), stretch(3e-6, 4e-6, 0);
        // rotation of the normal, spin about the normal, a cone, and a general axis
        for (const Vec3& axis : {Vec3(1, 0, 0), Vec3(0, 0, 1), Vec3(Vec3(1, 0, 1).normalized()),
                                 Vec3(Vec3(1, 2, 3).normalized())}) {
            const Turned coarse = turn_once(axis, n, stretch, 100),
                         fine = turn_once(axis, n, stretch, 200),
                         finest = turn_once(axis, n, stretch, 100'000);
            MESSAGE("axis ", axis.transpose(), ": |F_t| drifts by ", finest.length,
                    " in 10^5 steps; error of its direction ", coarse.angle, " rad in 100 steps, ",
                    fine.angle, " in 200, ", finest.angle, " in 10^5");
            CHECK(coarse.length < 1e-13);
            CHECK(finest.length < 1e-10); // each step rounds the length by eps
            // The direction is of first order in the angle h of a step. Projecting the spring onto
            // the new tangent plane shortens its component along the rotation by cos h, and the
            // whole is then scaled back, so the angle to the rotation changes by up to h^2/4 per
            // step, pi^2/N per revolution; the twist adds h^3/3 per step.
            for (const auto& [turned, steps] :
                 {std::pair(coarse, 100.0), std::pair(fine, 200.0), std::pair(finest, 1e5)}) {
                const double h = 2 * pi / steps;
                CHECK(turned.angle < pi * pi / steps + 2 * pi * h * h / 3 + 1e-7);
            }
        }
    }

    TEST_CASE("a periodic shear loop at constant normal force dissipates 4 mu N (A - mu N / ks)") {
        const double amplitude = 2e-4, overlap = 1e-4;
        Contact contact;
        contact.dt = 1;
        const double normal_force = contact.kn * overlap, limit = contact.friction * normal_force;
        const int steps = 20'000;
        double work = 0;
        for (int cycle = 0; cycle < 2; ++cycle) {
            work = 0;
            for (int k = 0; k < steps; ++k) {
                const double phase = 2 * pi * k / steps;
                const double velocity = amplitude * std::cos(phase) * 2 * pi / steps;
                work -=
                    contact.step(Vec3(0, 0, 1), overlap, Vec3(velocity, 0, 0), 0).x() * velocity;
            }
        }
        const double exact = 4 * limit * (amplitude - limit / contact.ks);
        // the corners of the loop are cut off within one step of displacement: 2 pi A / steps of
        // the loop
        CHECK(work == about(exact).epsilon(2 * pi / steps));
    }

    TEST_CASE("a sphere on its tangential spring follows the closed form to second order in dt") {
        const double radius = 0.01, kn = 1e6, ks = 4e5, pull = 2.0, g = 100;
        const auto error_at = [&](int steps) {
            World world = make_world(Grains::spheres);
            const auto material = add_material(world, linear_material(kn, ks, 1e6));
            add_floor(world, material);
            const EntityId ball = add_sphere(world, Vec3::Zero(), radius, material);
            const double mass = value_of<Mass>(world, ball),
                         inertia = value_of<SphereInertia>(world, ball);
            const double overlap = mass * g / kn, arm = radius - 0.5 * overlap;
            const double omega2 = ks / mass + ks * arm * arm / inertia;
            const double time = 2.3 * 2 * pi / std::sqrt(omega2), dt = time / steps;
            value_of<Position>(world, ball) = Vec3(0, 0, radius - overlap);
            value_of<Velocity>(world, ball) = Vec3(-0.5 * dt * pull, 0, 0); // at rest at t = 0
            world.add_resource<Gravity>({Vec3(pull, 0, -g)});
            Simulation sim = begin(std::move(world), {.dt = dt});
            sim.advance(static_cast<std::uint64_t>(steps));
            // x'' = pull - ks s / m, s'' = pull - omega2 s from rest
            const double exact =
                0.5 * pull * time * time -
                ks / mass * pull / omega2 *
                    (0.5 * time * time - (1 - std::cos(std::sqrt(omega2) * time)) / omega2);
            return std::abs(value_of<Position>(sim, ball).x() / exact - 1);
        };
        const double coarse = error_at(100), middle = error_at(200), fine = error_at(400);
        MESSAGE("tangential spring: errors ", coarse, ", ", middle, ", ", fine, ", orders ",
                order_of(coarse, middle), ", ", order_of(middle, fine));
        CHECK(order_of(coarse, middle) > 1.85);
        CHECK(order_of(middle, fine) > 1.9);
    }

    // The spring moves by the leapfrog's own displacement, so that the pair is one symplectic
    // oscillator. With a velocity predicted from the last acceleration, the amplitude would grow by
    // (omega dt)^4 / 8 per step.
    TEST_CASE("an undamped tangential oscillation keeps its amplitude") {
        for (const double omega_dt : {0.1, 0.2, 0.3}) {
            const auto [growth, steps] = tangential_growth(omega_dt);
            MESSAGE("omega dt = ", omega_dt, ": growth ", std::log(growth) / steps, " per step");
            CHECK(std::abs(growth - 1) < 1e-3);
        }
    }

    TEST_CASE("a frictionless contact does not change the angular velocity") {
        World world = make_world(Grains::spheres);
        const auto material = add_material(world, linear_material(1e5, 1e5, 0));
        add_floor(world, material);
        const EntityId ball = add_sphere(world, Vec3(0, 0, 0.0101), 0.01, material);
        value_of<Velocity>(world, ball) = Vec3(1, 0, -1);
        set_angular_velocity(world, ball, Vec3(1, 2, 3));
        Simulation sim = begin(std::move(world), {.dt = 1e-5});
        sim.advance(2000);
        CHECK(value_of<Velocity>(sim, ball).z() > 0.9);
        CHECK(value_of<Velocity>(sim, ball).x() == 1);
        CHECK((value_of<AngularVelocity>(sim, ball) - Vec3(1, 2, 3)).norm() < 1e-15);
    }
}
