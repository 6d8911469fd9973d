#include "components/laws/linear_bridge.hpp"
#include "scenarios/specimens/small_scene.hpp"
#include "systems/output/quantities.hpp"
#include "tests/verification/cases.hpp"
#include "tests/verification/guided_pair.hpp"

#include <fmt/format.h>

#include <cmath>

namespace bris::detail {

namespace {

constexpr LiquidBridge water{.surface_tension = 0.072, .contact_angle = 0.2, .volume = 1e-12};
constexpr double radius = 1e-3;

/// Published closed form of the force (N) between two spheres: Willett et al. (2000), eqs. (12) and
/// (13), with the effective radius of Derjaguin; zero beyond the rupture distance of Lian et al.
/// (1993).
struct Published {
    LiquidBridge liquid = water;
    double first_radius = radius, second_radius = radius;

    double derjaguin() const {
        return std::isinf(second_radius)
                   ? 2 * first_radius
                   : 2 * first_radius * second_radius / (first_radius + second_radius);
    }
    double rupture() const { return (1 + liquid.contact_angle / 2) * std::cbrt(liquid.volume); }
    double force(double separation) const {
        if (separation >= rupture()) return 0;
        const double r = derjaguin(), half = separation / 2,
                     scaled = half / std::sqrt(liquid.volume / r);
        return 2 * pi * r * liquid.surface_tension * std::cos(liquid.contact_angle) /
               (1 + 2.1 * scaled + 10 * scaled * scaled);
    }
    /// Work (J) from touch to rupture by Simpson's rule on a million intervals, with an error of
    /// 1e-15.
    double work() const {
        constexpr int n = 1'000'000;
        const double h = rupture() / n, nearly = rupture() * (1 - 1e-15);
        double sum = force(0) + force(nearly);
        for (int k = 1; k < n; ++k) sum += (k % 2 == 1 ? 4 : 2) * force(k * h);
        return sum * h / 3;
    }
};

GuidedPair guided(const Published& p, double gap) {
    GuidedPair::Settings s;
    s.radius = p.first_radius;
    s.heavy_radius = p.second_radius;
    s.overlap = -gap;
    s.law = LawName::linear_bridge;
    s.material = linear_material(1e4);
    s.own = p.liquid.coefficients();
    return GuidedPair(s);
}

Vec3 up(double way) { return {0, 0, way}; }

void check_force(Checks& checks, const std::string& name, const Published& p) {
    GuidedPair pair = guided(p, 1e-7);
    double approach = 0, worst = 0, gap = 1e-7;
    approach = std::abs(pair.step(up(-2e-7)).force.z()); // begins in the gap and ends in touch
    gap -= 2e-7;
    pair.step(up(-gap));
    gap = 0;
    for (const double share : {0.001, 0.01, 0.1, 0.2, 0.4, 0.6, 0.8, 0.9, 0.99, 0.999}) {
        const double next = share * p.rupture();
        pair.step(up(next - gap));
        gap = next;
        pair.step(Vec3::Zero()); // at rest, the force depends on the position only
        const double found = pair.step(Vec3::Zero()).force.z();
        worst = std::max(worst, std::abs(found / p.force(gap) - 1));
    }
    checks.absolute(name + ": force on approach, before the surfaces touch", "N", 0, approach, 0);
    checks.absolute(name + ": largest relative error of the force between touch and rupture", "", 0,
                    worst, 1e-10);
}

/// Checks the rupture distance and the work of a bridge that is stretched in steps from touch.
void check_rupture(Checks& checks, const std::string& name, const Published& p) {
    constexpr int steps = 2000;
    const double h = p.rupture() / (steps - 0.5); // ruptures in the middle of a step
    GuidedPair pair = guided(p, 0);
    pair.step(up(-1e-9)); // touches
    pair.step(up(1e-9));
    double work = 0, last = 0, before = pair.step(up(h)).force.z();
    for (int k = 1; k <= steps + 2; ++k) {
        const double force = pair.step(up(h)).force.z();
        work += 0.5 * (before + force) * h;
        if (force > 0) last = k * h;
        before = force;
    }
    checks.absolute(name + ": distance at which the bridge ruptures", "m", p.rupture(), last, h);
    // trapezoidal rule; of the last step, in which the bridge ruptures, only a part counts
    checks.relative(name + ": work from touch to rupture", "J", p.work(), work, 1e-5);
}

struct Parted {
    double speed = 0;    ///< m/s, relative speed at the end
    double farthest = 0; ///< m, largest gap between the surfaces
    double closure = 0;  ///< relative energy error: (final + dissipated) / initial energy - 1
};

/// Head-on impact of two equal spheres, or of a sphere on a plane, at a relative `speed` (m/s).
Parted meet(double speed, bool plane, double dt, double duration) {
    World world = make_world(Grains::spheres);
    auto& materials = world.resource<Materials>();
    const auto grain = materials.add(linear_material(1e4));
    materials.set_own(LawName::linear_bridge, grain, grain, water.coefficients());
    constexpr double gap = 1e-6;
    const EntityId upper = add_sphere(world, Vec3(0, 0, radius + gap), radius, grain);
    value_of<Velocity>(world, upper) = up(plane ? -speed : -0.5 * speed);
    EntityId lower = upper;
    if (plane) {
        add_floor(world, grain);
    } else {
        lower = add_sphere(world, Vec3(0, 0, -radius), radius, grain);
        value_of<Velocity>(world, lower) = up(0.5 * speed);
    }
    Simulation sim =
        begin(std::move(world),
              {.dt = dt, .law = LawName::linear_bridge, .energy_budget = true, .unlimited = true});
    const double start = compute_quantities(sim.world()).kinetic_energy;
    Parted result;
    const auto gap_now = [&] {
        const double z = value_of<Position>(sim, upper).z();
        return plane ? z - radius : z - value_of<Position>(sim, lower).z() - 2 * radius;
    };
    for (double t = 0; t < duration; t += dt) {
        sim.advance();
        result.farthest = std::max(result.farthest, gap_now());
    }
    result.speed = value_of<Velocity>(sim, upper).z() * (plane ? 1 : 2);
    const Quantities q = compute_quantities(sim.world());
    double taken = 0;
    for (const double w : sim.world().column<Bodies, ViscousWork>()) taken += w;
    for (const double w : sim.world().column<Bodies, FrictionWork>()) taken += w;
    result.closure = (q.kinetic_energy + q.elastic_energy + taken) / start - 1;
    return result;
}

void check_meeting(Checks& checks, bool plane) {
    const std::string name = plane ? "sphere and plane" : "two spheres";
    const Published p{water, radius, plane ? std::numeric_limits<double>::infinity() : radius};
    const double mass = 2600 * 4 * pi / 3 * radius * radius * radius * (plane ? 1 : 0.5);
    const double escape = std::sqrt(2 * p.work() / mass), dt = 1e-6;
    const double fast = 1.5 * escape;
    const Parted parted = meet(fast, plane, dt, 4 * p.rupture() / escape);
    // the kinetic energy m v^2 / 2 decreases by the work of the bridge
    checks.relative(name + ": speed after the rebound", "m/s",
                    std::sqrt(fast * fast - escape * escape), parted.speed, 1e-6);
    checks.absolute(name + ": relative energy error", "", 0, parted.closure, 1e-6);
    const Parted held = meet(0.9 * escape, plane, dt, 6 * p.rupture() / escape);
    checks.at_most(name + ", too slow to separate: largest gap over rupture distance", "", 1,
                   held.farthest / p.rupture());
}

} // namespace

void verify_liquid_bridge(Checks& checks) {
    const Published equal, unequal{water, radius, 3 * radius};
    check_force(checks, "equal spheres", equal);
    check_force(checks, "spheres of radii 1:3", unequal);
    check_rupture(checks, "equal spheres", equal);
    check_rupture(checks, "spheres of radii 1:3", unequal);
    check_meeting(checks, false);
    check_meeting(checks, true);
}

} // namespace bris::detail
