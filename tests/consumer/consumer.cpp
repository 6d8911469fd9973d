// Spheres fall onto a floor. Prints the number of lanes and the fingerprint of the last state.
#include "engine/archive.hpp"
#include "engine/lanes.hpp"
#include "scenarios/specimens/scene.hpp"
#include "scenarios/specimens/start.hpp"

#include <cstdio>

int main() {
    using namespace bris;
    World world = make_world(Grains::spheres);
    const std::uint32_t stone = world.resource<Materials>().add(linear_material(1e6));
    add_floor(world, stone);
    for (int k = 0; k < 64; ++k)
        add_sphere(world, 0.021 * Vec3(k % 4 + 0.1 * (k / 16), k / 4 % 4, 1 + k / 16), 0.01, stone);
    world.add_resource<Gravity>();
    world.resource<Clock>().dt = 2e-5;
    Simulation simulation = start(std::move(world), {.law = LawName::linear, .threads = 2});
    simulation.advance(10000);
    std::printf("%d lanes, %s\n", lane_count,
                hexadecimal(fingerprint(simulation.snapshot())).c_str());
}
