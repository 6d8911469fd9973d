#include "components/membrane_surface.hpp"
#include "systems/output/quantities.hpp"
#include "systems/servo/membrane.hpp"
#include "tests/about.hpp"
#include "tests/support.hpp"

#include <doctest/doctest.h>

#include <array>

using namespace bris;
using namespace bris::testing;

namespace {

/// A surface of `rings` x `sectors` elements with random radii.
struct Uneven {
    Membrane membrane;
    std::vector<double> radius;
    Uneven(unsigned rings, double spread, bool by_ring, std::uint64_t stream,
           unsigned sectors = 12) {
        membrane.rings = rings;
        membrane.sectors = sectors;
        membrane.ring_height = 0.076;
        for (unsigned k = 0; k < sectors; ++k) {
            const double angle = 2 * pi * (k + 0.5) / sectors;
            membrane.outward.push_back({std::cos(angle), std::sin(angle), 0});
        }
        Random random(77, stream);
        for (unsigned e = 0; e < sectors * rings; ++e)
            radius.push_back(by_ring && e % sectors != 0
                                 ? radius.back()
                                 : 0.15 * random.uniform(1 - spread, 1 + spread));
    }
    MembraneSurface surface() const { return {membrane, radius.data()}; }
};

} // namespace

TEST_SUITE("physics/membrane") {
    TEST_CASE("the exposed width of a side is that of the polygon, and negative if its neighbours "
              "hide the side") {
        for (const unsigned n : {3u, 4u, 12u, 96u}) {
            const Uneven even(1, 0, true, 1, n);
            CHECK(even.surface().exposed_width(0, 0, 0) ==
                  about(2 * 0.15 * std::tan(pi / n)).epsilon(1e-12));
            CHECK(ring_area(even.membrane, even.radius.data(), 0) ==
                  about(n * 0.15 * 0.15 * std::tan(pi / n)).epsilon(1e-12));
        }
        Uneven box(1, 0, true, 1, 4);
        box.radius = {2, 3, 1, 5}; // (2 + 1) x (3 + 5)
        CHECK(box.surface().exposed_width(0, 0, 0) == about(8).epsilon(1e-12));
        CHECK(box.surface().exposed_width(0, 0, 3) == about(3).epsilon(1e-12));
        CHECK(ring_area(box.membrane, box.radius.data(), 0) == about(24).epsilon(1e-12));
        Uneven hidden(1, 0, true, 1);
        hidden.radius[5] = 0.3;
        CHECK(hidden.surface().exposed_width(0, 0, 5) < 0);
        // the planes of neighbours that just hide a side intersect in its plane
        hidden.radius[5] = 0.15 / std::cos(pi / 6);
        CHECK(std::abs(hidden.surface().exposed_width(0, 0, 5)) < 1e-14);
    }

    TEST_CASE("the area of a ring is that of the polygon of its corners, for any radii") {
        for (std::uint64_t run = 0; run < 20; ++run) {
            const Uneven uneven(1, 0.03, false, 100 + run);
            std::vector<Vec3> corner(12); // where side k meets side k + 1
            for (std::size_t k = 0; k < 12; ++k) {
                const Vec3 &a = uneven.membrane.outward[k],
                           &b = uneven.membrane.outward[(k + 1) % 12];
                const double det = a.x() * b.y() - a.y() * b.x(), ra = uneven.radius[k],
                             rb = uneven.radius[(k + 1) % 12];
                corner[k] = Vec3(ra * b.y() - rb * a.y(), rb * a.x() - ra * b.x(), 0) / det;
            }
            double shoelace = 0;
            for (std::size_t k = 0; k < 12; ++k)
                shoelace += 0.5 * corner[k].cross(corner[(k + 1) % 12]).z();
            CHECK(ring_area(uneven.membrane, uneven.radius.data(), 0) ==
                  about(shoelace).epsilon(1e-12));
        }
    }

    TEST_CASE("the servo brings one grain to its target pressure and holds it") {
        World world = make_world(Grains::spheres);
        const auto material = add_material(world, linear_material(1e5));
        const double radius = 0.05, pressure = 1e4;
        const EntityId ball = add_sphere(world, Vec3(0, 0, 0.05), 0.0499, material);
        add_tube(world,
                 {.rings = 1,
                  .sectors = 8,
                  .radius = radius,
                  .height = 0.1,
                  .pressure = pressure,
                  .contact_stiffness = 1e5},
                 material);
        // local damping stops the oscillation of the grain between opposite elements
        world.add_resource(LocalDamping{0.7});
        Simulation sim = begin(std::move(world), {.dt = 1e-4, .law = LawName::linear_frictionless});
        sim.advance(20'000);
        double worst = 0;
        for (int k = 0; k < 1000; ++k) {
            sim.advance();
            worst = std::max(worst,
                             std::abs(sim.world().resource<Membrane>().pressure[0] / pressure - 1));
        }
        MESSAGE("largest relative error of the pressure ", worst);
        CHECK(worst < 1e-9);
        CHECK((value_of<Position>(sim, ball) - Vec3(0, 0, 0.05)).norm() < 1e-9);
        // the pressure times the area of the polygon equals the sum of the eight radial forces
        const double wall = sim.world().column<Elements, ElementRadius>()[0];
        double push = 0;
        for (const auto& p : touching_pairs<MembranePairs>(sim.world()))
            push += p.force.normal_force;
        CHECK(push == about(pressure * 0.1 * 8 * 2 * wall * std::tan(pi / 8)).epsilon(1e-6));
    }

    TEST_CASE("a run continues with the same bits from a checkpoint taken during a ramp of the "
              "target pressure") {
        World world = make_world(Grains::spheres);
        const auto material = add_material(world, linear_material(1e5));
        add_sphere(world, Vec3(0, 0, 0.05), 0.0499, material);
        add_tube(world, {.rings = 1, .sectors = 8}, material);
        world.resource<Platen>().controlled = true;
        world.resource<Platen>().contact_stiffness = 1e5;
        world.resource<Platen>().largest_step = 1e-5;
        Simulation sim = begin(std::move(world), {.dt = 1e-4, .law = LawName::linear_frictionless});
        sim.advance(3000);
        for (auto* target : {&sim.world().resource<Membrane>().target_pressure,
                             &sim.world().resource<Platen>().target_pressure})
            *target = 2e4;
        sim.advance(40);
        const Archive half_way = sim.snapshot();
        const auto left = [&] {
            return std::array{sim.world().resource<Membrane>().aim.left,
                              sim.world().resource<Platen>().aim.left};
        };
        const auto left_then = left();
        CHECK(left_then == std::array{PressureAim::ramp_steps - 40, PressureAim::ramp_steps - 40});
        sim.advance(200);
        CHECK(left() == std::array{0.0, 0.0});
        const auto went_on = fingerprint(sim.snapshot());
        sim.restore(half_way);
        CHECK(left() == left_then);
        sim.advance(200);
        CHECK(fingerprint(sim.snapshot()) == went_on);
    }

    TEST_CASE("a servo-controlled wall comes to rest on a spring, and its mass does not decrease "
              "when contacts are lost") {
        // relative to the stiffness of earlier contacts; 0.01: a soft mode
        for (const double stiffness : {1.0, 0.01}) {
            double most = 0, speed = 0, x = 0, held = 1;
            ServoMotion servo{most, 0.7, 1, 1e-3};
            for (int k = 0; k < 400; ++k) {
                if (k == 5) held = 0.2; // contacts are lost
                speed = servo.next(speed, 1 - stiffness * 1e4 * x, 1e4 * held);
                x += speed * 1e-3;
            }
            CHECK(most == 1e4);
            CHECK(x * stiffness * 1e4 == about(1).epsilon(stiffness == 1 ? 1e-9 : 1e-3));
        }
    }

    TEST_CASE("an inactive membrane stands still or continues at its given speed") {
        World world = make_world(Grains::spheres);
        const auto material = add_material(world, linear_material(1e5));
        add_sphere(world, Vec3(0.001, 0, 0.05), 0.0499, material);
        add_tube(world, {.rings = 2, .sectors = 8}, material);
        world.resource<Membrane>().active = false;
        Simulation sim = begin(std::move(world), {.dt = 1e-5});
        sim.advance(500);
        for (const double r : sim.world().column<Elements, ElementRadius>()) CHECK(r == 0.05);
        for (double& v : sim.world().column<Elements, ElementSpeed>()) v = 0.2;
        sim.advance(500);
        for (const double r : sim.world().column<Elements, ElementRadius>())
            CHECK(r == about(0.051).epsilon(1e-12));
    }

    TEST_CASE(
        "the force of the surface is the gradient of one potential, over ridges and valleys") {
        const Uneven uneven(4, 0.06, false, 1);
        const MembraneSurface s = uneven.surface();
        const double r = 0.02, step = 1e-7;
        const auto energy = [&](int sector, double out, double z) {
            const double overlap = std::max(0.0, r - s.nearest(sector, out, z).distance);
            return 0.5 * overlap * overlap;
        };
        double worst_force = 0, worst_jump = 0;
        for (int sector = 0; sector < 12; ++sector) {
            double before = energy(sector, 0.15 - r + 0.004, -0.05);
            for (double z = -0.05; z < 0.35; z += 1e-5) {
                const double out = 0.15 - r + 0.004, now = energy(sector, out, z);
                worst_jump = std::max(worst_jump, std::abs(now - before));
                before = now;
            }
            Random random(5, static_cast<std::uint64_t>(sector));
            for (int k = 0; k < 200; ++k) {
                const double out = random.uniform(0.13, 0.15), z = random.uniform(-0.02, 0.32);
                const auto n = s.nearest(sector, out, z);
                const double overlap = r - n.distance;
                if (overlap < 1e-4 || n.distance < 1e-3) continue;
                // excludes the bisector of a ridge, where the nearest strip changes
                if (std::abs(s.nearest(sector, out + step, z + step).axial -
                             s.nearest(sector, out - step, z - step).axial) > 1e-3)
                    continue;
                const double radial =
                    -(energy(sector, out + step, z) - energy(sector, out - step, z)) / (2 * step);
                const double axial =
                    -(energy(sector, out, z + step) - energy(sector, out, z - step)) / (2 * step);
                worst_force =
                    std::max({worst_force, std::abs(radial - overlap * n.radial) / overlap,
                              std::abs(axial - overlap * n.axial) / overlap});
            }
        }
        MESSAGE("largest difference of force and gradient ", worst_force,
                ", largest change of energy in 1e-5 m ", worst_jump);
        CHECK(worst_force < 1e-3);       // error of a central difference over 1e-7 m
        CHECK(worst_jump < 0.02 * 1e-5); // overlap times gradient times step
    }

    TEST_CASE("the share of a contact force on an element follows from a virtual displacement of "
              "the element") {
        const Uneven uneven(4, 0.05, false, 2);
        const double r = 0.02, step = 1e-7;
        double worst = 0;
        for (const double z : {0.01, 0.1, 0.15, 0.19, 0.3}) {
            const double out = 0.14;
            const auto distance = [&](Row element, double by) {
                Uneven moved = uneven;
                moved.radius[element] += by;
                return moved.surface().nearest(3, out, z).distance;
            };
            const auto n = uneven.surface().nearest(3, out, z);
            for (Row e = 3; e < 48; e += 12) {
                // derivative of the distance from the surface
                const double slope = (distance(e, step) - distance(e, -step)) / (2 * step);
                double share = (e == n.foot.lower ? 1 - n.foot.share : 0) +
                               (e == n.foot.upper ? n.foot.share : 0);
                worst = std::max(worst, std::abs(slope + share * n.radial));
            }
            CHECK(n.distance < r); // the sphere touches the surface
        }
        CHECK(worst < 1e-6);
    }

    TEST_CASE("the area of an element is the derivative of the volume below the platen with "
              "respect to its radius") {
        for (const double top : {0.1, 0.25, 0.29, 0.304, 0.35}) {
            const Uneven uneven(4, 0.01, false, 3);
            std::vector<double> area(48);
            compute_areas(uneven.membrane, uneven.radius.data(), top, area.data());
            double worst = 0;
            for (std::size_t e = 0; e < 48; ++e) {
                auto more = uneven.radius, less = uneven.radius;
                more[e] += 1e-6;
                less[e] -= 1e-6;
                const double slope = (membrane_volume(uneven.membrane, more.data(), top) -
                                      membrane_volume(uneven.membrane, less.data(), top)) /
                                     2e-6;
                worst = std::max(worst, std::abs(area[e] - slope));
            }
            // the volume is quadratic in the radii, so the central difference is exact
            CHECK(worst < 1e-9);
        }
        const Uneven even(4, 0, true, 4); // a prism
        CHECK(membrane_volume(even.membrane, even.radius.data(), 0.3) ==
              about(0.3 * 12 * 0.15 * 0.15 * std::tan(pi / 12)).epsilon(1e-12));
    }

    TEST_CASE("a widened membrane has no gap in any direction") {
        // rings of random radii widened by 24 %; points outside it are tested in all directions
        // from the axis
        Uneven uneven(8, 0.05, true, 5);
        for (double& x : uneven.radius) x *= 1.24;
        const MembraneSurface s = uneven.surface();
        Random random(6, 0);
        for (int k = 0; k < 2000; ++k) {
            const double angle = random.uniform(0, 2 * pi), z = random.uniform(0.0, 8 * 0.076);
            const Vec3 outside(0.27 * std::cos(angle), 0.27 * std::sin(angle), z);
            double least = 1;
            for (int sector = 0; sector < 12; ++sector)
                least =
                    std::min(least, s.nearest(sector, outside.dot(s.outward[sector]), z).distance);
            REQUIRE(least < 0);
        }
    }

    TEST_CASE(
        "the energy budget includes the dashpots of a membrane, and its error decreases with dt") {
        double open[2] = {0, 0}, taken = 0;
        for (int fine = 0; fine < 2; ++fine) {
            World world = make_world(Grains::spheres);
            const auto material = add_material(world, linear_material(2e4, 0, 0));
            world.resource<Materials>().list[material].normal_damping = 100;
            world.resource<Materials>().mix();
            add_tube(world, {.rings = 2, .sectors = 8, .radius = 0.045, .height = 0.1}, material);
            world.resource<Membrane>().active = false;
            const EntityId ball = add_sphere(world, Vec3(0, 0, 0.04), 0.0085, material);
            value_of<Velocity>(world, ball) = Vec3(0.5, 0.1, 0.03);
            Simulation sim = begin(std::move(world), {.dt = fine == 1 ? 5e-6 : 1e-5,
                                                      .law = LawName::linear_viscous,
                                                      .energy_budget = true});
            const double before = compute_quantities(sim.world()).kinetic_energy;
            sim.advance(fine == 1 ? 60000 : 30000);
            const Quantities q = compute_quantities(sim.world());
            taken = value_of<ViscousWork>(sim, ball);
            open[fine] = std::abs(q.kinetic_energy + q.elastic_energy + taken - before);
            CHECK(taken > 0.1 * before);
        }
        MESSAGE("energy error ", open[0], " J, at half the step ", open[1], " J; dissipated ",
                taken, " J");
        CHECK(open[0] < 1e-3 * taken);
        CHECK(open[1] < open[0]);
    }

    TEST_CASE(
        "the energy is balanced when membrane elements move and grains slide over their slopes") {
        // grains move inside a membrane whose rings oscillate with different phases
        double error[2] = {0, 0}, work = 0;
        for (int fine = 0; fine < 2; ++fine) {
            World world = make_world(Grains::spheres);
            const auto material = add_material(world, linear_material(2e4));
            add_tube(world, {.rings = 4, .sectors = 8, .radius = 0.045, .height = 0.2}, material);
            world.resource<Membrane>().active = false;
            Random random(9, 0);
            for (int k = 0; k < 60; ++k) {
                const Vec3 position(0.018 * (k % 3 - 1), 0.018 * (k / 3 % 3 - 1),
                                    0.01 + 0.018 * (k / 9));
                value_of<Velocity>(world, add_sphere(world, position, 0.0085, material)) =
                    0.3 * random.direction();
            }
            world.table<Bodies>().add<BoundaryWork>();
            Simulation sim = begin(std::move(world), {.dt = fine == 1 ? 5e-6 : 1e-5,
                                                      .law = LawName::linear_frictionless});
            const unsigned each = fine == 1 ? 40 : 20;
            sim.advance(each);
            const auto energy = [&] {
                const Quantities q = compute_quantities(sim.world());
                double done = 0;
                for (const double w : sim.world().column<Bodies, BoundaryWork>()) done += w;
                work = done;
                return q.kinetic_energy + q.elastic_energy - done;
            };
            for (double& v : sim.world().column<Elements, ElementSpeed>()) v = 0;
            const double first = energy();
            for (int k = 0; k < 1000; ++k) {
                for (Row e = 0; e < 32; ++e)
                    sim.world().column<Elements, ElementSpeed>()[e] =
                        0.15 * std::sin(2 * pi * k / 250 + e / 8);
                sim.advance(each);
            }
            error[fine] = std::abs(energy() - first);
            CHECK(compute_quantities(sim.world()).kinetic_energy > 1e-4); // the grains were stirred
        }
        MESSAGE("energy error ", error[0], " J, at half the step ", error[1], " J; work ", work,
                " J");
        CHECK(error[1] < 0.01 * std::abs(work));
    }
}
