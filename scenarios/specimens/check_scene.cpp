#include "scenarios/specimens/check_scene.hpp"

#include "components/body.hpp"
#include "components/kinds.hpp"
#include "components/laws/coefficients.hpp"
#include "components/laws/edges.hpp"
#include "components/settings.hpp"
#include "components/sphere.hpp"
#include "engine/errors.hpp"
#include "engine/options.hpp"
#include "engine/ordering.hpp"
#include "systems/contact/stable_step.hpp"

#include <fmt/format.h>

#include <cmath>
#include <string>

namespace bris {

namespace {

std::string text_of(const Range& range) {
    const bool low = std::isfinite(range.low), high = std::isfinite(range.high);
    if (low && high)
        return fmt::format("{} {:g} {} {:g}", range.low_accepted ? "from" : "above", range.low,
                           range.high_accepted ? "to" : "to below", range.high);
    if (low) return fmt::format("{} {:g}", range.low_accepted ? "at least" : "above", range.low);
    return "a finite number";
}

bool holds(const Range& range, double value) {
    return std::isfinite(value) && (range.low_accepted ? value >= range.low : value > range.low) &&
           (range.high_accepted ? value <= range.high : value < range.high);
}

void expect(const std::string& whose, const char* what, double value, const Range& range,
            const char* unit) {
    if (holds(range, value)) return;
    const std::string space = *unit == '\0' ? "" : " ";
    throw InputError(fmt::format("{}: {}: expected {}{}{}, found {:g}{}{}", whose, what,
                                 text_of(range), space, unit, value, space, unit));
}

void expect_finite(const std::string& whose, const char* what, const Vec3& value,
                   const char* unit) {
    for (const double x : {value.x(), value.y(), value.z()}) expect(whose, what, x, Range{}, unit);
}

Range range_of(const Coefficient& c) {
    return {.low = c.low,
            .high = c.high,
            .low_accepted = c.low_accepted,
            .high_accepted = c.high_accepted};
}

/// As the law states it; what the law does not read may be absent, but not nonsense.
const Coefficient& as_stated(const Coefficient& any, LawName law) {
    for (const Coefficient& c : traits(law).of_materials)
        if (c.of_material == any.of_material) return c;
    return any;
}

void check_material(const Material& m, LawName law) {
    const std::string whose = "material '" + m.name + "'";
    for (const Coefficient& any : coefficients::of_materials) {
        const Coefficient& c = as_stated(any, law);
        expect(whose, c.name, m.*c.of_material, range_of(c), c.unit);
    }
}

void check_policy(const ContactPolicy& policy, LawName law) {
    expect("contact policy", "rolling stiffness ratio", policy.rolling_stiffness_ratio,
           has_rolling(law) ? above(0) : at_least(0), "");
    expect("contact policy", "rolling damping ratio", policy.rolling_damping_ratio, at_least(0),
           "");
}

/// Checks the contact parameters of two materials, including properties given for the pair.
void check_pair(const Materials& materials, std::uint32_t a, std::uint32_t b, LawName law) {
    const std::string whose =
        "materials '" + materials.list[a].name + "' and '" + materials.list[b].name + "'";
    const std::uint32_t pair = materials.pair(a, b);
    const LawRow& row = materials.pairs(law)[pair];
    const LawTraits& t = traits(law);
    expect(whose, t.normal_stiffness, row.kn, above(0), t.stiffness_unit);
    expect(whose, t.shear_stiffness, row.ks, at_least(0), t.stiffness_unit);
    expect(whose, "friction", row.friction, at_least(0), "");
    const bool calibrated =
        materials.policy.tension == Tension::calibrated; // no dashpot then gives restitution 0
    expect(whose, calibrated ? "restitution under calibrated tension" : "restitution",
           materials.restitution[pair], Range{.low = 0, .high = 1, .low_accepted = !calibrated},
           "");
    const OwnCoefficients own = materials.own(law, a, b);
    for (std::size_t k = 0; k < t.of_pairs.size(); ++k)
        expect(whose, t.of_pairs[k].name, own[k], range_of(t.of_pairs[k]), t.of_pairs[k].unit);
    if (const EdgeRow& edges = materials.edge_pairs[pair]; t.wears && !damage_is_passive(edges))
        throw InputError(fmt::format(
            "{}: conical damage: expected (pi strength / (2 E*))^2 below 5 (1 - sin a) / sin a of "
            "the cone's half-angle a, as the contact would create energy otherwise, found {:.3g} "
            "and {:.3g}",
            whose, edges.yield_ratio * edges.yield_ratio, 5 * edges.blunting));
    if (!t.rolling) return;
    expect(whose, "rolling friction", materials.rolling_pairs[pair].rolling_friction, at_least(0),
           "");
    expect(whose, "twisting friction", materials.rolling_pairs[pair].twisting_friction, at_least(0),
           "");
}

void check_body(const Table& bodies, Row b) {
    const std::string whose = fmt::format("body {}", bodies.column<BodyId>()[b]);
    expect_finite(whose, "position", bodies.column<Position>()[b], "m");
    expect_finite(whose, "velocity", bodies.column<Velocity>()[b], "m/s");
    expect_finite(whose, "angular velocity", bodies.column<AngularVelocity>()[b], "rad/s");
    expect(whose, "bounding radius", bodies.column<BoundingRadius>()[b], at_least(0), "m");
    if (bodies.column<MotionOf>()[b] != static_cast<std::uint32_t>(Motion::free)) return;
    expect(whose, "mass", bodies.column<Mass>()[b], above(0), "kg");
    expect(whose, "inertial mass", bodies.column<InertialMass>()[b], above(0), "kg");
    if (bodies.has<SphereInertia>()) {
        expect(whose, "inertia", bodies.column<SphereInertia>()[b], above(0), "kg m2");
        return;
    }
    const Vec3& inertia = bodies.column<InertialInertia>()[b];
    for (const double moment : {inertia.x(), inertia.y(), inertia.z()})
        expect(whose, "inertia", moment, above(0), "kg m2");
    expect(whose, "norm of the orientation", bodies.column<Orientation>()[b].norm(),
           within(1 - 1e-6, 1 + 1e-6), "");
}

} // namespace

void check_scene(const World& world, LawName law) {
    const Table& bodies = world.table<Bodies>();
    require(bodies.size() > 0, "scene: expected at least one body, found none");
    const auto material = bodies.column<MaterialOf>();
    const auto rows = in_order_of_ids(bodies.column<BodyId>());
    const auto& all = world.resource<Materials>();
    const auto& materials = all.list;
    for (const Row b : rows)
        require(material[b] < materials.size(),
                fmt::format("body {}: material: expected one of {}, found number {}",
                            bodies.column<BodyId>()[b], materials.size(), material[b]));
    std::vector<bool> used(materials.size());
    for (const Row b : rows) used[material[b]] = true;
    for (std::size_t m = 0; m < used.size(); ++m)
        if (used[m]) check_material(materials[m], law);
    check_policy(all.policy, law);
    for (std::uint32_t a = 0; a < used.size(); ++a)
        for (std::uint32_t b = a; b < used.size(); ++b)
            if (used[a] && used[b]) check_pair(all, a, b, law);
    for (const Row b : rows) check_body(bodies, b);
    const auto ball = world.column<Spheres, LocalBall>();
    const auto parent = world.column<Spheres, ParentId>();
    for (std::size_t s = 0; s < ball.size(); ++s) {
        const std::string whose = fmt::format("body {}", parent[s]);
        expect(whose, "radius of a sphere", ball[s].radius, above(0), "m");
        expect_finite(whose, "position of a sphere", ball[s].centre, "m");
    }
    expect("clock", "step", world.resource<Clock>().dt, at_least(0),
           "s"); // 0: a procedure chooses it later
    const auto& limits = world.resource<Limits>();
    expect("limits", "overlap", limits.overlap, above(0), "radii");
    expect("limits", "speed", limits.speed, above(0), "m/s");
    if (world.has_resource<Gravity>())
        expect_finite("scene", "gravity", world.resource<Gravity>().value, "m/s2");
    if (world.has_resource<LocalDamping>())
        expect("scene", "local damping", world.resource<LocalDamping>().fraction,
               Range{.low = 0, .high = 1, .high_accepted = false}, "");
}

void check_first_step(const World& world) {
    const double step = world.resource<Clock>().dt, stable = stable_step_of_first_contact(world);
    require(step <= stable,
            fmt::format("--step: expected at most the stable step {:.3g} s, found {:.3g} s", stable,
                        step));
}

void check_stable_step(const World& world) { check_stable_step(world, stable_step(world)); }

void check_stable_step(const World& world, double stable) {
    const Clock& clock = world.resource<Clock>();
    if (clock.dt > stable)
        throw SimulationError(
            fmt::format("step {}, time {:.6g} s: --step: expected at most the stable step {:.3g} s "
                        "of the contacts that have formed, found {:.3g} s",
                        clock.step, clock.time(), stable, clock.dt));
}

} // namespace bris
