#include "tests/verification/chain.hpp"

#include "components/settings.hpp"
#include "engine/errors.hpp"
#include "scenarios/collision/impact.hpp"
#include "scenarios/collision/peak.hpp"
#include "scenarios/specimens/small_scene.hpp"

#include <cmath>

namespace bris {

namespace {

/// Adds beads along x at a spacing (m). If `held`, the two outermost beads are fixed.
std::vector<EntityId> add_beads(World& world, unsigned count, double spacing, double radius,
                                std::uint32_t material, bool held) {
    std::vector<EntityId> ids;
    for (unsigned i = 0; i < count; ++i) {
        const bool outer = held && (i == 0 || i + 1 == count);
        ids.push_back(add_sphere(world, Vec3(i * spacing, 0, 0), radius, material,
                                 outer ? Motion::fixed : Motion::free));
    }
    return ids;
}

} // namespace

void check(const ChainWave& s) {
    require(s.mode >= 1 && s.mode <= s.beads,
            "chain: expected a mode from 1 to the number of beads");
}

ChainWaveResult run_experiment(const ChainWave& s) {
    check(s);
    const double gap = s.overlap * s.radius, spacing = 2 * s.radius - gap;
    const NormalContact c = like_spheres(s.material, s.law, s.radius, 1);
    const double mass = 2 * c.mass;
    ChainWaveResult r;
    r.stiffness = c.hertz ? 1.5 * c.stiffness * std::sqrt(gap) : c.stiffness;
    const double dt = s.step * std::sqrt(mass / r.stiffness), q = pi * s.mode / (s.beads + 1);
    r.exact_frequency = 2 * std::sqrt(r.stiffness / mass) * std::sin(0.5 * q);
    r.discrete_frequency = 2 / dt * std::asin(0.5 * r.exact_frequency * dt);

    World world = make_world(Grains::spheres);
    const auto material = world.resource<Materials>().add(s.material);
    const auto ids = add_beads(world, s.beads + 2, spacing, s.radius, material, true);
    const auto shape = [&](unsigned i) { return std::sin(q * i); };
    // the wave is at its turning point at t = 0; the velocity at -dt/2 is a difference of positions
    const double a = s.amplitude * gap,
                 begin_speed = a * (1 - std::cos(r.discrete_frequency * dt)) / dt;
    for (unsigned i = 1; i <= s.beads; ++i) {
        value_of<Position>(world, ids[i]).x() += a * shape(i);
        value_of<Velocity>(world, ids[i]).x() = begin_speed * shape(i);
    }
    Simulation sim = begin(std::move(world), {.dt = dt, .law = s.law, .unlimited = true});
    const auto amplitude = [&](auto component) { // projection onto the mode
        double sum = 0;
        for (unsigned i = 1; i <= s.beads; ++i) {
            const double x = value_of<decltype(component)>(sim, ids[i]).x();
            sum += (std::is_same_v<decltype(component), Position> ? x - i * spacing : x) * shape(i);
        }
        return 2 * sum / (s.beads + 1);
    };
    r.steps = static_cast<std::uint64_t>(std::round(2 * pi * s.periods / (r.exact_frequency * dt)));
    sim.advance(r.steps);
    // phase of x = A cos(w t) from x(t) and v(t - dt/2), plus the expected number of full turns
    const double x = amplitude(Position{}), v = amplitude(Velocity{}),
                 half = 0.5 * r.discrete_frequency * dt;
    // v = -2/dt A sin(half) sin(phase - half)
    const double sine = -v * dt / (2 * std::sin(half)),
                 late = std::atan2(sine + x * std::sin(half), x * std::cos(half));
    const double expected = r.discrete_frequency * dt * static_cast<double>(r.steps);
    const double turns = std::round((expected - late) / (2 * pi));
    r.frequency = (late + 2 * pi * turns) / (dt * static_cast<double>(r.steps));
    r.amplitude_drift = std::hypot(x, (sine + x * std::sin(half)) / std::cos(half)) / a - 1;
    return r;
}

void check(const ChainPulse& s) {
    require(s.beads >= 10 && s.front > 0 && s.front < s.rear && s.rear < 1,
            "chain: expected at least 10 beads and 0 < front < rear < 1");
}

ChainPulseResult run_experiment(const ChainPulse& s) {
    check(s);
    const NormalContact c = like_spheres(s.material, s.law, s.radius, s.speed);
    const double mass = 2 * c.mass;
    ChainPulseResult r;
    r.time_unit = c.hertz ? std::pow(mass * mass / (c.stiffness * c.stiffness * s.speed), 0.2)
                          : std::sqrt(mass / c.stiffness);
    const double dt = s.step * r.time_unit;
    World world = make_world(Grains::spheres);
    const auto material = world.resource<Materials>().add(s.material);
    const auto ids = add_beads(world, s.beads, 2 * s.radius, s.radius, material, false);
    value_of<Velocity>(world, ids[0]).x() = s.speed;
    Simulation sim = begin(std::move(world), {.dt = dt, .law = s.law, .unlimited = true});

    std::vector<Peak> force(s.beads - 1), velocity(s.beads);
    const double length =
        s.rear * s.beads /
        (c.hertz ? 0.8 : 1.0); // time after which the pulse is well past the rear bead
    const auto steps = static_cast<std::uint64_t>((length + 5) / s.step);
    for (std::uint64_t k = 0; k < steps; ++k) {
        sim.advance();
        std::vector<double> now(s.beads - 1);
        for (const TouchingPair& p : touching_pairs<SpherePairs>(sim.world()))
            now[p.names.owner] = p.force.normal_force;
        for (std::size_t i = 0; i < now.size(); ++i) force[i].add(now[i]);
        for (const EntityId id : ids) velocity[id].add(value_of<Velocity>(sim, id).x());
    }
    const auto at = [&](double share) { return static_cast<std::size_t>(share * s.beads); };
    for (const Peak& p : force) r.arrival.push_back(p.time_index() * s.step);
    const double unit = mass * s.speed / r.time_unit;
    r.pulse_speed = static_cast<double>(at(s.rear) - at(s.front)) /
                    (r.arrival[at(s.rear)] - r.arrival[at(s.front)]);
    r.largest_force = force[at(s.rear)].value() / unit;
    r.largest_velocity = velocity[at(s.rear)].value() / s.speed;
    double momentum = 0;
    for (const EntityId id : ids)
        momentum += value_of<InertialMass>(sim, id) * value_of<Velocity>(sim, id).x();
    r.momentum_change = std::abs(momentum / (mass * s.speed) - 1);
    r.steps = steps;
    return r;
}

} // namespace bris
