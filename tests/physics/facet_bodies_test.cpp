#include "engine/ordering.hpp"
#include "scenarios/specimens/check_scene.hpp"
#include "scenarios/specimens/facet_bodies.hpp"
#include "systems/contact/stable_step.hpp"
#include "systems/output/quantities.hpp"
#include "tests/about.hpp"
#include "tests/support.hpp"

#include <doctest/doctest.h>

#include <array>

using namespace bris;
using namespace bris::testing;

namespace {

template <class Column>
double sum(const World& world) {
    const auto column = world.column<Bodies, Column>();
    double total = 0;
    for (const Row b : rows_by_id(world.column<Bodies, BodyId>())) total += column[b];
    return total;
}

struct Momenta {
    Vec3 linear = Vec3::Zero(), angular = Vec3::Zero();
};

// position at t and velocity at t - dt/2: the combination that the leapfrog conserves
Momenta momenta_of(const World& world) {
    const Table& bodies = world.table<Bodies>();
    Momenta sum;
    for (Row b = 0; b < bodies.size(); ++b) {
        if (bodies.column<MotionOf>()[b] != static_cast<std::uint32_t>(Motion::free)) continue;
        const Vec3 p = bodies.column<InertialMass>()[b] * bodies.column<Velocity>()[b];
        sum.linear += p;
        sum.angular += bodies.column<Position>()[b].cross(p) + bodies.column<AngularMomentum>()[b];
    }
    return sum;
}

double energy_of(const World& world) {
    const Quantities q = compute_quantities(world);
    double energy = q.kinetic_energy + q.elastic_energy;
    const Table& bodies = world.table<Bodies>();
    if (world.has_resource<Gravity>())
        for (Row b = 0; b < bodies.size(); ++b)
            energy -= bodies.column<Mass>()[b] *
                      world.resource<Gravity>().value.dot(bodies.column<Position>()[b]);
    return energy + sum<FrictionWork>(world) + sum<ViscousWork>(world);
}

Material rock_material(double friction, double restitution) {
    Material m = linear_material(2e6, 1.5e6, friction, 2700);
    m.restitution = restitution;
    return m;
}

const Vec3 tie_size(0.25, 1.2, 0.2);

// A tie falls spinning onto rocks, which are free in space or lie in a box of planes.
struct Drop {
    Simulation sim;
    EntityId tie;
};

Drop drop(bool floor, const SmallSceneSettings& settings, double local_damping = 0) {
    World world = make_world(Grains::clumps);
    const auto rock = add_material(world, rock_material(0.5, 0.6)),
               concrete = add_material(world, rock_material(0.6, 0.5));
    Random random(11, 1);
    const Clump shape = small_rock();
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 8; ++j) {
            const double size = 0.06 * random.uniform(0.85, 1);
            const Clump sized = scaled(shape, size / shape.bounding_radius);
            add_clump(world, sized, 0, Vec3(0.13 * (i - 1), 0.14 * (j - 3.5), 0.07),
                      random.rotation(), rock);
        }
    const EntityId tie = add_block(world, Vec3(0.02, 0.03, 0.34),
                                   exponential_map(Vec3(0.1, 0.2, 0.3)), tie_size, 60, concrete);
    value_of<Velocity>(world, tie) = Vec3(0.2, -0.1, -1.5);
    set_angular_velocity(world, tie, Vec3(0.5, -0.8, 0.4));
    if (floor) {
        add_box(world, Vec3(-0.2, -0.57, 0), Vec3(0.2, 0.57, 2), concrete);
        world.add_resource<Gravity>();
    }
    if (local_damping > 0) world.add_resource(LocalDamping{local_damping});
    return {begin(std::move(world), settings), tie};
}

const SmallSceneSettings drop_settings{
    .dt = 5e-6, .law = LawName::linear_viscous, .energy_budget = true};

// a frictionless sphere hits a free block, elastic, in the direction -normal at `point`
struct Hit {
    double found, exact; ///< m/s, change of the sphere's velocity along the normal
    double momentum;     ///< error relative to the sphere's
};
Hit hit(const Vec3& point, const Vec3& normal) {
    constexpr double radius = 0.02, speed = 1, block_mass = 0.5;
    const Vec3 size(0.1, 0.08, 0.06);
    World world = make_world(Grains::clumps);
    const auto material = add_material(world, linear_material(1e7, 0, 0, 2600));
    const Quat turned = exponential_map(Vec3(0.3, -0.7, 1.1));
    const Vec3 n = turned * normal, at = turned * point;
    const EntityId block =
        add_block(world, Vec3(0.3, 0.2, 0.1), turned, size, block_mass, material);
    const EntityId ball =
        add_sphere(world, Vec3(0.3, 0.2, 0.1) + at + 1.001 * radius * n, radius, material);
    value_of<Velocity>(world, ball) = -speed * n;
    const double mass = value_of<Mass>(world, ball);
    const Vec3 arm = turned.conjugate() * Vec3(at.cross(n)),
               inertia = block_inertia(size, block_mass);
    const double compliance =
        1 / mass + 1 / block_mass + arm.cwiseAbs2().dot(inertia.cwiseInverse());
    Simulation sim = begin(std::move(world), {.dt = 1e-6});
    const Vec3 before = momenta_of(sim.world()).linear;
    sim.advance(1500);
    const Vec3 change = value_of<Velocity>(sim, ball) + speed * n;
    CHECK(value_of<Force>(sim, ball).norm() == 0); // the impact is over
    CHECK(value_of<Velocity>(sim, block).norm() > 0);
    return {change.dot(n), 2 * speed / compliance / mass,
            (momenta_of(sim.world()).linear - before).norm() / (mass * speed)};
}

} // namespace

TEST_SUITE("physics/facet_bodies") {
    TEST_CASE("a torque-free body of facets turns as the exact top, and its facets with it") {
        // I = (1, 2, 3) of a plate, w(0) = (1, 0, 1): the attitude at t = 10 is that of Jacobi's
        // solution (period 6.935667541), by numerical integration with an error of 2e-13
        const Quat exact(8.614411740654798e-01, 1.073407576201552e-01, 2.209473217943740e-01,
                         -4.444989835422690e-01);
        World world = make_world(Grains::clumps);
        const auto material = add_material(world, {"plate", 1, 1, 1, 0});
        const auto facets = block_facets(Vec3(std::sqrt(2.0), 1, 0.01));
        const EntityId body = add_facet_body(world, Vec3(1, 2, 3), Quat(Quat::Identity()), 12,
                                             Vec3(1, 2, 3), material, facets);
        set_angular_velocity(world, body, Vec3(1, 0, 1));
        Simulation sim = begin(std::move(world), {.dt = 1.0 / 28}); // 0.0505 rad per step
        sim.advance(280);
        const double error =
            2 * (value_of<Orientation>(sim, body).conjugate() * exact).vec().norm();
        MESSAGE("error of the attitude at t = 10 with 0.05 rad per step: ", error, " rad");
        CHECK(error < 1e-4);
        const auto at = sim.world().column<Facets, FacetPosition>();
        for (std::size_t f = 0; f < facets.size(); ++f)
            for (std::size_t k = 0; k < 4; ++k) {
                const Vec3 corner = Vec3(1, 2, 3) + exact * facets[f].corners[k];
                CHECK((at[f].corners[k] - corner).norm() < 1e-4);
            }
    }

    TEST_CASE("the sides of a block point outwards and its inertia is that of a homogeneous box") {
        const Vec3 size(1, 2, 3);
        Vec3 area = Vec3::Zero();
        double volume = 0;
        for (const FacetShape& f : block_facets(size)) {
            const auto& c = f.corners;
            const Vec3 a = (c[2] - c[0]).cross(c[3] - c[1]) / 2; // of a plane quadrilateral
            area += a;
            volume += c[0].dot(a) / 3;
        }
        CHECK(area.norm() < 1e-15);
        CHECK(volume == about(6).epsilon(1e-15));
        CHECK((block_inertia(size, 12) - Vec3(13, 10, 5)).norm() < 1e-15);
    }

    TEST_CASE("a sphere that hits a face, an edge or a corner of a free block gives it the impulse "
              "of rigid bodies") {
        // J = 2 v / (1/m + 1/M + (r x n) I^-1 (r x n)). The block turns while they touch: 1e-2 of
        // the radius in a contact of 2e-4 s, so the arm changes by some 1e-3.
        const Hit face = hit(Vec3(0.03, 0.02, 0.03), Vec3::UnitZ());
        const Hit edge = hit(Vec3(0.03, 0.04, 0.03), Vec3(0, 1, 1).normalized());
        const Hit corner = hit(Vec3(0.05, 0.04, 0.03), Vec3(1, 1, 1).normalized());
        for (const Hit& h : {face, edge, corner}) {
            MESSAGE("impulse over exact: ", h.found / h.exact, ", error of momentum ", h.momentum);
            CHECK(h.found == about(h.exact).epsilon(3e-3));
            CHECK(h.momentum < 1e-12);
        }
    }

    TEST_CASE("a tie that hits free rocks conserves linear and angular momentum") {
        Drop d = drop(false, drop_settings);
        const Momenta before = momenta_of(d.sim.world());
        const Vec3 spin = value_of<AngularMomentum>(d.sim, d.tie);
        d.sim.advance(40'000); // 0.2 s
        const Momenta after = momenta_of(d.sim.world());
        const double linear = (after.linear - before.linear).norm() / before.linear.norm(),
                     angular = (after.angular - before.angular).norm() / before.angular.norm();
        MESSAGE("relative errors of linear and angular momentum ", linear, " and ", angular);
        CHECK((value_of<AngularMomentum>(d.sim, d.tie) - spin).norm() > 0.05 * spin.norm());
        CHECK(linear < 1e-10);
        CHECK(angular < 1e-10);
    }

    TEST_CASE("the energy budget of a tie dropped on rocks closes") {
        for (const bool floor : {false, true}) {
            Drop d = drop(floor, drop_settings);
            const double before = energy_of(d.sim.world()),
                         kinetic = compute_quantities(d.sim.world()).kinetic_energy;
            d.sim.advance(floor ? 60'000 : 40'000);
            const double taken = sum<FrictionWork>(d.sim.world()) + sum<ViscousWork>(d.sim.world());
            const double error = std::abs(energy_of(d.sim.world()) - before) / kinetic;
            MESSAGE(std::string(floor ? "in a box" : "in space"), ": dissipated ", taken / kinetic,
                    " of the kinetic energy, error of the budget ", error);
            CHECK(taken > 0.1 * kinetic);
            CHECK(error < 1e-3);
        }
    }

    TEST_CASE("a tie comes to rest on rocks, which carry its weight") {
        SmallSceneSettings settings = drop_settings;
        settings.dt = 1e-5;
        settings.energy_budget = false;
        Drop d = drop(true, settings, 0.7);
        value_of<Velocity>(d.sim, d.tie).setZero(); // flat, from a small height
        value_of<Orientation>(d.sim, d.tie) = Quat::Identity();
        value_of<Position>(d.sim, d.tie) = Vec3(0, 0, 0.26);
        set_angular_velocity(d.sim.world(), d.tie, Vec3::Zero());
        CHECK(settings.dt < stable_step_of_first_contact(d.sim.world()));
        d.sim.advance(100'000);
        const Vec3 force = value_of<Force>(d.sim, d.tie); // contacts and weight
        CHECK(force.norm() < 0.05 * 60 * 9.81);           // still settling
        CHECK(compute_quantities(d.sim.world()).boundary_force_over_weight() ==
              about(1).epsilon(1e-2));
        CHECK(settings.dt < stable_step(d.sim.world()));
    }

    TEST_CASE("overlaps at the start are found on a turned body, and a body of facets needs clumps "
              "and a mass") {
        const auto refusal = [](const Vec3& position) {
            return refusal_of([&] {
                World world = make_world(Grains::clumps);
                const auto material = add_material(world, linear_material(1e5));
                add_block(world, Vec3::Zero(), exponential_map(Vec3(0, 0, pi / 4)), Vec3(1, 1, 1),
                          1, material);
                add_sphere(world, position, 0.1, material);
                Simulation sim = begin(std::move(world), {});
                check_overlaps(sim.world());
            });
        };
        // the corner lies at sqrt 1/2 on the x axis
        CHECK(refusal(Vec3(std::sqrt(0.5) + 0.11, 0, 0)) == "");
        CHECK(refusal(Vec3(std::sqrt(0.5) + 0.05, 0, 0)).starts_with("bodies 1 and 0: overlap"));
        CHECK(refusal_of([] {
                  World world = make_world(Grains::spheres);
                  add_material(world, linear_material(1e5));
                  add_block(world, Vec3::Zero(), Quat(Quat::Identity()), Vec3(1, 1, 1), 1, 0);
              }).starts_with("body of facets: expected a scene of clumps"));
        CHECK(refusal_of([] {
                  World world = make_world(Grains::clumps);
                  add_material(world, linear_material(1e5));
                  add_block(world, Vec3::Zero(), Quat(Quat::Identity()), Vec3(1, 1, 1), 0, 0);
              }).starts_with("body of facets: expected a mass"));
    }
}
