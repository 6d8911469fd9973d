#include "scenarios/specimens/sphere_bed.hpp"

#include "engine/random.hpp"
#include "scenarios/specimens/scene.hpp"

#include <cmath>

namespace bris {

World make_sphere_bed(const SphereBed& s) {
    World world = make_world(Grains::spheres);
    // the partners act in series, so each has twice the stiffness of the contact
    const auto material = world.resource<Materials>().add(
        {"grain", s.density, 2 * s.normal_stiffness, 4.0 / 7 * s.normal_stiffness, s.friction,
         s.damping_rate, s.damping_rate / 2});
    const double largest = s.radius * (1 + s.size_spread), pitch = 2.05 * largest;
    const auto across =
        static_cast<unsigned>(std::ceil(std::cbrt(0.5 * s.spheres / s.length_ratio)));
    const auto along = static_cast<unsigned>(std::ceil(across * s.length_ratio));
    const unsigned of_layer = across * along;
    // overlapping spheres occupy a smaller area in the middle of the same floor
    const double between = s.start_overlap > 0 ? 2 * s.radius * (1 - s.start_overlap) : pitch;
    const double height = (s.spheres / of_layer + 2) * pitch;
    for (unsigned n = 0; n < s.spheres; ++n) {
        Random random(s.seed, n);
        const double radius = s.radius * random.uniform(1 - s.size_spread, 1 + s.size_spread);
        const Vec3 position(n % along + 0.5, n / along % across + 0.5, n / of_layer + 0.5);
        const Vec3 corner(along * between / 2, across * between / 2, 0.5 * (between - pitch));
        add_sphere(world, between * position - corner + 0.02 * largest * random.direction(),
                   s.size_spread > 0 ? radius : s.radius, material);
    }
    const Vec3 high(along * pitch / 2, across * pitch / 2, height), low(-high.x(), -high.y(), 0);
    add_box(world, low, high, material);
    auto& limits = world.resource<Limits>();
    limits.low = low;
    limits.high = high;
    world.add_resource<Gravity>();
    world.resource<Clock>().dt = s.step;
    return world;
}

} // namespace bris
