#include "tests/about.hpp"
#include "tests/support.hpp"

#include <doctest/doctest.h>

using namespace bris;
using namespace bris::testing;

namespace {

struct Impact {
    double rate = 0;    ///< 1/s
    double steps = 100; ///< per contact
    /// fraction of a step between reaching the plane and the first step in contact
    double phase = 0.5;
    double speed = 1;
};

/// Restitution of a sphere on a plane, without gravity.
double restitution(const Impact& s) {
    const double radius = 0.01, stiffness = 1e6;
    World world = make_world(Grains::spheres);
    Material m = linear_material(stiffness);
    m.normal_damping = s.rate;
    const auto material = add_material(world, m);
    add_floor(world, material);
    const EntityId ball = add_sphere(world, Vec3::Zero(), radius, material);
    const double omega2 = stiffness / value_of<Mass>(world, ball);
    const double contact_time = pi / std::sqrt(omega2 - 0.25 * s.rate * s.rate),
                 dt = contact_time / s.steps;
    value_of<Position>(world, ball) = Vec3(0, 0, radius + s.speed * dt * (10 - s.phase));
    value_of<Velocity>(world, ball) = Vec3(0, 0, -s.speed);
    Simulation sim = begin(std::move(world), {.dt = dt, .law = LawName::linear_viscous});
    sim.advance(static_cast<std::uint64_t>(1.2 * s.steps) + 20);
    return value_of<Velocity>(sim, ball).z() / s.speed;
}

double closed_form(double rate) {
    const double omega2 = 1e6 / (2600 * 4.0 / 3 * pi * 1e-6);
    return std::exp(-pi * rate / (2 * std::sqrt(omega2 - 0.25 * rate * rate)));
}

} // namespace

TEST_SUITE("physics/restitution") {
    TEST_CASE("a sphere dropped on a plane rebounds at e times its speed") {
        for (const double e : {0.9, 0.5, 0.1}) {
            const double damping = -std::log(e) / std::sqrt(pi * pi + std::log(e) * std::log(e));
            const double rate = 2 * damping * std::sqrt(1e6 / (2600 * 4.0 / 3 * pi * 1e-6));
            CHECK(closed_form(rate) == about(e).epsilon(1e-12));
            CAPTURE(e);
            // second order, wherever in a step the contact begins and ends: the error of the
            // leapfrog is e (pi/steps)^2 times a number of order one. A scheme with lagged damping
            // is of first order: LIGGGHTS reaches 3.8e-3, 8.6e-4 and 2.1e-4 at t_c/50, t_c/200 and
            // t_c/1000.
            for (const double steps : {50.0, 200.0, 1000.0})
                for (const double phase : {0.1, 0.3, 0.5, 0.7, 0.9}) {
                    // at e = 0.1 the dashpot halves the rebound speed within the last of 50 steps
                    const double bound = steps == 50 && e == 0.1 ? 6e-3 : 3 / (steps * steps);
                    CHECK(std::abs(restitution({rate, steps, phase}) - e) < bound);
                }
            const double coarse = restitution({rate, 200, 0.3}) - e,
                         fine = restitution({rate, 400, 0.3}) - e;
            MESSAGE("e = ", e, ": error ", coarse, " at t_c/200, ", fine, " at t_c/400, order ",
                    order_of(std::abs(coarse), std::abs(fine)));
            CHECK(order_of(std::abs(coarse), std::abs(fine)) > 1.8);
        }
    }

    TEST_CASE("restitution does not depend on speed") {
        const double slow = restitution({3000, 100, 0.5, 0.01}),
                     fast = restitution({3000, 100, 0.5, 2});
        // the phase of the first touch is the same, so only rounding differs: eps R / overlap
        CHECK(std::abs(slow - fast) < 1e-9);
    }

    TEST_CASE("an undamped rebound restores the speed to fourth order in dt, wherever in a step it "
              "begins") {
        const auto worst = [&](double steps) {
            double w = 0;
            for (int k = 0; k < 16; ++k)
                w = std::max(w, std::abs(restitution({0, steps, (k + 0.5) / 16}) - 1));
            return w;
        };
        const double coarse = worst(50), fine = worst(200);
        MESSAGE("undamped rebound: worst error ", coarse, " at t_c/50, ", fine, " at t_c/200");
        CHECK(coarse < 1e-5);
        // with forces over whole steps only, the order would be 2 and the error 2 (omega dt)^2 / 8
        CHECK(std::log2(coarse / fine) / 2 > 3.8);
    }
}
