#include "scenarios/collision/impact.hpp"

#include "components/settings.hpp"
#include "engine/errors.hpp"
#include "scenarios/collision/peak.hpp"
#include "scenarios/specimens/small_scene.hpp"

#include <fmt/format.h>

#include <cmath>
#include <utility>

namespace bris {

namespace {

double series(double a, double b) { return a * b / (a + b); }
double plane_modulus(const Material& m) {
    return m.young_modulus / (1 - m.poisson_ratio * m.poisson_ratio);
}
double sphere_mass(const Material& m, double r) { return m.density * 4 / 3 * pi * r * r * r; }

void add_square(World& world, EntityId host, const Vec3& centre, double half) {
    const Vec3 x = half * Vec3::UnitX(), y = half * Vec3::UnitY();
    add_facet(world, host, {{centre - x - y, centre + x - y, centre + x + y, centre - x + y}});
}

void add_target(World& world, const Impact& s, std::uint32_t material) {
    if (s.target == Target::sphere) {
        add_sphere(world, Vec3::Zero(), s.partner_radius, material);
        return;
    }
    const EntityId host = add_boundary(world, Vec3::Zero(), material, Motion::fixed, 8 * s.radius);
    const double a = 3 * s.radius;
    if (s.target == Target::plane) add_plane(world, host, Vec3::Zero(), Vec3::UnitZ());
    if (s.target == Target::facet) add_square(world, host, Vec3(0.3 * a, 0.2 * a, 0), a);
    if (s.target == Target::edge)
        for (const double x : {-a, a}) add_square(world, host, Vec3(x, 0.2 * a, 0), a);
    if (s.target == Target::vertex)
        for (const double x : {-a, a})
            for (const double y : {-a, a}) add_square(world, host, Vec3(x, y, 0), a);
}

/// The simulation of an impact, and the quantities that are read from it.
struct Run {
    Simulation sim;
    EntityId ball, partner;
    bool sphere;
    double radius, partner_radius;

    Vec3 partner_of(auto component) {
        return sphere ? Vec3(value_of<decltype(component)>(sim, partner)) : Vec3(Vec3::Zero());
    }
    Vec3 normal() {
        return sphere ? Vec3((value_of<Position>(sim, ball) - value_of<Position>(sim, partner))
                                 .normalized())
                      : Vec3(Vec3::UnitZ());
    }
    Vec3 relative_velocity() { return value_of<Velocity>(sim, ball) - partner_of(Velocity{}); }
    /// Velocity of the sphere's surface relative to the partner's at the contact.
    Vec3 slip() {
        const Vec3 n = normal(), u = relative_velocity() -
                                     radius * value_of<AngularVelocity>(sim, ball).cross(n) -
                                     partner_radius * partner_of(AngularVelocity{}).cross(n);
        return u - u.dot(n) * n;
    }
    double energy() {
        return free_kinetic_energy(sim.world(), ball) +
               (sphere ? free_kinetic_energy(sim.world(), partner) : 0);
    }
    Vec3 momentum() {
        Vec3 p = value_of<InertialMass>(sim, ball) * value_of<Velocity>(sim, ball);
        if (sphere) p += value_of<InertialMass>(sim, partner) * value_of<Velocity>(sim, partner);
        return p;
    }
    Vec3 angular_momentum() { // x(t) x p(t - dt/2) + L(t - dt/2), which the leapfrog conserves
        Vec3 sum = Vec3::Zero();
        for (const EntityId b : {ball, partner})
            if (b == ball || sphere)
                sum += value_of<Position>(sim, b).cross(value_of<InertialMass>(sim, b) *
                                                        value_of<Velocity>(sim, b)) +
                       value_of<AngularMomentum>(sim, b);
        return sum;
    }
};

Run make_run(const Impact& s, double dt, double wait) {
    World world = make_world(Grains::spheres);
    auto& materials = world.resource<Materials>();
    const auto mine = materials.add(s.material), other = materials.add(s.partner_material);
    materials.policy = s.policy;
    materials.mix();
    const Vec3 direction(std::sin(s.angle), 0, -std::cos(s.angle)), v = s.speed * direction;
    const bool sphere = s.target == Target::sphere;
    const double reach = s.radius + (sphere ? s.partner_radius : 0);
    const EntityId ball = add_sphere(world, reach * Vec3::UnitZ(), s.radius, mine);
    const auto partner = static_cast<EntityId>(ball + 1);
    add_target(world, s, other);
    const Vec3 mine_v = (1 - s.partner_share) * v,
               other_v = sphere ? Vec3(-s.partner_share * v) : Vec3(Vec3::Zero());
    value_of<Velocity>(world, ball) = sphere ? mine_v : v;
    value_of<Position>(world, ball) -= wait * value_of<Velocity>(world, ball);
    set_angular_velocity(world, ball, s.angular_velocity);
    if (sphere) {
        value_of<Velocity>(world, partner) = other_v;
        value_of<Position>(world, partner) -= wait * other_v;
        set_angular_velocity(world, partner, s.partner_angular_velocity);
    }
    if (s.local_damping > 0) world.add_resource(LocalDamping{s.local_damping});
    return {begin(std::move(world),
                  {.dt = dt, .law = s.law, .energy_budget = has_springs(s.law), .unlimited = true}),
            ball,
            partner,
            sphere,
            s.radius,
            sphere ? s.partner_radius : 0};
}

void check_numbers(const Impact& s) {
    require(s.radius > 0 && s.partner_radius > 0, "impact: expected radii above 0 m");
    require(s.speed > 0, fmt::format("impact: expected a speed above 0 m/s, found {:g}", s.speed));
    require(s.angle >= 0 && s.angle < pi / 2,
            fmt::format("impact: expected an angle in [0, 90) degrees, found {:g}",
                        s.angle * 180 / pi));
    require(s.steps_per_contact > 1,
            fmt::format("impact: expected more than 1 step per contact, found {:g}",
                        s.steps_per_contact));
    const double e = std::sqrt(s.material.restitution * s.partner_material.restitution);
    require(
        e > 0 || s.policy.tension != Tension::calibrated,
        fmt::format(
            "impact: restitution with calibrated tension: expected above 0 to 1, found {:g}", e));
    const NormalContact c = normal_contact(s);
    require(c.stiffness > 0 && std::isfinite(c.stiffness),
            is_hertz(s.law) ? "impact: expected Young's moduli above 0 Pa"
                            : "impact: expected normal stiffnesses above 0 N/m");
}

/// Refuses a dashpot that takes more than the whole speed in a step and would reverse it: the
/// leapfrog is stable up to c dt = m. Throws InputError.
void check_dashpot(const Run& run, const Impact& s, double dt) {
    const NormalContact c = normal_contact(s);
    const auto& materials = run.sim.world().resource<Materials>();
    const LawRow& row = materials.pairs(s.law)[materials.pair(0, 1)];
    const double tangent =
        c.hertz ? 1.5 * c.stiffness * std::sqrt(c.largest_overlap()) : c.stiffness;
    const double part = dt * (row.normal_ratio * std::sqrt(tangent / c.mass) + row.normal_rate);
    require(part < 1,
            fmt::format("impact: expected a dashpot that takes less than the whole speed in a "
                        "step, found {:.2g} times the speed: {:.0f} steps per contact "
                        "are not enough, {:.0f} are",
                        part, s.steps_per_contact, std::ceil(1.01 * part * s.steps_per_contact)));
}

constexpr double lead = 3; ///< steps before the contact

/// The simulation at the start and its time step (s). Throws as check.
std::pair<Run, double> checked_run(const Impact& s) {
    check_numbers(s);
    const double dt = normal_contact(s).time() / s.steps_per_contact;
    std::pair<Run, double> made{make_run(s, dt, (lead - s.phase) * dt), dt};
    check_dashpot(made.first, s, dt);
    return made;
}

double work(Run& run, auto component) {
    using C = decltype(component);
    return run.sim.world().table<Bodies>().has<C>()
               ? value_of<C>(run.sim, run.ball) + value_of<C>(run.sim, run.partner)
               : 0;
}

} // namespace

double NormalContact::largest_overlap() const {
    return hertz ? std::pow(1.25 * mass * speed * speed / stiffness, 0.4)
                 : speed * std::sqrt(mass / stiffness);
}
double NormalContact::largest_force() const {
    const double x = largest_overlap();
    return hertz ? stiffness * x * std::sqrt(x) : stiffness * x;
}
double NormalContact::time() const {
    return hertz ? 0.8 * std::beta(0.4, 0.5) * largest_overlap() / speed
                 : pi * std::sqrt(mass / stiffness);
}

NormalContact like_spheres(const Material& material, LawName law, double radius, double speed) {
    Impact pair;
    pair.target = Target::sphere;
    pair.radius = pair.partner_radius = radius;
    pair.material = pair.partner_material = material;
    pair.law = law;
    pair.speed = speed;
    return normal_contact(pair);
}

NormalContact normal_contact(const Impact& s) {
    NormalContact c{};
    const double m = sphere_mass(s.material, s.radius);
    c.mass = m;
    c.radius = s.radius;
    if (s.target == Target::sphere) {
        c.mass = series(m, sphere_mass(s.partner_material, s.partner_radius));
        c.radius = series(s.radius, s.partner_radius);
    }
    c.hertz = is_hertz(s.law);
    c.stiffness =
        c.hertz ? 4.0 / 3 * series(plane_modulus(s.material), plane_modulus(s.partner_material)) *
                      std::sqrt(c.radius)
                : series(s.material.normal_stiffness, s.partner_material.normal_stiffness);
    c.speed = s.speed * std::cos(s.angle);
    return c;
}

void check(const Impact& s) { (void)checked_run(s); }

ImpactResult run_experiment(const Impact& s) {
    auto [run, dt] = checked_run(s);
    ImpactResult r;
    r.energy_before = run.energy();
    r.slip_before = run.slip().x();
    const Vec3 before = run.relative_velocity(), momentum = run.momentum(),
               turning = run.angular_momentum();
    const double momentum_scale = normal_contact(s).mass * s.speed;

    Peak overlap, force;
    std::uint64_t first = 0, last = 0;
    double last_overlap = 0;
    const auto limit = static_cast<std::uint64_t>(50 * s.steps_per_contact) + 10;
    for (std::uint64_t k = 0;; ++k) {
        if (k > limit)
            throw SimulationError(fmt::format("impact: the contact does not end in {} steps", k));
        run.sim.advance();
        const Touch touch = touch_of(run.sim.world());
        overlap.add(touch.overlap);
        force.add(touch.normal_force);
        r.friction_ratio = std::max(r.friction_ratio, touch.friction_ratio);
        if (touch.pairs > 0) {
            if (first == 0) first = k;
            last = k;
            last_overlap = touch.overlap;
        } else if (first > 0) {
            r.steps = k;
            break;
        }
    }
    const Vec3 n = run.normal(), after = run.relative_velocity(), slip = run.slip();
    const double out = after.dot(n), in = -before.z();
    r.largest_overlap = overlap.value();
    r.largest_force = force.value();
    r.contact_time = (static_cast<double>(last) - (lead - s.phase)) * dt + last_overlap / out;
    r.normal_restitution = out / in;
    r.tangential_restitution = (after - out * n).x() / before.x();
    r.angular_velocity = value_of<AngularVelocity>(run.sim, run.ball);
    r.partner_angular_velocity = run.partner_of(AngularVelocity{});
    r.slip = slip.x();
    r.rebound_angle = std::atan2(r.slip, out);
    r.energy_change = run.energy() / r.energy_before - 1;
    r.friction_work = work(run, FrictionWork{});
    r.viscous_work = work(run, ViscousWork{});
    r.rolling_work = work(run, RollingWork{});
    r.energy_budget_error = -r.energy_change - (r.friction_work + r.viscous_work + r.rolling_work +
                                                work(run, DampingWork{})) /
                                                   r.energy_before;
    r.momentum_change = (run.momentum() - momentum).norm() / momentum_scale;
    r.angular_momentum_change = (run.angular_momentum() - turning).norm() /
                                (momentum_scale * (s.radius + s.partner_radius));
    return r;
}

} // namespace bris
