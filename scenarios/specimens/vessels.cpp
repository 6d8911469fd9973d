#include "scenarios/specimens/vessels.hpp"

#include "components/body.hpp"
#include "components/kinds.hpp"
#include "engine/errors.hpp"
#include "scenarios/specimens/scene.hpp"
#include "systems/broadphase/lists.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace bris {

namespace {

Vec3 corner(double radius, double height, unsigned k, unsigned sectors) {
    const double angle = 2 * pi * k / sectors, far = radius * corner_radius(sectors);
    return {far * std::cos(angle), far * std::sin(angle), height};
}

/// Facet of up to four distinct corners; coincident corners are dropped and the last is repeated.
FacetShape facet_of(const std::array<Vec3, 4>& corners) {
    FacetShape shape{};
    std::size_t count = 0;
    for (const Vec3& c : corners) {
        const auto end = shape.corners.begin() + static_cast<std::ptrdiff_t>(count);
        if (std::find(shape.corners.begin(), end, c) == end) shape.corners[count++] = c;
    }
    for (std::size_t k = count; k < 4; ++k) shape.corners[k] = shape.corners[count - 1];
    return shape;
}

} // namespace

double corner_radius(unsigned sectors) {
    return std::sqrt(2 * pi / (sectors * std::sin(2 * pi / sectors)));
}

std::vector<FacetShape> shell(const Frustum& f, unsigned sectors) {
    require(sectors >= 3, fmt::format("shell: expected at least 3 sectors, found {}", sectors));
    std::vector<FacetShape> shapes;
    for (unsigned k = 0; k < sectors; ++k) {
        const unsigned next = (k + 1) % sectors;
        shapes.push_back(facet_of({corner(f.low_radius, f.low, next, sectors),
                                   corner(f.low_radius, f.low, k, sectors),
                                   corner(f.high_radius, f.high, k, sectors),
                                   corner(f.high_radius, f.high, next, sectors)}));
    }
    return shapes;
}

std::vector<FacetShape> disc(double radius, double height, unsigned sectors, bool upwards) {
    require(sectors >= 4 && sectors % 2 == 0,
            fmt::format("disc: expected an even number of at least 4 sectors, found {}", sectors));
    std::vector<FacetShape> shapes;
    // corner k and its mirror image about the x axis
    const auto above = [&](unsigned k) { return corner(radius, height, k, sectors); };
    const auto below = [&](unsigned k) {
        return corner(radius, height, (sectors - k) % sectors, sectors);
    };
    for (unsigned k = 0; k < sectors / 2; ++k)
        shapes.push_back(upwards ? facet_of({above(k), above(k + 1), below(k + 1), below(k)})
                                 : facet_of({below(k), below(k + 1), above(k + 1), above(k)}));
    return shapes;
}

void add_facets(World& world, EntityId host, std::span<const FacetShape> shapes) {
    for (const FacetShape& shape : shapes) add_facet(world, host, shape);
}

SiloBodies add_silo(World& world, const Silo& s, std::uint32_t material) {
    require(s.orifice_radius > 0 && s.orifice_radius < s.radius && s.lip < s.barrel &&
                s.barrel < s.top,
            "silo: expected an orifice smaller than the barrel, and lip, barrel and top in "
            "increasing order");
    const EntityId wall = add_boundary(world, Vec3::Zero(), material, Motion::fixed,
                                       s.radius + std::max(std::abs(s.lip), std::abs(s.top)));
    add_facets(world, wall, shell({s.orifice_radius, s.lip, s.radius, s.barrel}, s.sectors));
    add_facets(world, wall, shell({s.radius, s.barrel, s.radius, s.top}, s.sectors));
    const EntityId plate =
        add_boundary(world, Vec3(0, 0, s.lip), material, Motion::fixed, 2 * s.radius);
    const double a = 1.5 * s.orifice_radius;
    add_facet(world, plate, {{Vec3(-a, -a, 0), Vec3(a, -a, 0), Vec3(a, a, 0), Vec3(-a, a, 0)}});
    return {wall, plate};
}

void take_away(World& world, EntityId body, const Vec3& away) {
    const Row row = row_of_body(world, body);
    require(world.column<Bodies, MotionOf>()[row] == static_cast<std::uint32_t>(Motion::fixed),
            fmt::format("body {}: expected a fixed body to take away", body));
    world.column<Bodies, Position>()[row] += away;
    invalidate_lists(world);
}

EntityId add_drum(World& world, const Drum& d, std::uint32_t material) {
    const EntityId host = add_boundary(world, Vec3::Zero(), material, Motion::fixed,
                                       std::hypot(2 * d.radius, d.depth));
    std::vector<FacetShape> wall =
        shell({d.radius, -d.depth / 2, d.radius, d.depth / 2}, d.sectors);
    for (FacetShape& shape : wall)
        for (Vec3& c : shape.corners) c = Vec3(c.x(), c.z(), -c.y()); // z becomes y
    add_facets(world, host, wall);
    for (const double side : {-1.0, 1.0})
        add_plane(world, host, Vec3(0, side * d.depth / 2, 0), Vec3(0, -side, 0));
    return host;
}

} // namespace bris
