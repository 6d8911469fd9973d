// S4: the largest stable time step, compared with theory and with the engine's own estimate.
#include "engine/errors.hpp"
#include "engine/random.hpp"
#include "scenarios/specimens/small_scene.hpp"
#include "systems/contact/stable_step.hpp"
#include "systems/output/quantities.hpp"
#include "tests/stability/cases.hpp"

#include <fmt/format.h>

#include <functional>
#include <optional>

namespace bris {

namespace {

constexpr double radius = 0.01, kn = 1e5, density = 2600;
constexpr double mass = density * 4 * pi / 3 * radius * radius * radius;

/// Largest stable step (s) by bisection between `low` (stable) and `high` (unstable), which are
/// adjusted if necessary.
double measured_limit(const std::function<bool(double)>& stable, double low, double high) {
    while (stable(high)) high *= 1.5;
    while (!stable(low)) low /= 1.5;
    while (high - low > 1e-3 * low) {
        const double middle = 0.5 * (low + high);
        (stable(middle) ? low : high) = middle;
    }
    return 0.5 * (low + high);
}

/// Gives every free body a random velocity that moves it by 1e-9 radii in a step.
void disturb(World& world, double dt, std::uint64_t seed) {
    Table& bodies = world.table<Bodies>();
    Random random(seed, 4);
    for (EntityId id = 0; id < bodies.size(); ++id) {
        const Row b = row_of_body(world, id);
        if (bodies.column<MotionOf>()[b] != static_cast<std::uint32_t>(Motion::free)) continue;
        const double speed = 1e-9 * bodies.column<BoundingRadius>()[b] / dt;
        bodies.column<Velocity>()[b] = speed * random.direction();
        set_angular_velocity(world, id,
                             speed / bodies.column<BoundingRadius>()[b] * random.direction());
    }
}

/// Whether a disturbed scene is stable: no body moves by more than 1e-4 radii. At 1 % below the
/// limit a mode grows tenfold before it swings back; at 0.1 % above the limit a hundred steps
/// multiply it by 1e7.
bool stays(Simulation& simulation, const Archive& begin, double dt, std::uint64_t steps,
           std::uint64_t seed) {
    simulation.restore(begin);
    World& world = simulation.world();
    world.resource<Clock>().change_step(dt);
    disturb(world, dt, seed);
    const std::vector<Vec3> before(world.column<Bodies, Position>().begin(),
                                   world.column<Bodies, Position>().end()); // rows are ids
    try {
        for (std::uint64_t done = 0; done < steps; done += 100) {
            simulation.advance(100);
            for (EntityId id = 0; id < before.size(); ++id)
                if (!((value_of<Position>(simulation, id) - before[id]).norm() < 1e-4 * radius))
                    return false;
        }
    } catch (const SimulationError&) {
        return false;
    }
    return true;
}

double limit_of(Simulation& simulation, double guess, std::uint64_t steps, std::uint64_t seed) {
    const Archive begin = simulation.snapshot();
    return measured_limit([&](double dt) { return stays(simulation, begin, dt, steps, seed); },
                          0.7 * guess, 1.3 * guess);
}

LawName law_of(double ratio) { return ratio > 0 ? LawName::linear : LawName::linear_frictionless; }

/// A sphere whose weight causes an overlap of 1e-3 radii with a floor.
Simulation on_wall(double ratio) {
    World world = make_world(Grains::spheres);
    const auto grain =
        world.resource<Materials>().add(linear_material(kn, ratio * kn, 1e3, density));
    add_floor(world, grain);
    add_sphere(world, Vec3(0, 0, radius * (1 - 1e-3)), radius, grain);
    world.add_resource<Gravity>({Vec3(0, 0, -1e-3 * radius * kn / mass)});
    return begin(std::move(world), {.dt = 1e-6, .law = law_of(ratio)});
}

/// Two free spheres that are pressed together by two walls. The walls are ten thousand times softer
/// than the contact, so the pair is nearly isolated.
Simulation pressed_pair(double ratio) {
    World world = make_world(Grains::spheres);
    auto& materials = world.resource<Materials>();
    const auto grain = materials.add(linear_material(kn, ratio * kn, 1e3, density));
    Material soft;
    soft.name = "soft wall";
    soft.normal_stiffness = 1e-4 * kn; // about that of the contact, in series with 2 kn
    const auto wall = materials.add(soft);
    const double squeeze = 1e-5 * radius,
                 wall_squeeze = 0.1 * radius; // 1e-4 of the stiffness, 1e4 times the overlap
    add_sphere(world, Vec3(0, 0, -radius + squeeze / 2), radius, grain);
    add_sphere(world, Vec3(0, 0, radius - squeeze / 2), radius, grain);
    const double position = 2 * radius - squeeze / 2 - wall_squeeze * (1 + 0.5e-4);
    const EntityId host = add_boundary(world, Vec3::Zero(), wall);
    add_plane(world, host, Vec3(0, 0, -position), Vec3::UnitZ());
    add_plane(world, host, Vec3(0, 0, position), -Vec3::UnitZ());
    return begin(std::move(world), {.dt = 1e-6, .law = law_of(ratio)});
}

/// A face-centred cubic crystal of `cells` cells along each side, compressed by 1e-3. Its outermost
/// spheres are fixed.
Simulation crystal(double ratio, int cells) {
    World world = make_world(Grains::spheres);
    const auto grain =
        world.resource<Materials>().add(linear_material(kn, ratio * kn, 1e3, density));
    const double cell = 2 * radius * (1 - 1e-3) * std::sqrt(2.0);
    for (int i = 0; i <= 2 * cells; ++i)
        for (int j = 0; j <= 2 * cells; ++j)
            for (int k = 0; k <= 2 * cells; ++k) {
                if ((i + j + k) % 2 != 0) continue;
                const auto skin = [&](int n) { return n == 0 || n == 2 * cells; };
                add_sphere(world, 0.5 * cell * Vec3(i, j, k), radius, grain,
                           skin(i) || skin(j) || skin(k) ? Motion::fixed : Motion::free);
            }
    return begin(std::move(world), {.dt = 1e-6, .law = law_of(ratio)});
}

void add_analytic(StressRows& rows, const StressSettings& s) {
    const double unit = std::sqrt(mass / kn);
    const auto add = [&](const std::string& what, Simulation simulation, double theory,
                         std::uint64_t steps) {
        const double found = limit_of(simulation, theory * unit, steps, s.seed) / unit;
        simulation.world().resource<Clock>().change_step(1e-9 * unit);
        simulation.advance(1);
        rows.push_back(
            {"S4", what, fmt::format("limit {:.4f} sqrt(m/kn) within 2 %", theory),
             fmt::format("{:.4f}, error {:.2f} %; estimate of the engine {:.3f}", found,
                         100 * (found / theory - 1), stable_step(simulation.world()) / unit),
             std::abs(found / theory - 1) < 0.02});
    };
    // closed forms: normal 2 and sqrt 2, tangential with rotation 2/sqrt(3.5) and 2/sqrt 7 over
    // sqrt(ks/kn)
    add("a sphere on a wall, ks = 0", on_wall(0), 2, 1000);
    add("a sphere on a wall, ks = kn", on_wall(1), 2 / std::sqrt(3.5), 1000);
    add("two spheres, ks = 0", pressed_pair(0), std::sqrt(2.0), 1000);
    add("two spheres, ks = kn", pressed_pair(1), 2 / std::sqrt(7.0), 1000);
    // theory is for infinite crystals; in a finite one with a fixed surface the shortest waves are
    // a little slower
    const int cells = s.full ? 12 : 6;
    add(fmt::format("a face-centred cubic crystal, {} cells along each side, ks = 0", cells),
        crystal(0, cells), std::sqrt(0.5), 1000);
    add(fmt::format("a face-centred cubic crystal, {} cells along each side, ks = kn", cells),
        crystal(1, cells), std::sqrt(0.1), 1000);
}

/// A bed at rest in which no contact can slide, so that it is an elastic system about its state.
Simulation loaded_bed(const Tumble& t, double ks_ratio) {
    Simulation simulation = bed_at_rest(t, 1e-8, ks_ratio);
    World& world = simulation.world();
    auto& materials = world.resource<Materials>();
    for (Material& m : materials.list) m.friction = 1e3;
    materials.mix();
    world.resource<LocalDamping>().fraction = 0;
    return simulation;
}

/// Adds the rows of a bed. Returns false and adds nothing if a body of this bed keeps rolling,
/// since only its speed would distinguish it from an unstable one.
bool add_bed(StressRows& rows, Grains grains, double ks_ratio, const StressSettings& s,
             std::uint64_t seed) {
    const unsigned bodies = grains == Grains::spheres ? 40 : 20;
    std::optional<Simulation> rests;
    if (!refusal_of([&] {
             rests.emplace(
                 loaded_bed({.grains = grains, .bodies = bodies, .seed = seed}, ks_ratio));
         }).empty())
        return false;
    Simulation& simulation = *rests;
    const double estimate = stable_step(simulation.world());
    const Archive begin = simulation.snapshot();
    if (!stays(simulation, begin, 0.25 * estimate, 4 * 2000, seed)) return false;
    const double limit =
        measured_limit([&](double dt) { return stays(simulation, begin, dt, 2000, seed); },
                       estimate, 1.8 * estimate);
    const std::string what =
        fmt::format("a bed of {} {}, ks / kn {}, seed {}", bodies,
                    grains == Grains::spheres ? "spheres" : "clumps", ks_ratio, seed);
    rows.push_back({"S4", what, "the engine's estimate is 0.6 to 1.0 of the limit",
                    fmt::format("{:.3f}", estimate / limit),
                    estimate / limit >= 0.6 && estimate / limit <= 1});
    const std::uint64_t steps = s.full ? 100'000 : 5000;
    const bool stable = stays(simulation, begin, estimate, steps, seed);
    // a body that rolls away does so with any step; an instability of the integration disappears
    // with a quarter of the step
    const bool rolls = !stable && !stays(simulation, begin, 0.25 * estimate, 4 * steps, seed);
    rows.push_back(
        {"S4", what + ": step equal to the estimate",
         fmt::format("stable over {} steps, or the same motion with a quarter of the step", steps),
         stable  ? "stable"
         : rolls ? "moves, also with a quarter of the step"
                 : "diverges",
         stable || rolls});
    const bool diverges = !stays(simulation, begin, 1.5 * limit, 2000, seed);
    rows.push_back({"S4", what + ": step of 1.5 times the limit", "diverges or is stopped",
                    diverges ? "diverges or is stopped" : "stays stable", diverges});
    return true;
}

} // namespace

StressRows stress_step_limit(const StressSettings& s) {
    StressRows rows;
    add_analytic(rows, s);
    for (const Grains grains : {Grains::spheres, Grains::clumps})
        for (const double ratio : {0.3, 1.0})
            for (std::uint64_t seed = s.seed, found = 0;
                 found < (s.full ? 4u : 1u) && seed < s.seed + 20; ++seed)
                found += add_bed(rows, grains, ratio, s, seed) ? 1u : 0u;
    return rows;
}

} // namespace bris
