// S5: a scene that carries no load is never reported to be in equilibrium.
#include "scenarios/specimens/equilibrium.hpp"

#include "engine/random.hpp"
#include "scenarios/specimens/small_scene.hpp"
#include "tests/stability/cases.hpp"

#include <fmt/format.h>

namespace bris {

namespace {

World box(unsigned spheres, double pitch, double speed, const Vec3& gravity, std::uint64_t seed) {
    World world = make_world(Grains::spheres);
    const auto grain = world.resource<Materials>().add(linear_material(1e5, 3e4, 0.5));
    Random random(seed, 5);
    for (unsigned k = 0; k < spheres; ++k)
        value_of<Velocity>(
            world, add_sphere(world, pitch * Vec3(0.5 + k % 3, 0.5 + k / 3 % 3, 0.5 + k / 9), 0.01,
                              grain)) = speed * random.direction();
    add_box(world, Vec3::Zero(), 3 * pitch * Vec3::Ones(), grain);
    world.add_resource<Gravity>({gravity});
    world.add_resource(LocalDamping{0});
    return world;
}

} // namespace

StressRows stress_vacuous_equilibrium(const StressSettings& s) {
    StressRows rows;
    const auto add = [&](const std::string& what, World world, const std::string& wanted) {
        Simulation simulation = begin(std::move(world), {.dt = 2e-5, .law = LawName::linear});
        std::uint64_t taken = 0;
        const std::string refusal = refusal_of(
            [&] { taken = find_equilibrium(simulation, {.longest = s.full ? 100'000u : 5000u}); });
        const auto at = refusal.find("s: "); // after step and time
        rows.push_back(
            {"S5", what, wanted.empty() ? "converges to equilibrium" : "refused: " + wanted,
             refusal.empty() ? fmt::format("in equilibrium after {} steps", taken)
                             : refusal.substr(at + 3),
             wanted.empty() ? refusal.empty() : refusal.find(wanted) != std::string::npos});
    };
    const Vec3 none = Vec3::Zero(), down(0, 0, -9.81);
    add("an empty box", box(0, 0.03, 0, down, s.seed), "no load path");
    add("one sphere without contacts", box(1, 0.03, 0, none, s.seed), "no load path");
    add("rattlers: separate spheres at rest without gravity", box(27, 0.03, 0, none, s.seed),
        "no load path");
    add("a gas: moving spheres without gravity", box(27, 0.03, 1, none, s.seed), "no ");
    World exploded = box(27, 0.019, 0, none, s.seed); // deep overlaps and no wall
    exploded.table<Planes>().resize(0);
    exploded.resource<Limits>().overlap = 1;
    add("an explosion: spheres driven apart by deep overlaps", std::move(exploded), "no load path");
    World bed = box(27, 0.021, 0, down, s.seed);
    bed.resource<LocalDamping>().fraction = 0.7;
    add("a bed under its weight", std::move(bed), "");
    return rows;
}

} // namespace bris
