// S10: impacts with large displacements per step are computed correctly or refused, and no body
// passes through another.
#include "engine/health.hpp"
#include "engine/random_vector.hpp"
#include "scenarios/specimens/small_scene.hpp"
#include "systems/broadphase/lists.hpp"
#include "tests/stability/cases.hpp"

#include <fmt/format.h>

#include <array>
#include <optional>

namespace bris {

namespace {

constexpr double radius = 0.01, kn = 1e6, density = 2600;

double contact_time(double mass) { return pi / std::sqrt(kn / mass); }

enum class Target { plane, facet, edge, sphere };
constexpr std::array targets{"a plane", "a facet", "an edge of a facet", "a sphere"};

/// Velocity after the rebound relative to the speed before, or the message with which the engine
/// refused the impact.
struct Rebound {
    std::optional<Vec3> velocity;
    std::string refusal;
};

/// The rebound of a sphere from a target. It moves by `step_ratio` radii in a time step, and the
/// contact time has `steps` time steps.
Rebound rebound_of(Target target, double step_ratio, double steps) {
    World world = make_world(Grains::spheres);
    const auto grain = world.resource<Materials>().add(linear_material(kn, 0, 0, density));
    const EntityId ball = add_sphere(world, Vec3::Zero(), radius, grain);
    const double dt = contact_time(value_of<Mass>(world, ball)) / steps,
                 speed = step_ratio * radius / dt;
    const double gap = 3.3 * step_ratio * (steps / 50) * radius; // three steps of the coarse run
    const Vec3 aim =
        target == Target::edge ? Vec3(0.2 * radius, 0, 0) : Vec3::Zero(); // just beside the edge
    value_of<Position>(world, ball) = Vec3(0, 0, radius + gap) + aim;
    value_of<Velocity>(world, ball) = Vec3(0, 0, -speed);
    if (target == Target::plane) add_floor(world, grain);
    if (target == Target::sphere)
        add_sphere(world, Vec3(0, 0, -radius), radius, grain, Motion::fixed);
    if (target == Target::facet || target == Target::edge) {
        const double size = 5 * radius, right = target == Target::edge ? 0 : size;
        const EntityId host = add_boundary(world, Vec3::Zero(), grain, Motion::fixed, 2 * size);
        add_facet(world, host,
                  {{Vec3(-size, -size, 0), Vec3(right, -size, 0), Vec3(right, size, 0),
                    Vec3(-size, size, 0)}});
    }
    world.resource<Limits>().speed = 1e9; // no limit: the displacement per step is tested
    Simulation simulation =
        begin(std::move(world), {.dt = dt, .law = LawName::linear_frictionless});
    const auto needed = static_cast<std::uint64_t>(1.5 * steps + gap / (speed * dt) * 2) + 5;
    Rebound rebound;
    rebound.refusal = refusal_of([&] { simulation.advance(needed); });
    if (rebound.refusal.empty()) rebound.velocity = value_of<Velocity>(simulation, ball) / speed;
    return rebound;
}

void add_impacts(StressRows& rows) {
    for (std::size_t t = 0; t < targets.size(); ++t) {
        const auto target = static_cast<Target>(t);
        for (const double step_ratio : {0.001, 0.01, 0.1, 0.3, 1.0, 2.0, 5.0}) {
            const Rebound coarse = rebound_of(target, step_ratio, 50);
            const std::string what =
                fmt::format("a sphere moving {} radii per step hits {}", step_ratio, targets[t]);
            const char* criterion = "refused, or within 1 % of a run with steps 100 times finer";
            if (!coarse.velocity) {
                // largest overlap in radii; impacts with smaller overlaps must not be refused
                const bool deep = step_ratio * 50 / pi > 0.25;
                rows.push_back({"S10", what, criterion, coarse.refusal, deep});
                continue;
            }
            const Rebound fine = rebound_of(target, step_ratio / 100, 5000);
            const double error = fine.velocity ? (*coarse.velocity - *fine.velocity).norm() : 1;
            rows.push_back({"S10", what, criterion,
                            fmt::format("error of the rebound {:.2g} %", 100 * error),
                            error < 0.01});
        }
    }
}

/// A wall that moves by 2 radii towards a sphere in one step.
void add_jumping_wall(StressRows& rows, bool facet) {
    World world = make_world(Grains::spheres);
    const auto grain = world.resource<Materials>().add(linear_material(kn, 0, 0, density));
    const EntityId ball = add_sphere(world, Vec3(0, 0, 1.01 * radius), radius, grain);
    const EntityId host = add_boundary(world, Vec3::Zero(), grain, Motion::prescribed, 10 * radius);
    const double size = 5 * radius;
    if (facet)
        add_facet(world, host,
                  {{Vec3(-size, -size, 0), Vec3(size, -size, 0), Vec3(size, size, 0),
                    Vec3(-size, size, 0)}});
    else
        add_plane(world, host, Vec3::Zero(), Vec3::UnitZ());
    const double dt = contact_time(value_of<Mass>(world, ball)) / 50;
    value_of<DriveVelocity>(world, host) = Vec3(0, 0, 2 * radius / dt);
    world.resource<Limits>().speed = 1e9;
    Simulation simulation =
        begin(std::move(world), {.dt = dt, .law = LawName::linear_frictionless});
    const std::string refusal = refusal_of([&] { simulation.advance(10); });
    rows.push_back({"S10", fmt::format("a {} moving 2 radii in a step", facet ? "facet" : "plane"),
                    "refused", refusal.empty() ? "not refused" : refusal, !refusal.empty()});
}

/// Random shots of one sphere in a closed box, with 0.001 to 5 radii per step.
void add_shots(StressRows& rows, bool facets, unsigned shots, std::uint64_t seed) {
    World world = make_world(Grains::spheres);
    const auto grain = world.resource<Materials>().add(linear_material(kn, 0, 0, density));
    const EntityId ball = add_sphere(world, Vec3::Zero(), radius, grain);
    const double half = 6 * radius, dt = contact_time(value_of<Mass>(world, ball)) / 50;
    if (facets)
        add_facet_box(world, -half * Vec3::Ones(), half * Vec3::Ones(), grain);
    else
        add_box(world, -half * Vec3::Ones(), half * Vec3::Ones(), grain);
    world.resource<Limits>().speed = 1e9;
    Simulation simulation =
        begin(std::move(world), {.dt = dt, .law = LawName::linear_frictionless});
    simulation.advance(1);
    unsigned escaped = 0, refused = 0, rebounds = 0;
    for (unsigned k = 0; k < shots; ++k) {
        Random random(seed, 100 + k);
        const double step_ratio = std::exp(random.uniform(std::log(1e-3), std::log(5.0)));
        const Vec3 start =
            (half - 1.01 * radius) * place_in_box(random, Vec3::Constant(-1), Vec3::Constant(1));
        const Vec3 velocity = step_ratio * radius / dt * random.direction();
        value_of<Position>(simulation, ball) = start;
        value_of<Velocity>(simulation, ball) = velocity;
        value_of<Acceleration>(simulation, ball).setZero();
        simulation.world().resource<Health>() = {};
        invalidate_lists(simulation.world());
        const auto steps =
            static_cast<std::uint64_t>(std::clamp(4 * half / (step_ratio * radius), 20.0, 300.0));
        const bool stopped = !refusal_of([&] { simulation.advance(steps); }).empty();
        refused += stopped ? 1u : 0u;
        if (stopped) continue;
        escaped += value_of<Position>(simulation, ball).cwiseAbs().maxCoeff() < half ? 0u : 1u;
        rebounds +=
            value_of<Velocity>(simulation, ball).dot(velocity) < 0.99 * velocity.squaredNorm() ? 1u
                                                                                               : 0u;
    }
    rows.push_back(
        {"S10", fmt::format("{} random shots in a box of {}", shots, facets ? "facets" : "planes"),
         "no escapes",
         fmt::format("{} escaped, {} refused, {} rebounded", escaped, refused, rebounds),
         escaped == 0 && rebounds > shots / 100 && refused > 0});
}

} // namespace

StressRows stress_fast_impact(const StressSettings& s) {
    StressRows rows;
    add_impacts(rows);
    for (const bool facet : {false, true}) {
        add_jumping_wall(rows, facet);
        add_shots(rows, facet, s.full ? 100'000 : 1000, s.seed);
    }
    return rows;
}

} // namespace bris
