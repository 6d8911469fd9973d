#include "tests/about.hpp"
#include "tests/support.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <functional>

using namespace bris;
using namespace bris::testing;

namespace {

constexpr double radius = 0.01;

Vec3 rebound(const std::function<void(World&, std::uint32_t)>& add_target) {
    World world = make_world(Grains::spheres);
    const auto material = add_material(world, linear_material(1e5, 5e4, 0.5));
    add_target(world, material);
    const EntityId ball = add_sphere(world, Vec3(0, 0, radius + 0.5e-4), radius, material);
    value_of<Velocity>(world, ball) = Vec3(0, 0, -1);
    Simulation sim = begin(std::move(world), {.dt = 2e-6});
    sim.advance(1000);
    return value_of<Velocity>(sim, ball);
}

/// A floor that a sphere slides and rolls on.
using Floor = std::function<void(World&, std::uint32_t)>;
const Floor plane = [](World& w, std::uint32_t m) { add_floor(w, m); };
const Floor triangles = [](World& w, std::uint32_t m) { add_triangle_floor(w, -0.1, 0.1, m); };
const Floor hundred = [](World& w, std::uint32_t m) { add_facet_floor(w, -0.1, 0.1, 10, m); };

struct Track {
    std::vector<Vec3> position, angular_velocity, force;
};

Track slide_over(const Floor& floor, const Vec3& start, const Vec3& velocity,
                 const Vec3& angular_velocity, double friction) {
    World world = make_world(Grains::spheres);
    Material m = linear_material(1e5, 5e4, friction);
    const auto material = add_material(world, m);
    floor(world, material);
    const EntityId ball = add_sphere(world, start, radius, material);
    const double overlap = value_of<Mass>(world, ball) * 9.81 / 1e5;
    value_of<Position>(world, ball) = start + Vec3(0, 0, radius - 1.5 * overlap);
    value_of<Velocity>(world, ball) = velocity;
    set_angular_velocity(world, ball, angular_velocity);
    world.add_resource<Gravity>();
    Simulation sim = begin(std::move(world), {.dt = 2e-5});
    Track track;
    for (int k = 0; k < 400; ++k) {
        for (int j = 0; j < 10; ++j) {
            sim.advance();
            // force of this step, which the next one overwrites
            track.force.push_back(value_of<Force>(sim, ball));
        }
        track.position.push_back(value_of<Position>(sim, ball));
        track.angular_velocity.push_back(value_of<AngularVelocity>(sim, ball));
    }
    return track;
}

double largest_difference(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
    double worst = 0;
    for (std::size_t k = 0; k < a.size(); ++k) worst = std::max(worst, (a[k] - b[k]).norm());
    return worst;
}

void check_same(const Track& a, const Track& b) {
    // heights above a facet are computed from different corners: eps * 0.1 m relative to the
    // overlap, over 4000 steps
    const double position = largest_difference(a.position, b.position),
                 angular_velocity = largest_difference(a.angular_velocity, b.angular_velocity),
                 force = largest_difference(a.force, b.force);
    CHECK(position < 1e-12);
    CHECK(angular_velocity * radius < 1e-10);
    CHECK(force < 1e-6 * 0.1); // 1e-6 of the weight
}

} // namespace

TEST_SUITE("physics/facets") {
    TEST_CASE("an elastic rebound is the same on a plane and on the face, the edge and the vertex "
              "of a facet") {
        const Vec3 from_plane = rebound([](World& w, std::uint32_t m) { add_floor(w, m); });
        const auto single = [](const FacetShape& shape) {
            return [shape](World& w, std::uint32_t m) {
                add_facet(w, add_boundary(w, Vec3::Zero(), m, Motion::fixed, 0.2), shape);
            };
        };
        const Vec3 face = rebound(single(
            {{Vec3(-0.1, -0.1, 0), Vec3(0.1, -0.1, 0), Vec3(0.1, 0.1, 0), Vec3(-0.1, 0.1, 0)}}));
        const Vec3 triangle = rebound(
            single({{Vec3(-0.1, -0.1, 0), Vec3(0.1, -0.1, 0), Vec3(0, 0.1, 0), Vec3(0, 0.1, 0)}}));
        const Vec3 edge = rebound(
            single({{Vec3(-0.1, 0, 0), Vec3(-0.1, 0, -0.1), Vec3(0.1, 0, -0.1), Vec3(0.1, 0, 0)}}));
        const Vec3 vertex = rebound(
            single({{Vec3(0, 0, 0), Vec3(-0.1, 0, -0.1), Vec3(0, 0, -0.2), Vec3(0.1, 0, -0.1)}}));
        CHECK(from_plane.z() == about(1).epsilon(1e-3));
        // rounding of positions of 0.1 m relative to an overlap of 1e-4 m in 500 steps
        for (const Vec3& v : {face, triangle, edge, vertex}) CHECK((v - from_plane).norm() < 1e-10);
    }

    TEST_CASE("a rebound on a seam counts once: between two facets, at a node of four, on a "
              "diagonal of triangles") {
        const Vec3 from_plane = rebound([](World& w, std::uint32_t m) { add_floor(w, m); });
        // the sphere falls on the origin: a node of four facets, a diagonal, a seam of two facets
        CHECK((rebound([](World& w, std::uint32_t m) { add_facet_floor(w, -0.1, 0.1, 10, m); }) -
               from_plane)
                  .norm() < 1e-10);
        CHECK((rebound([](World& w, std::uint32_t m) { add_triangle_floor(w, -0.1, 0.1, m); }) -
               from_plane)
                  .norm() < 1e-10);
        CHECK((rebound([](World& w, std::uint32_t m) {
                   const EntityId host = add_boundary(w, Vec3::Zero(), m, Motion::fixed, 0.2);
                   add_facet(w, host,
                             {{Vec3(-0.1, -0.1, 0), Vec3(0, -0.1, 0), Vec3(0, 0.1, 0),
                               Vec3(-0.1, 0.1, 0)}});
                   add_facet(w, host,
                             {{Vec3(0, -0.1, 0), Vec3(0.1, -0.1, 0), Vec3(0.1, 0.1, 0),
                               Vec3(0, 0.1, 0)}});
               }) -
               from_plane)
                  .norm() < 1e-10);
    }

    TEST_CASE("a ridge between two facets gives one contact, a valley one on each side") {
        const auto roof = [](double slope) {
            return [slope](World& w, std::uint32_t m) {
                const EntityId host = add_boundary(w, Vec3::Zero(), m, Motion::fixed, 0.2);
                const Vec3 left(-0.1, 0, -0.1 * slope), right(0.1, 0, -0.1 * slope), y(0, 0.1, 0);
                add_facet(w, host, {{left - y, -y, y, left + y}});
                add_facet(w, host, {{-y, right - y, right + y, y}});
            };
        };
        const Vec3 from_plane = rebound([](World& w, std::uint32_t m) { add_floor(w, m); });
        CHECK((rebound(roof(0.5)) - from_plane).norm() < 1e-10); // edge shared by two facets
        const Vec3 from_valley = rebound(roof(-0.01)); // both faces carry load: twice the stiffness
        CHECK(from_valley.z() == about(1).epsilon(2e-3));
    }

    TEST_CASE(
        "the edge of a blade gives one contact where the corner of another facet ends on it") {
        const Vec3 from_plane = rebound([](World& w, std::uint32_t m) { add_floor(w, m); });
        const FacetShape edge{
            {Vec3(-0.1, 0, 0), Vec3(-0.1, 0, -0.1), Vec3(0.1, 0, -0.1), Vec3(0.1, 0, 0)}};
        const FacetShape corner{
            {Vec3(0, 0, 0), Vec3(0, -0.1, -0.1), Vec3(0, 0, -0.2), Vec3(0, 0.1, -0.1)}};
        for (const bool corner_first : {true, false}) {
            const Vec3 v = rebound([&](World& w, std::uint32_t m) {
                const EntityId host = add_boundary(w, Vec3::Zero(), m, Motion::fixed, 0.2);
                add_facet(w, host, corner_first ? corner : edge);
                add_facet(w, host, corner_first ? edge : corner);
            });
            CHECK((v - from_plane).norm() < 1e-10);
        }
    }

    TEST_CASE("a sphere slides along the edge of a blade as along one facet, however many facets "
              "it is divided into") {
        const auto blade = [](int pieces) -> Floor {
            return [pieces](World& w, std::uint32_t m) {
                const EntityId host = add_boundary(w, Vec3::Zero(), m, Motion::fixed, 0.2);
                const auto at = [&](int i, double z) {
                    return Vec3(-0.1 + 0.2 * i / pieces, 0, z);
                };
                for (int i = 0; i < pieces; ++i)
                    add_facet(w, host, {{at(i, 0), at(i, -0.1), at(i + 1, -0.1), at(i + 1, 0)}});
            };
        };
        const Track whole =
            slide_over(blade(1), Vec3(-0.05, 0, 0), Vec3(1, 0, 0), Vec3::Zero(), 0.3);
        REQUIRE(whole.position.back().x() > -0.03); // crosses at least one seam
        check_same(whole,
                   slide_over(blade(7), Vec3(-0.05, 0, 0), Vec3(1, 0, 0), Vec3::Zero(), 0.3));
        check_same(whole,
                   slide_over(blade(40), Vec3(-0.05, 0, 0), Vec3(1, 0, 0), Vec3::Zero(), 0.3));
    }

    TEST_CASE("a sphere can have hundreds of facets in its neighbourhood") {
        const Vec3 from_plane = rebound([](World& w, std::uint32_t m) { add_floor(w, m); });
        CHECK((rebound([](World& w, std::uint32_t m) { add_facet_floor(w, -0.02, 0.02, 100, m); }) -
               from_plane)
                  .norm() < 1e-10);
    }

    TEST_CASE("a sphere slides and rolls across seams of two or a hundred facets as on one plane") {
        // along a row, obliquely over nodes, and along a seam; slipping throughout, and sticking
        const Vec3 rolling(0, 1 / radius, 0);
        struct Case {
            Vec3 begin, velocity, angular_velocity;
            double friction;
        };
        for (const Case& c : {Case{Vec3(-0.05, 0.003, 0), Vec3(1, 0, 0), Vec3::Zero(), 0.3},
                              Case{Vec3(-0.05, -0.04, 0), Vec3(1, 0.8, 0), Vec3::Zero(), 0.3},
                              Case{Vec3(-0.05, 0, 0), Vec3(1, 0, 0), Vec3::Zero(), 0.3},
                              Case{Vec3(-0.05, 0.003, 0), Vec3(1, 0, 0), rolling, 0.5},
                              Case{Vec3(-0.05, 0.003, 0), Vec3(0.9, 0.1, 0), rolling, 5}}) {
            CAPTURE(c.begin.transpose());
            CAPTURE(c.friction);
            const Track reference =
                slide_over(plane, c.begin, c.velocity, c.angular_velocity, c.friction);
            REQUIRE(reference.position.back().x() >
                    c.begin.x() + 0.02); // crosses at least one seam
            SUBCASE("two triangles") {
                check_same(reference, slide_over(triangles, c.begin, c.velocity, c.angular_velocity,
                                                 c.friction));
            }
            SUBCASE("a hundred squares") {
                check_same(reference, slide_over(hundred, c.begin, c.velocity, c.angular_velocity,
                                                 c.friction));
            }
        }
    }

    TEST_CASE(
        "a sphere in a corner moves in the same way in a box of facets and in a box of planes") {
        const auto path = [](bool facets) {
            World world = make_world(Grains::spheres);
            Material m = linear_material(1e5, 5e4, 0.3);
            const auto material = add_material(world, m);
            if (facets)
                add_facet_box(world, Vec3::Zero(), Vec3(0.1, 0.1, 0.1), 3, material);
            else
                add_box(world, Vec3::Zero(), Vec3(0.1, 0.1, 0.1), material);
            const EntityId ball = add_sphere(world, Vec3(0.03, 0.025, 0.02), radius, material);
            value_of<Velocity>(world, ball) = Vec3(-1, -0.8, -0.7);
            Simulation sim = begin(std::move(world), {.dt = 1e-5});
            sim.advance(3000); // into the corner and out of it
            return value_of<Position>(sim, ball);
        };
        // three rebounds; rounding of 1e-17 m relative to an overlap of 1e-4 m
        CHECK((path(true) - path(false)).norm() < 1e-10);
    }

    TEST_CASE("the tangential force of a sticking sphere does not change when its spring is "
              "transferred across a seam") {
        // pushed along x below the limit, the sphere creeps over the seam at x = 0 and back
        const auto shear_force = [](const Floor& floor) {
            World world = make_world(Grains::spheres);
            const auto material = add_material(world, linear_material(1e5, 5e4, 0.8));
            floor(world, material);
            const EntityId ball = add_sphere(world, Vec3(-1e-7, 0.001, 0), radius, material);
            value_of<Position>(world, ball).z() = radius - value_of<Mass>(world, ball) * 9.81 / 1e5;
            world.add_resource<Gravity>({Vec3(2, 0, -9.81)});
            Simulation sim = begin(std::move(world), {.dt = 2e-5});
            std::vector<Vec3> forces;
            for (int k = 0; k < 500; ++k) {
                sim.advance();
                forces.push_back(value_of<Force>(sim, ball));
            }
            REQUIRE(value_of<Position>(sim, ball).x() > 0);
            return forces;
        };
        CHECK(largest_difference(shear_force(plane), shear_force(hundred)) < 1e-7);
    }
}
