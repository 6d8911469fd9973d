#include "scenarios/ballast_box/pour.hpp"

#include "components/kinds.hpp"
#include "engine/ordering.hpp"
#include "engine/random_vector.hpp"
#include "scenarios/specimens/scene.hpp"
#include "scenarios/specimens/sphere_cells.hpp"

#include <algorithm>
#include <cmath>

namespace bris {

namespace {

constexpr double filling = 0.3; // of bounding spheres in the column: random places are found soon
constexpr std::uint64_t place_stream = 8001;

void lay_sensors(World& world, std::size_t course) {
    const auto& sensors = world.resource<BoxBodies>().sensors;
    for (const BoxSensor& s : sensors) {
        if (course == 0 || s.course + 1 != course) continue;
        const double radius = value_of<BoundingRadius>(world, s.body),
                     x = std::max(s.place.x(), radius), y = std::max(s.place.y(), radius);
        const double height = surface_height(world, x, y, radius, 0);
        release(world, s.body, Vec3(x, y, height + radius));
    }
}

} // namespace

void pour_course(World& world, const BoxSizes& s, std::size_t course, std::uint64_t seed) {
    lay_sensors(world, course);
    const auto& ids = world.resource<BoxBodies>().rocks[course];
    const auto rows = rows_by_id(world.column<Bodies, BodyId>());
    const auto radius = world.column<Bodies, BoundingRadius>();
    const double depth = course == 0 ? s.across : s.bladder_face();
    double largest = 0, volume = 0;
    for (const EntityId id : ids) {
        largest = std::max(largest, radius[rows[id]]);
        volume += 4 * pi / 3 * std::pow(radius[rows[id]], 3);
    }
    const double low = surface_height(world, Vec3::Zero(), Vec3(s.width, s.across, 0), 0) + 0.002;
    double high = low + 2 * largest + volume / (filling * s.width * depth);
    SphereCells cells(largest);
    std::vector<EntityId> order = ids; // largest first
    std::ranges::sort(order, [&](EntityId a, EntityId b) {
        return radius[rows[a]] != radius[rows[b]] ? radius[rows[a]] > radius[rows[b]] : a < b;
    });
    for (const EntityId id : order) {
        Random random(seed, place_stream + id);
        const double r = radius[rows[id]];
        for (int attempt = 1;; ++attempt) {
            if (attempt % 200 == 0) high += largest; // little room
            const Vec3 at =
                place_in_box(random, Vec3(r, r, low + r),
                             Vec3(std::max(s.width - r, 1.001 * r), depth - r, high - r));
            if (!cells.is_clear(at, r)) continue;
            cells.add(at, r);
            release(world, id, at);
            break;
        }
    }
}

} // namespace bris
