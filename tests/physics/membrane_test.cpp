#include "systems/contact/facet_geometry.hpp"
#include "systems/servo/membrane.hpp"
#include "systems/servo/platen.hpp"
#include "tests/support.hpp"

#include <doctest/doctest.h>

using namespace bris;
using namespace bris::testing;

TEST_SUITE("physics/membrane") {
    TEST_CASE("the exposed width of a side is that of the polygon") {
        for (const int n : {3, 4, 12, 96}) {
            const double angle = 2 * pi / n;
            CHECK(exposed_width(0.7, 0.7, 0.7, angle) == doctest::Approx(2 * 0.7 * std::tan(pi / n)).epsilon(1e-12));
        }
        // a rectangle of half sides 2 and 3: each side is as wide as the other two are apart
        CHECK(exposed_width(2, 3, 3, pi / 2) == doctest::Approx(6).epsilon(1e-12));
        CHECK(exposed_width(3, 2, 1, pi / 2) == doctest::Approx(3).epsilon(1e-12));
        // neighbours that come in front of a side hide it
        CHECK(exposed_width(2, 1, 1, pi / 6) < 0);
        // a side that its neighbours just hide: they meet at its plane
        CHECK(std::abs(exposed_width(1, std::cos(pi / 6), std::cos(pi / 6), pi / 6)) < 1e-14);
    }

    TEST_CASE("the polygon's area is exact for regular polygons and for rectangles") {
        for (const std::size_t n : {3u, 8u, 12u}) {
            const std::vector<double> radius(n, 0.15);
            const double angle = pi / static_cast<double>(n);
            CHECK(polygon_area(radius) == doctest::Approx(static_cast<double>(n) * 0.15 * 0.15 * std::tan(angle)).epsilon(1e-12));
        }
        const std::vector<double> rectangle{2, 3, 1, 5}; // (2 + 1) x (3 + 5)
        CHECK(polygon_area(rectangle) == doctest::Approx(24).epsilon(1e-12));
    }

    TEST_CASE("the polygon's area follows from its corners whatever the radii") {
        Random random(31, 0);
        for (int run = 0; run < 20; ++run) {
            const std::size_t n = 12;
            const double angle = 2 * pi / n;
            std::vector<double> radius(n);
            for (double& r : radius) r = random.uniform(0.97, 1.03);
            const auto direction = [&](std::size_t k) { return Vec3(std::cos(angle * static_cast<double>(k)), std::sin(angle * static_cast<double>(k)), 0); };
            std::vector<Vec3> corner(n); // where side k meets side k + 1
            for (std::size_t k = 0; k < n; ++k) {
                const Vec3 a = direction(k), b = direction(k + 1);
                const double det = a.x() * b.y() - a.y() * b.x(), ra = radius[k], rb = radius[(k + 1) % n];
                corner[k] = Vec3(ra * b.y() - rb * a.y(), rb * a.x() - ra * b.x(), 0) / det;
            }
            double shoelace = 0;
            for (std::size_t k = 0; k < n; ++k) shoelace += 0.5 * corner[k].cross(corner[(k + 1) % n]).z();
            CHECK(polygon_area(radius) == doctest::Approx(shoelace).epsilon(1e-12));
        }
    }

    TEST_CASE("the servo takes one grain to its pressure and holds it there") {
        World world = make_world(Grains::spheres);
        const auto material = add_material(world, contact_material(1e5));
        const double radius = 0.05, pressure = 1e4;
        const EntityId ball = add_sphere(world, Vec3(0, 0, 0.05), 0.0499, material);
        add_tube(world, {.rings = 1, .sectors = 8, .radius = radius, .height = 0.1, .pressure = pressure, .contact_stiffness = 1e5}, material);
        // local damping takes the breathing of the grain between opposite elements
        world.add_resource(LocalDamping{0.7});
        Simulation sim = start(std::move(world), {.dt = 1e-4, .law = LawName::linear_frictionless});
        sim.advance(20'000);
        double worst = 0;
        for (int k = 0; k < 1000; ++k) {
            sim.advance();
            worst = std::max(worst, std::abs(sim.world().resource<Membrane>().pressure[0] / pressure - 1));
        }
        MESSAGE("pressure off by at most ", worst);
        // gain 0.3 a step against the true stiffness: the error shrinks by 0.7 a step, to rounding of the overlap
        CHECK(worst < 1e-9);
        CHECK((of<Position>(sim, ball) - Vec3(0, 0, 0.05)).norm() < 1e-9);
        // pressure times the polygon's area is the sum of the eight radial forces
        const auto& membrane = sim.world().resource<Membrane>();
        double push = 0;
        for (const auto& p : touching_pairs<FacetPairs>(sim.world())) push += p.force.normal_force;
        CHECK(push == doctest::Approx(pressure * 0.1 * 8 * 2 * membrane.radius[0] * std::tan(pi / 8)).epsilon(1e-6));
    }

    TEST_CASE("a membrane that is not active stands still") {
        World world = make_world(Grains::spheres);
        const auto material = add_material(world, contact_material(1e5));
        add_sphere(world, Vec3(0.001, 0, 0.05), 0.0499, material);
        add_tube(world, {.rings = 2, .sectors = 8}, material);
        world.resource<Membrane>().active = false;
        Simulation sim = start(std::move(world), {.dt = 1e-5});
        sim.advance(500);
        for (const double r : sim.world().resource<Membrane>().radius) CHECK(std::abs(r - 0.05) < 1e-17); // a projection, rounded
    }

    TEST_CASE("the force of strips is continuous as a sphere passes from ring to ring, and has no axial part") {
        const auto strip = [](double low, double high) {
            FacetPlaceRow f;
            f.corners = {Vec3(0, -1, low), Vec3(0, 1, low), Vec3(0, 1, high), Vec3(0, -1, high)};
            f.normal = (f.corners[1] - f.corners[0]).cross(f.corners[2] - f.corners[0]).normalized();
            f.velocity = Vec3::Zero();
            return f;
        };
        const double r = 0.1, step = 1e-5;
        for (const double set_back : {0.0, 0.004}) { // of the upper ring, outwards
            FacetPlaceRow lower = strip(-1, 0), upper = strip(0, 1);
            for (Vec3& c : upper.corners) c.x() -= set_back;
            REQUIRE(lower.normal.x() == 1);
            const auto overlap = [&](double x, double z) {
                double sum = 0;
                for (const FacetPlaceRow* f : {&lower, &upper}) {
                    const auto n = detail::nearest_on_strip(*f, Vec3(x, 0, z), r);
                    if (n.feature == detail::Feature::none) continue;
                    CHECK(n.normal == f->normal); // so no axial force
                    CHECK(n.distance < r);
                    sum += r - n.distance;
                }
                return sum;
            };
            const double x = r - 0.006;
            double before = overlap(x, -0.2), worst = 0, least = 1, most = 0;
            for (double z = -0.2; z < 0.2; z += step) {
                const double now = overlap(x, z);
                worst = std::max(worst, std::abs(now - before));
                least = std::min(least, now);
                most = std::max(most, now);
                before = now;
            }
            // d(slice)/dz = z / slice stays below 1 here
            CHECK(worst <= step);
            CHECK(overlap(x, -0.2) == doctest::Approx(0.006));
            CHECK(overlap(x, 0.2) == doctest::Approx(0.006 - set_back));
            CHECK(least >= 0.006 - set_back - 1e-12);
            MESSAGE("set back by ", set_back, ": overlaps from ", least, " to ", most, ", the seam counts ", most / 0.006, " times");
        }
    }

    TEST_CASE("a strip carries only in front of it and between its ends around") {
        FacetPlaceRow f;
        f.corners = {Vec3(0, -1, 0), Vec3(0, 1, 0), Vec3(0, 1, 1), Vec3(0, -1, 1)};
        f.normal = Vec3(1, 0, 0);
        f.velocity = Vec3::Zero();
        const auto touches = [&](const Vec3& x) { return detail::nearest_on_strip(f, x, 0.1).feature != detail::Feature::none; };
        CHECK(touches(Vec3(0.09, 0, 0.5)));
        CHECK_FALSE(touches(Vec3(-0.05, 0, 0.5)));
        CHECK_FALSE(touches(Vec3(0.11, 0, 0.5)));
        CHECK_FALSE(touches(Vec3(0.05, 1.01, 0.5)));
        CHECK(touches(Vec3(0.05, 0, 1.05)));
        CHECK_FALSE(touches(Vec3(0.05, 0, 1.09))); // the slice at the rim is thinner than 0.05
    }
}
