#include "components/triangle_surface.hpp"
#include "scenarios/specimens/sleeve.hpp"
#include "systems/output/quantities.hpp"
#include "systems/sleeve/latex.hpp"
#include "systems/sleeve/sleeve.hpp"
#include "tests/about.hpp"
#include "tests/support.hpp"

#include <doctest/doctest.h>

#include <array>

using namespace bris;
using namespace bris::testing;

namespace {

constexpr double modulus = 1.4e6, thickness = 0.5e-3, radius = 0.15, height = 0.6;

/// A sleeve without grains, with as many columns as its polygon has corners.
Simulation empty_sleeve(unsigned columns, unsigned levels, bool wrinkles, double pressure = 0,
                        double dt = 1e-4) {
    World world = make_world(Grains::spheres);
    const auto material = add_material(world, linear_material(1e5));
    Membrane membrane;
    membrane.target_pressure = pressure;
    membrane.contact_stiffness = 2e3;
    membrane.largest_step = 1e-4;
    add_sleeve(world, membrane,
               {.thickness = thickness, .young_modulus = modulus, .wrinkles = wrinkles},
               {columns, levels, columns, radius * std::cos(pi / columns), height}, material);
    const EntityId top = add_boundary(world, Vec3(0, 0, height), material, Motion::servo);
    Platen platen;
    platen.plane = add_plane(world, top, Vec3::Zero(), Vec3(0, 0, -1));
    world.add_resource(platen);
    return begin(std::move(world), {.dt = dt, .law = LawName::linear_frictionless});
}

/// Radial stress (Pa, inwards) in the middle and axial force (N, tension) of a sleeve that is held
/// at these strains.
struct Held {
    double radial, axial;
};
Held held(unsigned columns, bool wrinkles, double around, double along) {
    const unsigned levels = columns + 1; // even
    Simulation sim = empty_sleeve(columns, levels, wrinkles);
    World& world = sim.world();
    world.resource<Membrane>().active = false;
    for (Vec3& x : world.column<Nodes, NodePosition>())
        x = x.cwiseProduct(Vec3(1 + around, 1 + around, 1 + along));
    value_of<Position>(world, 1).z() *= 1 + along;
    invalidate_lists(world);
    sim.advance(1);
    double inwards = 0;
    const auto x = world.column<Nodes, NodePosition>();
    const auto force = world.column<Nodes, NodeForce>();
    for (std::size_t n = columns * (levels / 2); n < columns * (levels / 2 + 1); ++n)
        inwards -= force[n].dot(Vec3(x[n].x(), x[n].y(), 0).normalized());
    const double area =
        2 * pi * radius * (1 + around) * height * (1 + along) / static_cast<double>(levels - 1);
    return {inwards / area, world.resource<Platen>().pull};
}

/// Of Hooke's law in plane stress, with a Poisson ratio of 1/2.
Held closed_form(double around, double along) {
    const double plane = modulus / 0.75, diameter = 2 * radius;
    return {2 * thickness / diameter * plane * (around + 0.5 * along),
            pi * diameter * thickness * plane * (along + 0.5 * around)};
}

/// A vector in the first lane.
Vec3Lanes in_lanes(const Vec3& v) { return {lanes(v.x()), lanes(v.y()), lanes(v.z())}; }
Vec3 first_lane(const Vec3Lanes& v) { return {v.x[0], v.y[0], v.z[0]}; }

/// Forces and energy of one triangle.
struct OneTriangle {
    std::array<Vec3, 3> force;
    double energy;
};
OneTriangle stretch(const Latex& latex, const RestTriangle& r, const std::array<Vec3, 3>& x) {
    const TriangleForces f = bris::stretch(latex, {lanes(r.along), lanes(r.back), lanes(r.high)},
                                           {in_lanes(x[0]), in_lanes(x[1]), in_lanes(x[2])});
    return {{first_lane(f.force[0]), first_lane(f.force[1]), first_lane(f.force[2])}, f.energy[0]};
}

RestTriangle some_triangle() { return {0.02, 0.006, 0.015}; }

std::array<Vec3, 3> stretched(double x, double y, double shear, const RestTriangle& r) {
    const auto at = [&](double u, double v) {
        return Vec3(x * u + shear * v, y * v, 0.3 * u + 0.1 * v);
    };
    return {at(0, 0), at(r.along, 0), at(r.back, r.high)};
}

} // namespace

TEST_SUITE("physics/sleeve") {
    TEST_CASE("the forces of latex are the gradient of its energy, taut, folded and slack") {
        const RestTriangle rest = some_triangle();
        const double step = 1e-7;
        for (const bool wrinkles : {false, true})
            for (const auto& [x, y, shear] :
                 {std::array{1.2, 1.1, 0.1}, std::array{1.5, 0.7, 0.05}, std::array{1.02, 0.4, 0.3},
                  std::array{0.9, 1.3, -0.2}, std::array{2.5, 2.0, 0.4}}) {
                const Latex latex{thickness, modulus, wrinkles};
                const auto corners = stretched(x, y, shear, rest);
                const OneTriangle f = stretch(latex, rest, corners);
                double largest = 0, worst = 0;
                for (std::size_t k = 0; k < 3; ++k)
                    for (int axis = 0; axis < 3; ++axis) {
                        auto more = corners, less = corners;
                        more[k][axis] += step;
                        less[k][axis] -= step;
                        const double slope = (stretch(latex, rest, more).energy -
                                              stretch(latex, rest, less).energy) /
                                             (2 * step);
                        largest = std::max(largest, std::abs(slope));
                        worst = std::max(worst, std::abs(f.force[k][axis] + slope));
                    }
                CHECK(worst < 1e-6 * largest);
                CHECK((f.force[0] + f.force[1] + f.force[2]).norm() < 1e-14 * largest);
            }
        const OneTriangle slack =
            stretch({thickness, modulus, true}, rest, stretched(0.8, 0.7, 0, {0.02, 0.006, 0.015}));
        CHECK(slack.energy >= 0);
        const std::array<Vec3, 3> small{Vec3(0, 0, 0), Vec3(0.018, 0, 0), Vec3(0.0054, 0.0135, 0)};
        CHECK(stretch({thickness, modulus, true}, rest, small).force[1] == Vec3::Zero());
        CHECK(stretch({thickness, modulus, false}, rest, small).force[1].norm() > 0);
    }

    TEST_CASE("a thin tube exerts the radial stress and the axial force of Hooke's law, with the "
              "signs of both strains") {
        for (const auto& [around, along] : {std::array{1e-3, 0.0}, std::array{0.0, 1e-3},
                                            std::array{1e-3, -1.5e-3}, std::array{1e-3, 2e-3}}) {
            const Held found = held(36, false, around, along), wanted = closed_form(around, along);
            CHECK(found.radial == about(wanted.radial).epsilon(0.01));
            CHECK(found.axial == about(wanted.axial).epsilon(0.01));
        }
        // at constant volume the stress around the tube vanishes
        const double whole = closed_form(0, 2e-3).radial;
        CHECK(std::abs(held(36, false, -1e-3, 2e-3).radial) < 0.01 * whole);
    }

    TEST_CASE("a tube that folds takes no axial force under compression, and that of simple "
              "tension around") {
        const Held found = held(36, true, 1e-3, -0.005);
        CHECK(found.radial == about(thickness / radius * modulus * 1e-3).epsilon(0.01));
        CHECK(std::abs(found.axial) < 1e-9);
        const Held slack = held(36, true, -1e-3, -1e-3);
        CHECK(slack.radial == 0);
        CHECK(slack.axial == 0);
        // where nothing folds, both are the same
        CHECK(held(36, true, 1e-3, 0).radial == held(36, false, 1e-3, 0).radial);
    }

    TEST_CASE("the stress of a stretched tube is that of a neo-Hookean sheet, and its error falls "
              "with the square of the mesh size") {
        const double a = 1.3, b = 1.1, shear = modulus / 3, now = thickness / (a * b);
        const double around = shear * (a * a - 1 / (a * a * b * b)),
                     along = shear * (b * b - 1 / (a * a * b * b));
        std::array<double, 3> error{};
        for (std::size_t k = 0; k < 3; ++k) {
            const Held found = held(12u << k, false, a - 1, b - 1);
            error[k] = std::abs(found.radial / (around * now / (radius * a)) - 1);
            CHECK(found.axial == about(along * now * 2 * pi * radius * a).epsilon(4 * error[k]));
        }
        MESSAGE("relative errors of 12, 24 and 48 columns ", error[0], " ", error[1], " ",
                error[2]);
        CHECK(error[2] < 0.002);
        CHECK(order_of(error[0], error[1]) == about(2).epsilon(0.05));
        CHECK(order_of(error[1], error[2]) == about(2).epsilon(0.05));
    }

    TEST_CASE("a long tube that is blown up comes to rest where its hoop stress carries the "
              "pressure, whether its latex or the time step sets its mass") {
        const double pressure = -4; // outwards
        for (const double dt : {1e-4, 1e-2}) {
            Simulation sim = empty_sleeve(24, 25, false, pressure, dt);
            sim.advance(20'000);
            const World& world = std::as_const(sim).world();
            CHECK(world.resource<Sleeve>().unbalanced < 1e-6);
            const Vec3 x = world.column<Nodes, NodePosition>()[24 * 12];
            const double around = std::hypot(x.x(), x.y()) / radius - 1;
            CHECK(around == about(-pressure * radius / (thickness * modulus / 0.75)).epsilon(0.01));
        }
    }

    TEST_CASE("the forces in a crumpled sleeve under pressure add to nothing, and the pressure "
              "does the work of the change of volume") {
        Simulation sim = empty_sleeve(24, 13, true, 1e4);
        World& world = sim.world();
        world.resource<Membrane>().active = false;
        Random random(3, 0);
        const auto x = world.column<Nodes, NodePosition>();
        for (std::size_t n = 24; n + 24 < x.size(); ++n) x[n] += 0.01 * random.direction();
        for (std::size_t n = 24; n + 24 < x.size(); ++n)
            world.column<Nodes, NodeVelocity>()[n] = 1e-3 * random.direction();
        const double before = sleeve_volume(world);
        sim.advance(1);
        const auto force = world.column<Nodes, NodeForce>(),
                   pressure = world.column<Nodes, NodePressure>();
        Vec3 sum = Vec3::Zero(), of_pressure = Vec3::Zero(), torque = Vec3::Zero();
        double all = 0;
        for (std::size_t n = 0; n < x.size(); ++n) {
            sum += force[n];
            of_pressure += pressure[n];
            torque += (x[n] - 1e-4 * world.column<Nodes, NodeVelocity>()[n]).cross(force[n]);
            all += force[n].norm();
        }
        CHECK(sum.norm() < 1e-10 * all);
        CHECK(of_pressure.norm() < 1e-10 * all); // both ends are the same polygon
        CHECK(torque.norm() < 1e-10 * all * radius);
        CHECK(world.resource<Sleeve>().volume == about(before).epsilon(1e-12));
        const double change = sleeve_volume(world) - before;
        CHECK(world.resource<Sleeve>().pressure_work == about(-1e4 * change).epsilon(1e-3));
    }

    TEST_CASE("the point of a triangle nearest to a sphere is found everywhere around it") {
        const std::array<Vec3, 3> t{Vec3(0, 0, 0), Vec3(0.02, 0.001, 0), Vec3(0.006, 0.015, 0.003)};
        Random random(8, 0);
        for (int k = 0; k < 300; ++k) {
            const Vec3 centre(random.uniform(-0.02, 0.04), random.uniform(-0.02, 0.03),
                              random.uniform(0.002, 0.02));
            const NearestOnTriangle found = nearest_on_triangle(
                {in_lanes(t[0]), in_lanes(t[1]), in_lanes(t[2])}, in_lanes(centre));
            const auto at = [&](double u, double v) {
                return Vec3((1 - u - v) * t[0] + u * t[1] + v * t[2]);
            };
            const double distance = found.distance[0];
            const Vec3 share(found.share[0][0], found.share[1][0], found.share[2][0]);
            double least = 1;
            for (int i = 0; i <= 40; ++i)
                for (int j = 0; i + j <= 40; ++j)
                    least = std::min(least, (centre - at(i / 40.0, j / 40.0)).norm());
            CHECK(std::abs(distance) <= least + 1e-12);
            CHECK(std::abs(distance) > least - 4e-4);
            CHECK(share.sum() == about(1).epsilon(1e-12));
            CHECK(share.minCoeff() >= -1e-12);
            CHECK((centre - distance * first_lane(found.normal) - at(share[1], share[2])).norm() <
                  1e-12);
        }
    }

    TEST_CASE("what grains exert on the nodes is what the sleeve exerts on the grains, and both "
              "budgets of energy are balanced") {
        double error[2] = {0, 0}, error_of_sleeve[2] = {0, 0}, work = 0;
        for (int fine = 0; fine < 2; ++fine) {
            World world = make_world(Grains::spheres);
            const auto material = add_material(world, linear_material(2e5));
            add_tube(world,
                     {.rings = 3,
                      .sectors = 8,
                      .radius = 0.036,
                      .height = 0.1,
                      .pressure = 500,
                      .contact_stiffness = 2e4,
                      .latex = true},
                     material);
            world.resource<Sleeve>().density = 1e5; // heavy, so that its mass is the same at dt / 2
            world.resource<Membrane>().damping = 0.1;
            Random random(9, 0);
            for (int k = 0; k < 45; ++k) {
                const Vec3 position(0.018 * (k % 3 - 1), 0.018 * (k / 3 % 3 - 1),
                                    0.01 + 0.018 * (k / 9));
                value_of<Velocity>(world, add_sphere(world, position, 0.0085, material)) =
                    0.1 * random.direction();
            }
            world.table<Bodies>().add<BoundaryWork>();
            world.resource<Platen>().speed = 0.05;
            Simulation sim = begin(std::move(world), {.dt = fine == 1 ? 2.5e-6 : 5e-6,
                                                      .law = LawName::linear_frictionless});
            struct Energies {
                double grains, sleeve;
            };
            const auto energies = [&]() -> Energies {
                const World& now = std::as_const(sim).world();
                const Quantities q = compute_quantities(now);
                const auto& sleeve = now.resource<Sleeve>();
                double done = 0;
                for (const double w : now.column<Bodies, BoundaryWork>()) done += w;
                const Row body = now.resource<Membrane>().body_row;
                work = now.column<Bodies, BoundaryWork>()[body];
                return {q.kinetic_energy + q.elastic_energy - done,
                        kinetic_energy_of_sleeve(now) + sleeve.energy + work + sleeve.damping_work -
                            sleeve.pressure_work - sleeve.clamp_work};
            };
            sim.advance(fine == 1 ? 40 : 20);
            const Energies first = energies();
            sim.advance(fine == 1 ? 20'000 : 10'000);
            const Energies last = energies();
            error[fine] = std::abs(last.grains - first.grains);
            error_of_sleeve[fine] = std::abs(last.sleeve - first.sleeve);
            Vec3 sum = Vec3::Zero(), of_grains = Vec3::Zero();
            double all = 0;
            const World& now = std::as_const(sim).world();
            for (const Vec3& f : now.column<Nodes, NodePush>()) sum += f;
            for (const auto& p : touching_pairs<MembranePairs>(now)) {
                of_grains += Vec3(p.force.fx, p.force.fy, p.force.fz);
                all += p.force.normal_force;
            }
            CHECK(all > 0);
            CHECK((sum + of_grains).norm() < 1e-10 * all);
        }
        MESSAGE("energy error of the grains ", error[0], " J, at half the step ", error[1],
                " J; of the sleeve ", error_of_sleeve[0], " and ", error_of_sleeve[1], " J; work ",
                work, " J");
        CHECK(error[1] < 1e-3 * std::abs(work));
        CHECK(error_of_sleeve[1] < 1e-3 * std::abs(work));
    }

    TEST_CASE("a sleeve goes on with the same bits on several threads and after a restart, and a "
              "torn one stops the run") {
        const auto made = [](unsigned threads) {
            World world = make_world(Grains::spheres);
            const auto material = add_material(world, linear_material(2e5));
            add_tube(world, {.radius = 0.036, .height = 0.06, .pressure = 2000, .latex = true},
                     material);
            Random random(4, 0);
            for (int k = 0; k < 27; ++k)
                value_of<Velocity>(world,
                                   add_sphere(world,
                                              Vec3(0.018 * (k % 3 - 1), 0.018 * (k / 3 % 3 - 1),
                                                   0.01 + 0.018 * (k / 9)),
                                              0.0085, material)) = 0.2 * random.direction();
            return begin(std::move(world),
                         {.dt = 1e-5, .law = LawName::linear_frictionless, .threads = threads});
        };
        Simulation one = made(1), two = made(2);
        one.advance(1500);
        two.advance(700);
        const Archive half_way = two.snapshot();
        two.advance(800);
        CHECK(fingerprint(one.snapshot()) == fingerprint(two.snapshot()));
        Simulation again = made(1);
        again.restore(half_way);
        again.advance(800);
        CHECK(fingerprint(again.snapshot()) == fingerprint(one.snapshot()));

        one.world().resource<Sleeve>().largest_stretch = 1.0001;
        CHECK(refusal_of([&] { one.advance(2000); }).find("the latex tears") != std::string::npos);
    }
}
