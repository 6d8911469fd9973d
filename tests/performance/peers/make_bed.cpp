#include "tests/performance/peers/make_bed.hpp"

#include "components/kinds.hpp"
#include "engine/errors.hpp"
#include "engine/random.hpp"
#include "engine/simulation.hpp"
#include "systems/broadphase/lists.hpp"
#include "systems/output/quantities.hpp"
#include "systems/steps.hpp"
#include "tests/performance/peers/moving_walls.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <utility>

namespace bris::peers {

namespace {

constexpr std::uint64_t seed = 7;
constexpr double slippery = 0.1; // low friction, which gives a bed as dense as a shaken one

struct Stage {
    double weight; ///< gravity relative to the scene's
    double friction;
    double damping; ///< local damping
    double falls;   ///< duration relative to the fall of the lattice under this gravity
    double speed;   ///< m/s, initial speed of bodies in random directions
};

/// Spheres of radius 10 mm on a lattice with a square base.
Bed loose_spheres(unsigned spheres) {
    const double radius = 0.01, pitch = 2.05 * radius;
    const auto side = static_cast<unsigned>(std::ceil(std::cbrt(spheres)));
    Bed bed{pitch * Vec3(side, side, (spheres - 1) / (side * side) + 1), {}, {}};
    for (unsigned n = 0; n < spheres; ++n)
        bed.balls.push_back(
            {pitch * Vec3(n % side + 0.5, n / side % side + 0.5, n / (side * side) + 0.5), radius});
    return bed;
}

/// Fouled ballast: 15 000 spheres of radius 2 mm and, with twice their volume, large ones in a box
/// of 126 mm.
Bed loose_mixture(unsigned larges, double large) {
    const double side_of_box = 0.126, small = 0.002, narrow = 2.05 * small;
    const auto across = static_cast<unsigned>(std::lround(side_of_box / (2.1 * large)));
    const unsigned smalls = 15000;
    const double wide = side_of_box / across;
    Bed bed{wide * Vec3(across, across, (larges - 1) / (across * across) + 1), {}, {}};
    for (unsigned n = 0; n < larges; ++n)
        bed.balls.push_back(
            {wide * Vec3(n % across + 0.5, n / across % across + 0.5, n / (across * across) + 0.5),
             large});
    const auto side = static_cast<unsigned>(bed.box.x() / narrow);
    for (unsigned n = 0; bed.balls.size() < larges + smalls; ++n) {
        const Vec3 position =
            narrow * Vec3(n % side + 0.5, n / side % side + 0.5, n / (side * side) + 0.5);
        const auto clear = [&](const Ball& b) {
            return (b.centre - position).norm() > large + 1.02 * small;
        };
        if (std::all_of(bed.balls.begin(), bed.balls.begin() + larges, clear))
            bed.balls.push_back({position, small});
    }
    for (const Ball& b : bed.balls) bed.box.z() = std::max(bed.box.z(), b.centre.z() + b.radius);
    return bed;
}

/// A clump of 30 spheres with radii of 8 to 10 mm on a spiral over an ellipsoid, about
/// 50 x 42 x 34 mm.
std::vector<Ball> rock() {
    const unsigned balls = 30;
    const double golden = pi * (3 - std::sqrt(5.0));
    Random random(seed, 0);
    std::vector<Ball> rock;
    for (unsigned k = 0; k < balls; ++k) {
        const double z = 1 - 2 * (k + 0.5) / balls, s = std::sqrt(1 - z * z),
                     stretch = random.uniform(0.8, 1.15);
        const Vec3 direction(s * std::cos(golden * k), s * std::sin(golden * k), z);
        rock.push_back({stretch * direction.cwiseProduct(Vec3(0.016, 0.012, 0.008)),
                        random.uniform(0.008, 0.010)});
    }
    return rock;
}

/// 396 copies of the clump in random orientations.
Bed loose_rocks() {
    const std::array<unsigned, 3> sides{6, 6, 11};
    const std::vector<Ball> one = rock();
    double reach = 0;
    for (const Ball& b : one) reach = std::max(reach, b.centre.norm() + b.radius);
    const double pitch = 2.02 * reach;
    Bed bed{pitch * Vec3(sides[0], sides[1], sides[2]), {}, {}};
    Random random(seed, 1);
    for (unsigned n = 0; n < sides[0] * sides[1] * sides[2]; ++n) {
        const Quat turn = random.rotation();
        const Vec3 position = pitch * Vec3(n % sides[0] + 0.5, n / sides[0] % sides[1] + 0.5,
                                           n / (sides[0] * sides[1]) + 0.5);
        for (const Ball& b : one) {
            bed.balls.push_back({position + turn * b.centre, b.radius});
            bed.rocks.push_back(n + 1);
        }
    }
    return bed;
}

/// A scene with another friction coefficient of its grains and with local damping.
World damped_scene(const Bed& bed, const Scene& scene, double rough, double damping) {
    World world = make_scene(bed, scene, LawName::linear_viscous);
    auto& materials = world.resource<Materials>();
    materials.list.front().friction = rough;
    materials.mix();
    world.add_resource(LocalDamping{damping});
    return world;
}

void settle(Bed& bed, Scene scene, const Stage& stage, unsigned threads) {
    scene.gravity *= stage.weight;
    scene.step *= 2; // also stable
    World world = damped_scene(bed, scene, stage.friction, stage.damping);
    world.resource<Limits>().overlap = 1; // the first impacts may be strong
    const auto motion = world.column<Bodies, MotionOf>();
    const auto velocity = world.column<Bodies, Velocity>();
    for (Row r = 0; r < velocity.size(); ++r) {
        Random random(seed, 100 + r);
        if (motion[r] == static_cast<std::uint32_t>(Motion::free))
            velocity[r] = stage.speed * random.direction();
    }
    // a loose lattice sinks by at most about a third of its height
    const double fall = std::sqrt(2 * bed.box.z() / 3 / scene.gravity);
    add_lists(world, LawName::linear_viscous);
    Simulation simulation(std::move(world), steps(LawName::linear_viscous), threads);
    simulation.advance(static_cast<std::uint64_t>(std::ceil(stage.falls * fall / scene.step)));
    bed.balls = balls_now(simulation.world());
}

/// Compresses a settled bed from above and from two sides until all three pressures are equal.
void press(Bed& bed, const Scene& scene, double rough, unsigned threads) {
    constexpr double pressure = 55e3, rate = 0.2; // Pa, strain per second
    constexpr int longest = 2000, block = 50;     // largest number of blocks, steps per block
    double top = 0;
    for (const Ball& b : bed.balls) top = std::max(top, b.centre.z() + b.radius);
    bed.box.z() = std::min(bed.box.z(), top);
    World world = damped_scene(bed, scene, rough, 0.5);
    add_lists(world, LawName::linear_viscous);
    Simulation simulation(std::move(world), steps(LawName::linear_viscous), threads);
    Vec3 lacking = Vec3::Ones();
    for (int k = 0; k < longest; ++k) {
        lacking = Vec3::Ones() - pressure_on(simulation.world()) / pressure;
        if (k > 0 && lacking.cwiseAbs().maxCoeff() < 1e-3 &&
            compute_quantities(simulation.world()).unbalanced_ratio < 1e-3)
            break;
        move_walls(simulation, -rate * bed.box.cwiseProduct(lacking.cwiseMax(-1)));
        simulation.advance(block);
    }
    if (!(lacking.cwiseAbs().maxCoeff() < 1e-2))
        throw SimulationError(fmt::format(
            "{}: expected pressures of {:g} Pa, found differences of {:.1f} % after {} steps",
            scene.name, pressure, 100 * lacking.cwiseAbs().maxCoeff(), longest * block));
    bed.box = sides_of(simulation.world());
    bed.balls = balls_now(simulation.world());
}

void shuffle(std::vector<Ball>& balls) {
    Random random(seed, 2);
    for (std::size_t k = balls.size(); k > 1; --k)
        std::swap(balls[k - 1], balls[random.bits() % k]);
}

Bed pressed_bed(const Scene& scene, unsigned spheres, unsigned threads) {
    Bed bed =
        make_bed(scene_named(scene.name == "triaxial" ? "clumps" : "settle"), spheres, threads);
    for (const double rough : {slippery, friction, friction}) press(bed, scene, rough, threads);
    return bed;
}

} // namespace

Bed make_bed(const Scene& scene, unsigned spheres, unsigned threads) {
    if (scene.pressed) return pressed_bed(scene, spheres, threads);
    Bed bed = scene.name == "poly"     ? loose_mixture(30, 0.02)
              : scene.name == "poly5"  ? loose_mixture(240, 0.01)
              : scene.name == "clumps" ? loose_rocks()
                                       : loose_spheres(spheres);
    const bool large_gravity = scene.name == "poly" || scene.name == "poly5";
    const double more = large_gravity ? 1 : 10,
                 speed = 0.05 * std::sqrt(more * scene.gravity * bed.box.z());
    settle(bed, scene, {more, slippery, 0.2, 2, speed}, threads);
    settle(bed, scene, {1, slippery, 0.5, 0.3, 0}, threads);
    // without contact history a bed must come to rest again, each time by a smaller displacement
    const int rests = scene.name == "quiet" ? 4 : 1;
    for (int k = 0; k < rests; ++k) settle(bed, scene, {1, friction, 0.5, 0.3, 0}, threads);
    if (bed.rocks.empty()) shuffle(bed.balls);
    return bed;
}

} // namespace bris::peers
