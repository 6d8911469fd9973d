// Facets are one surface within the precision of their input, and no farther: corners rounded to
// single precision, and coplanar facets of hosts that move as one.
#include "tests/about.hpp"
#include "tests/support.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <functional>

using namespace bris;
using namespace bris::testing;

namespace {

constexpr double radius = 0.01, stiffness = 1e5, load = 30 * 9.81;
using Floor = std::function<void(World&, std::uint32_t)>;

/// Axes of a floor: two along it, and its normal.
struct Frame {
    Vec3 along, across, normal;
};
Frame tilted() {
    const Vec3 normal = Vec3(0.3, 0.5, 0.8).normalized(),
               across = normal.cross(Vec3::UnitX()).normalized();
    return {normal.cross(across), across, normal};
}
const Frame level{Vec3::UnitX(), Vec3::UnitY(), Vec3::UnitZ()};

Vec3 rounded(const Vec3& x) { return x.cast<float>().cast<double>(); }

/// A square floor of triangles through the origin, with corners as binary STL files have them, or
/// exact ones.
Floor triangles(const Frame& frame, int cells, bool is_rounded) {
    return [=](World& world, std::uint32_t material) {
        const EntityId host = add_boundary(world, Vec3::Zero(), material, Motion::fixed, 0.1);
        constexpr double side = 0.04;
        const auto at = [&](int i, int j) {
            const Vec3 x = (side * i / cells - side / 2) * frame.along +
                           (side * j / cells - side / 2) * frame.across;
            return is_rounded ? rounded(x) : x;
        };
        for (int i = 0; i < cells; ++i)
            for (int j = 0; j < cells; ++j) {
                const Vec3 a = at(i, j), b = at(i + 1, j), c = at(i + 1, j + 1), d = at(i, j + 1);
                add_facet(world, host, {{a, b, c, c}});
                add_facet(world, host, {{a, c, d, d}});
            }
    };
}

FacetShape square(double low, double high, double height) {
    return {{Vec3(low, -0.05, height), Vec3(high, -0.05, height), Vec3(high, 0.05, height),
             Vec3(low, 0.05, height)}};
}

struct Slid {
    double least = 1e9, most = -1e9; ///< overlap over that at rest
    double speed = 0;                ///< final over initial one
    double aside = 0;                ///< m
    Vec3 spin = Vec3::Zero();        ///< rad/s
};

/// A sphere in equilibrium under 30 times its weight slides over the middle of a floor.
Slid slide(const Floor& floor, const Frame& frame, double friction = 0) {
    World world = make_world(Grains::spheres);
    const auto material = add_material(world, linear_material(stiffness, 5e4, friction));
    floor(world, material);
    const Vec3 begins = -0.006 * frame.along + 0.0031 * frame.across + radius * frame.normal;
    const EntityId ball = add_sphere(world, begins, radius, material);
    const double rest = value_of<Mass>(world, ball) * load / stiffness, speed = 0.5;
    value_of<Position>(world, ball) -= rest * frame.normal;
    value_of<Velocity>(world, ball) = speed * frame.along;
    world.add_resource<Gravity>({Vec3(-load * frame.normal)});
    Simulation sim = begin(std::move(world), {.dt = 5e-6});
    Slid slid;
    for (int k = 0; k < 480; ++k) {
        sim.advance(10);
        const Vec3 x = value_of<Position>(sim, ball);
        const double overlap = (radius - x.dot(frame.normal)) / rest;
        slid.least = std::min(slid.least, overlap);
        slid.most = std::max(slid.most, overlap);
        slid.aside = std::max(slid.aside, std::abs((x - begins).dot(frame.across)));
    }
    REQUIRE(value_of<Position>(sim, ball).dot(frame.along) > (friction > 0 ? 0.003 : 0.0059));
    slid.speed = value_of<Velocity>(sim, ball).norm() / speed;
    slid.spin = value_of<AngularVelocity>(sim, ball);
    return slid;
}

/// Force (N, upwards) of the first step on a sphere that is 1e-4 m before x = 0 and `overlap` deep
/// in the plane z = 0, over that of one contact.
double contacts(const Floor& floor, double overlap = 3.3e-5) {
    World world = make_world(Grains::spheres);
    const auto material = add_material(world, linear_material(stiffness, 5e4, 0));
    floor(world, material);
    const EntityId ball = add_sphere(world, Vec3(-1e-4, 0.001, radius - overlap), radius, material);
    Simulation sim = begin(std::move(world), {.dt = 1e-6});
    sim.advance();
    return value_of<Force>(sim, ball).z() / (stiffness * overlap);
}

/// Squares on both sides of x = 0, the second one higher by a step.
Floor with_step(double height) {
    return [=](World& world, std::uint32_t material) {
        const EntityId host = add_boundary(world, Vec3::Zero(), material, Motion::fixed, 0.1);
        add_facet(world, host, square(-0.05, 0, 0));
        add_facet(world, host, square(0, 0.05, height));
    };
}

/// The same on two hosts; `change` may make them differ.
Floor on_two_hosts(const std::function<void(World&, EntityId, EntityId)>& change = {},
                   bool same_material = true, Motion motion = Motion::fixed) {
    return [=](World& world, std::uint32_t material) {
        const auto other =
            same_material ? material : add_material(world, linear_material(stiffness, 5e4, 0));
        const EntityId one = add_boundary(world, Vec3::Zero(), material, motion, 0.1),
                       two = add_boundary(world, Vec3(0.02, 0, 0), other, motion, 0.1);
        add_facet(world, one, square(-0.05, 0, 0));
        add_facet(world, two, square(-0.02, 0.05, 0));
        if (change) change(world, one, two);
    };
}

} // namespace

TEST_SUITE("physics/facets") {
    TEST_CASE("a sphere slides over triangles with corners in single precision as over a plane") {
        // cells of 0.8 mm; so far from the contact the sphere is still below the plane
        const Slid exact = slide(triangles(tilted(), 50, false), tilted()),
                   read = slide(triangles(tilted(), 50, true), tilted());
        CHECK(exact.least == about(1).epsilon(1e-8));
        CHECK(exact.most == about(1).epsilon(1e-8));
        CHECK(exact.speed == about(1).epsilon(1e-8));
        // corners are off by up to 2e-9 m, 6e-5 of the overlap; a sphere without damping oscillates
        // when it passes them
        CHECK(read.least == about(1).epsilon(1e-3));
        CHECK(read.most == about(1).epsilon(1e-3));
        CHECK(read.speed == about(1).epsilon(1e-5));
        CHECK(read.aside < 1e-7);
    }

    TEST_CASE("a sphere slides over the seam of two hosts as over one plane") {
        const Slid slid = slide(on_two_hosts(), level);
        CHECK(slid.least == about(1).epsilon(1e-9));
        CHECK(slid.most == about(1).epsilon(1e-9));
        CHECK(slid.speed == about(1).epsilon(1e-9));
        // with friction the tangential spring passes from one host to the other
        const Slid rolled = slide(on_two_hosts(), level, 0.02),
                   on_plane = slide([](World&w, std::uint32_t m) { add_floor(w, m); }, level, 0.02);
        REQUIRE(on_plane.spin.norm() > 1);
        CHECK(rolled.speed == about(on_plane.speed).epsilon(1e-9));
        CHECK((rolled.spin - on_plane.spin).norm() < 1e-9 * on_plane.spin.norm());
    }

    TEST_CASE("hosts are one surface only while they move as one and are of one material") {
        CHECK(contacts(on_two_hosts()) == about(1).epsilon(1e-9));
        CHECK(contacts(on_two_hosts({}, false)) == about(2).epsilon(1e-2));
        const auto moving = [](double first, double second) {
            return [=](World& world, EntityId one, EntityId two) {
                for (const auto& [host, speed] : {std::pair{one, first}, {two, second}}) {
                    value_of<Velocity>(world, host) = Vec3(0, speed, 0);
                    value_of<DriveVelocity>(world, host) = Vec3(0, speed, 0);
                }
            };
        };
        CHECK(contacts(on_two_hosts(moving(1e-3, 1e-3), true, Motion::prescribed)) ==
              about(1).epsilon(1e-9));
        CHECK(contacts(on_two_hosts(moving(1e-3, 2e-3), true, Motion::prescribed)) ==
              about(2).epsilon(1e-2));
    }

    TEST_CASE("hosts that turn about one axis move as one, those that turn about two do not") {
        const auto turning = [](const Vec3& axis) {
            return [=](World& world, EntityId one, EntityId two) {
                for (const EntityId host : {one, two}) set_angular_velocity(world, host, axis);
            };
        };
        // the second host is beside the first one along x
        CHECK(contacts(on_two_hosts(turning(Vec3(0.1, 0, 0)), true, Motion::prescribed)) ==
              about(1).epsilon(1e-9));
        CHECK(contacts(on_two_hosts(turning(Vec3(0, 0, 0.1)), true, Motion::prescribed)) ==
              about(2).epsilon(1e-2));
    }

    TEST_CASE("a step higher than the precision of the input is an edge, one below it is not") {
        CHECK(contacts(with_step(0)) == about(1).epsilon(1e-9));
        CHECK(contacts(with_step(2e-9)) == about(1).epsilon(1e-9));
        // the edge is nearer to the sphere than the face below it
        CHECK(contacts(with_step(1e-6)) > 2);
        CHECK(contacts(with_step(1e-5)) > 2.2);
    }

    TEST_CASE("a valley of a thousandth is two faces, one of a rounding error is one") {
        const auto valley = [](double slope) -> Floor {
            return [=](World& world, std::uint32_t material) {
                const EntityId host =
                    add_boundary(world, Vec3::Zero(), material, Motion::fixed, 0.1);
                const Vec3 left(-0.05, 0, 0), right(0.05, 0, 0.05 * slope), y(0, 0.05, 0);
                add_facet(world, host, {{left - y, -y, y, left + y}});
                add_facet(world, host, {{-y, right - y, right + y, y}});
            };
        };
        const auto over_both = [&](double slope) { // beyond the seam of both
            return contacts([&](World& w, std::uint32_t m) {
                const Floor made = valley(slope);
                made(w, m);
                for (LocalFacet::Value& shape : w.column<Facets, LocalFacet>())
                    for (Vec3& corner : shape.corners) corner.x() += 0.5 * slope * radius - 1e-4;
            });
        };
        CHECK(over_both(1e-3) == about(2).epsilon(1e-2));
        CHECK(over_both(1e-8) == about(1).epsilon(1e-3));
    }
}
