#include "tests/performance/peers/moving_walls.hpp"

#include "components/body.hpp"
#include "components/kinds.hpp"
#include "components/settings.hpp"
#include "engine/clock.hpp"
#include "scenarios/specimens/scene.hpp"

namespace bris::peers {

namespace {

Row row_of_wall(const World& world, int axis) {
    const auto bodies = static_cast<EntityId>(world.table<Bodies>().size());
    return row_of_body(world, bodies - 3 + static_cast<EntityId>(axis));
}

} // namespace

void add_moving_box(World& world, const Vec3& box, std::uint32_t material) {
    const EntityId corner = add_boundary(world, Vec3::Zero(), material);
    for (int a = 0; a < 3; ++a) add_plane(world, corner, Vec3::Zero(), Vec3::Unit(a));
    for (int a = 0; a < 3; ++a) {
        const EntityId wall =
            add_boundary(world, box[a] * Vec3::Unit(a), material, Motion::prescribed);
        add_plane(world, wall, Vec3::Zero(), -Vec3::Unit(a));
    }
}

Vec3 sides_of(const World& world) {
    Vec3 sides;
    for (int a = 0; a < 3; ++a)
        sides[a] = world.column<Bodies, Position>()[row_of_wall(world, a)][a];
    return sides;
}

Vec3 pressure_on(const World& world) {
    const Vec3 sides = sides_of(world);
    Vec3 pressure;
    for (int a = 0; a < 3; ++a)
        pressure[a] =
            world.column<Bodies, Force>()[row_of_wall(world, a)][a] * sides[a] / sides.prod();
    return pressure;
}

void move_walls(Simulation& simulation, const Vec3& velocity) {
    World& world = simulation.world();
    for (int a = 0; a < 3; ++a)
        world.column<Bodies, DriveVelocity>()[row_of_wall(world, a)] = velocity[a] * Vec3::Unit(a);
}

std::vector<Vec3> compress(Simulation& simulation, double strain, std::uint64_t steps) {
    constexpr unsigned rest = path_parts / 10;
    const std::uint64_t part = steps / path_parts;
    const double time = static_cast<double>(part * (path_parts - 2 * rest)) *
                        simulation.world().resource<Clock>().dt;
    const Vec3 velocity =
        strain / time * sides_of(simulation.world()).cwiseProduct(Vec3(0.5, 0.5, -1));
    std::vector<Vec3> pressures;
    for (unsigned k = 0; k < path_parts; ++k) {
        move_walls(simulation, k < rest || k >= path_parts - rest ? Vec3(0, 0, 0) : velocity);
        simulation.advance(part);
        pressures.push_back(pressure_on(simulation.world()));
    }
    return pressures;
}

} // namespace bris::peers
