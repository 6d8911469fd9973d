#include "engine/state.hpp"
#include "scenarios/specimens/facet_bodies.hpp"
#include "systems/contact/stable_step.hpp"
#include "systems/output/quantities.hpp"
#include "tests/about.hpp"
#include "tests/support.hpp"

#include <doctest/doctest.h>

#include <complex>

using namespace bris;
using namespace bris::testing;

namespace {

const Vec3 tie_size(0.27, 2.6, 0.23);
constexpr double tie_mass = 350;

struct Tie {
    World world;
    EntityId body;
};

Tie make_tie(double gravity = 0) {
    World world = make_world(Grains::clumps);
    const auto material = add_material(world, linear_material(1e7));
    const EntityId body =
        add_block(world, Vec3(0.4, -0.2, 1), Quat(Quat::Identity()), tie_size, tie_mass, material);
    if (gravity > 0) world.add_resource<Gravity>({Vec3(0, 0, -gravity)});
    return {std::move(world), body};
}

void add_support(Tie& tie, const Vec3& point, double stiffness, double damping,
                 bool one_sided = false) {
    add_patch(tie.world, tie.body,
              {.point = point,
               .anchor = value_of<Position>(tie.world, tie.body) + point,
               .stiffness = stiffness,
               .damping = damping,
               .one_sided = one_sided});
}

} // namespace

TEST_SUITE("loads") {
    TEST_CASE("a tie under an eccentric load takes the tilt of the closed form on two patches") {
        constexpr double k = 2e6, half = 1, load = 20e3, offset = 0.3, g = 9.81;
        Tie tie = make_tie(g);
        for (const double y : {-half, half}) add_support(tie, Vec3(0, y, 0), k, 3e4);
        add_load(tie.world, tie.body, {.force = Vec3(0, 0, -load), .point = Vec3(0, offset, 0)});
        const Vec3 start = value_of<Position>(tie.world, tie.body);
        Simulation sim = begin(std::move(tie.world), {.dt = 1e-4});
        sim.advance(40'000);
        const Vec3 axis = value_of<Orientation>(sim, tie.body) * Vec3::UnitY();
        // vertical forces: 2 k z = P + m g; moments, of any tilt a: P e cos a = 2 k b^2 sin a cos a
        const double down = (load + tie_mass * g) / (2 * k),
                     sine = load * offset / (2 * k * half * half);
        CHECK(start.z() - value_of<Position>(sim, tie.body).z() == about(down).epsilon(1e-6));
        CHECK(-axis.z() == about(sine).epsilon(1e-6));
        MESSAGE("relative errors of sinking and tilt ",
                (start.z() - value_of<Position>(sim, tie.body).z()) / down - 1, " and ",
                -axis.z() / sine - 1);
        // in equilibrium load, weight and patches cancel
        CHECK(compute_quantities(sim.world()).unbalanced_ratio < 1e-9);
    }

    TEST_CASE("a tilted tie rocks on its patches with the frequency of the closed form") {
        // small tilt a: I a'' = -2 k b^2 a, by the leapfrog with the frequency (2/dt) asin(w dt/2)
        constexpr double k = 2e6, half = 1, tilt = 1e-5, dt = 2e-5;
        Tie tie = make_tie();
        for (const double y : {-half, half}) add_support(tie, Vec3(0, y, 0), k, 0);
        value_of<Orientation>(tie.world, tie.body) = exponential_map(Vec3(tilt, 0, 0));
        const double omega = std::sqrt(2 * k * half * half / block_inertia(tie_size, tie_mass).x());
        const double discrete = 2 / dt * std::asin(0.5 * omega * dt);
        Simulation sim = begin(std::move(tie.world), {.dt = dt});
        for (int k_sample = 1; k_sample <= 5; ++k_sample) {
            sim.advance(1000);
            const double t = sim.world().resource<Clock>().time();
            const double found = 2 * value_of<Orientation>(sim, tie.body).x();
            // at rest at -dt/2
            const double exact =
                tilt * std::cos(discrete * (t + 0.5 * dt)) / std::cos(0.5 * discrete * dt);
            CHECK(std::abs(found - exact) / tilt < 1e-6);
        }
        CHECK(stable_step(sim.world()) == about(0.999 * 2 / omega).epsilon(1e-2));
    }

    TEST_CASE("a harmonic load moves a tie on a patch with amplitude and phase of the oscillator, "
              "and its work is what the dashpot takes") {
        constexpr double k = 4e6, c = 4e4, amplitude = 1e4, frequency = 8, dt = 1e-5;
        Tie tie = make_tie();
        add_support(tie, Vec3::Zero(), k, c);
        add_load(tie.world, tie.body,
                 {.force = Vec3(0, 0, amplitude),
                  .history = {.mean = 0.2, .amplitude = 1, .frequency = frequency, .phase = 0.4}});
        Simulation sim = begin(std::move(tie.world), {.dt = dt, .energy_budget = true});
        const double w = 2 * pi * frequency, start = 1;
        const std::complex<double> response =
            amplitude / std::complex<double>(k - tie_mass * w * w, c * w);
        double worst = 0;
        for (int sample = 0; sample < 8; ++sample) {
            sim.advance(sample == 0 ? 100'000 : 2'500); // 1 s: exp(-57) of the transient
            const double t = sim.world().resource<Clock>().time();
            const double exact =
                0.2 * amplitude / k + std::imag(response * std::polar(1.0, w * t + 0.4));
            worst =
                std::max(worst, std::abs(value_of<Position>(sim, tie.body).z() - start - exact));
        }
        MESSAGE("error over amplitude ", worst / std::abs(response));
        CHECK(worst < 1e-6 * std::abs(response));
        // with the energy of the present state, all of the load's work is accounted for
        const double stored =
            value_of<LoadWork>(sim, tie.body) - value_of<PatchWork>(sim, tie.body);
        const Quantities q = compute_quantities(sim.world());
        CHECK(value_of<PatchWork>(sim, tie.body) > 0.5 * value_of<LoadWork>(sim, tie.body));
        CHECK(stored == about(q.kinetic_energy + q.elastic_energy)
                            .epsilon(1e-5 * value_of<LoadWork>(sim, tie.body) / stored));
    }

    TEST_CASE("a one-sided patch pushes and never pulls") {
        Tie tie = make_tie();
        add_support(tie, Vec3::Zero(), 1e6, 1e5, true);
        value_of<Velocity>(tie.world, tie.body) = Vec3(0, 0, -0.5);
        Simulation sim = begin(std::move(tie.world), {.dt = 1e-5});
        double lowest = 0;
        for (int k = 0; k < 20'000; ++k) {
            sim.advance();
            lowest = std::min(lowest, value_of<PatchForce>(sim, tie.body).force.z());
        }
        CHECK(lowest == 0);
        CHECK(value_of<Position>(sim, tie.body).z() > 1); // it has left the support
        CHECK(value_of<Velocity>(sim, tie.body).z() > 0);
    }

    TEST_CASE("a history is constant, a sine that begins at its start, or a table") {
        CHECK(LoadHistory{}.at(3) == 1);
        const LoadHistory sine{.mean = 2, .amplitude = 3, .frequency = 0.5, .start = 1};
        CHECK(sine.at(0) == 2);
        CHECK(sine.at(1.5) == about(5).epsilon(1e-15));
        const LoadHistory table{.times = {0, 1, 3}, .values = {0, 10, 20}};
        CHECK(table.at(-1) == 0);
        CHECK(table.at(0.25) == about(2.5));
        CHECK(table.at(2) == about(15));
        CHECK(table.at(3) == 20);
        CHECK(table.at(9) == 20);
    }

    TEST_CASE("loads and patches are kept in checkpoints, and unsuitable ones are refused") {
        Tie tie = make_tie(9.81);
        add_support(tie, Vec3(0, 0.5, 0), 1e6, 1e3, true);
        add_load(tie.world, tie.body,
                 {.force = Vec3(0, 0, -1e3), .history = {.times = {0, 0.01}, .values = {0, 1}}});
        Simulation sim = begin(std::move(tie.world), {.dt = 1e-5});
        sim.advance(500);
        const Archive saved = sim.snapshot();
        sim.advance(1000);
        const auto expected = fingerprint(sim.snapshot());
        sim.world().resource<Loads>().of_body.clear();
        sim.world().resource<SpringPatches>().of_body.clear();
        sim.restore(saved);
        sim.advance(1000);
        CHECK(fingerprint(sim.snapshot()) == expected);

        Tie other = make_tie();
        const EntityId wall = add_boundary(other.world, Vec3::Zero(), 0);
        CHECK(refusal_of([&] {
                  add_load(other.world, wall, {});
              }).starts_with("load: expected a free body, found body 1"));
        CHECK(
            refusal_of([&] {
                add_load(other.world, other.body, {.history = {.times = {1, 1}, .values = {0, 1}}});
            }).starts_with("load: expected a table of ascending times"));
        CHECK(refusal_of([&] {
                  add_patch(other.world, other.body, {.stiffness = -1});
              }).starts_with("spring-dashpot patch: expected a stiffness"));
    }
}
