#include "scenarios/specimens/vessels.hpp"
#include "tests/about.hpp"
#include "tests/support.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <functional>

using namespace bris;
using namespace bris::testing;

namespace {

// area of a quadrilateral as two triangles; for a triangle the second has no area
double area(const FacetShape& f) {
    const auto& c = f.corners;
    return 0.5 *
           ((c[1] - c[0]).cross(c[2] - c[0]).norm() + (c[2] - c[0]).cross(c[3] - c[0]).norm());
}

double area(const std::vector<FacetShape>& shapes) {
    double sum = 0;
    for (const FacetShape& f : shapes) sum += area(f);
    return sum;
}

struct Surface {
    double volume = 0;
    Vec3 vector = Vec3::Zero();
};

// volume on the side of the normals (divergence theorem), and sum of area times normal, which is
// zero for a closed surface
Surface enclosed(const std::vector<FacetShape>& shapes) {
    Surface s;
    for (const FacetShape& f : shapes)
        for (const std::size_t k : {std::size_t{1}, std::size_t{2}}) {
            const Vec3 normal =
                0.5 * (f.corners[k] - f.corners[0]).cross(f.corners[k + 1] - f.corners[0]);
            s.volume -= normal.dot(f.corners[0]) / 3;
            s.vector += normal;
        }
    return s;
}

std::vector<FacetShape> joined(std::vector<FacetShape> a, const std::vector<FacetShape>& b) {
    a.insert(a.end(), b.begin(), b.end());
    return a;
}

/// Elastic spheres of 1 mm diameter shot from a block of sites in a vessel at 5 m/s in random
/// directions.
struct Shots {
    std::vector<Vec3> end;
    double travel = 0; ///< m, path of most spheres: few collide with each other
};

Shots shoot(const std::function<EntityId(World&, std::uint32_t)>& add_vessel,
            const Eigen::AlignedBox3d& block, const Vec3& angular_velocity) {
    constexpr int shots = 2000, steps = 20000;
    constexpr double dt = 3e-6, speed = 5, pitch = 0.003;
    World world = make_world(Grains::spheres);
    const auto material = add_material(world, linear_material(2e4, 0, 0));
    value_of<AngularVelocity>(world, add_vessel(world, material)) = angular_velocity;
    const Eigen::Vector3i n = (block.sizes() / pitch).cast<int>();
    REQUIRE(n.prod() >= shots);
    for (int k = 0; k < shots; ++k) {
        Random random(5, static_cast<std::uint64_t>(k));
        const Vec3 site(k % n.x() + 0.5, k / n.x() % n.y() + 0.5, k / n.x() / n.y() + 0.5);
        const EntityId id = add_sphere(world, Vec3(block.min()) + pitch * site, 5e-4, material);
        value_of<Velocity>(world, id) = speed * random.direction();
    }
    // a wall stops a sphere of 1.4 mg within v sqrt(m/kn) = 0.04 mm; a contact takes 9 steps
    Simulation sim = begin(
        std::move(world),
        {.dt = dt,
         .law = LawName::linear_frictionless,
         .lists = {.outer_skin = 0.01, .inner_skin = 0.004, .largest_skin = 0.012, .tune = false}});
    sim.advance(steps);
    Shots result{{}, speed * steps * dt};
    const World& w = sim.world();
    for (Row b = 0; b < w.table<Bodies>().size(); ++b)
        if (w.column<Bodies, MotionOf>()[b] == static_cast<std::uint32_t>(Motion::free))
            result.end.push_back(w.column<Bodies, Position>()[b]);
    return result;
}

} // namespace

TEST_SUITE("specimens/vessels") {
    TEST_CASE("a polygonal silo with its plate has the volume of the round one, and no gap") {
        for (const unsigned sectors : {8u, 64u, 128u}) {
            const auto closed = joined(joined(joined(shell({0.03, 0, 0.1, 0.07}, sectors),
                                                     shell({0.1, 0.07, 0.1, 0.37}, sectors)),
                                              disc(0.03, 0, sectors)),
                                       disc(0.1, 0.37, sectors, false));
            const Surface s = enclosed(closed);
            const double cone = pi * 0.07 / 3 * (0.03 * 0.03 + 0.03 * 0.1 + 0.1 * 0.1),
                         barrel = pi * 0.01 * 0.3;
            // round-off only: about 200 terms of 1e-4 m3
            CHECK(s.volume == about(cone + barrel).epsilon(1e-13));
            CHECK(s.vector.norm() < 1e-15);
        }
    }

    TEST_CASE("areas of shells converge to those of the round surface from above, as (pi/n)^2") {
        // perimeter of a polygon of equal area relative to that of the circle:
        // sqrt(n tan(pi/n) / pi) = 1 + (pi/n)^2/6 + O(n^-4)
        for (const unsigned n : {16u, 64u}) {
            const double expected = 1 + std::pow(pi / n, 2) / 6, remainder = std::pow(pi / n, 4);
            CHECK(std::abs(area(shell({0.1, 0, 0.1, 0.3}, n)) / (2 * pi * 0.1 * 0.3) - expected) <
                  remainder);
            // the areas of a flat ring and of a disc are exact
            CHECK(area(shell({0.03, 0, 0.1, 0}, n)) == about(pi * (0.01 - 0.0009)).epsilon(1e-13));
            CHECK(area(disc(0.1, 0, n)) == about(pi * 0.01).epsilon(1e-13));
        }
    }

    TEST_CASE("facets are convex and face the grains") {
        const Vec3 middle(0, 0, 0.2);
        const auto all =
            joined(joined(shell({0.03, 0, 0.1, 0.07}, 64), shell({0.1, 0.07, 0.1, 0.37}, 64)),
                   joined(disc(0.03, 0, 64),
                          joined(disc(0.1, 0.37, 64, false), shell({0.03, 0, 0.1, 0}, 64))));
        for (const FacetShape& f : all) {
            const auto& c = f.corners;
            const Vec3 normal = (c[1] - c[0]).cross(c[2] - c[0]).normalized();
            CHECK(normal.dot(middle - c[0]) > 0);
            for (std::size_t k = 0; k < 4; ++k) {
                const Vec3 edge = c[(k + 1) % 4] - c[k];
                for (const Vec3& other : c) CHECK(normal.cross(edge).dot(other - c[k]) >= -1e-15);
                CHECK(std::abs((c[k] - c[0]).dot(normal)) < 1e-15); // plane
            }
        }
    }

    TEST_CASE("2000 spheres shot at random stay in a closed silo, whatever seam or corner they "
              "hit") {
        const Silo silo{.lip = 0, .barrel = 0.07, .top = 0.2};
        const Shots shots = shoot(
            [&](World& w, std::uint32_t m) {
                const SiloBodies bodies = add_silo(w, silo, m);
                add_facets(w, bodies.wall, disc(silo.radius, silo.top, silo.sectors, false));
                return bodies.wall;
            },
            {Eigen::Vector3d(-0.015, -0.015, 0.01), Eigen::Vector3d(0.015, 0.015, 0.19)},
            Vec3::Zero());
        REQUIRE(shots.end.size() == 2000);
        const double out = 0.1 * corner_radius(64);
        int outside = 0;
        for (const Vec3& x : shots.end) {
            const double r = std::hypot(x.x(), x.y()),
                         wall = std::min(out, (0.03 + std::max(0.0, x.z())) * corner_radius(64));
            if (!(r < wall && x.z() > 0 && x.z() < 0.2)) ++outside;
        }
        CHECK(outside == 0);
        CHECK(shots.travel > 0.25); // longer than the vessel: each has hit the wall
    }

    TEST_CASE("2000 spheres shot at random stay in a drum at rest and in a rotating one") {
        for (const double speed : {0.0, 20.0}) {
            const Shots shots =
                shoot([](World& w, std::uint32_t m) { return add_drum(w, {}, m); },
                      {Eigen::Vector3d(-0.03, -0.029, -0.03), Eigen::Vector3d(0.03, 0.029, 0.03)},
                      Vec3(0, -speed, 0));
            int outside = 0;
            for (const Vec3& x : shots.end)
                if (!(std::hypot(x.x(), x.z()) < 0.1 * corner_radius(128) &&
                      std::abs(x.y()) < 0.03))
                    ++outside;
            CHECK(outside == 0);
        }
    }
}
