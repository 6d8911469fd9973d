// S6: the energy budget closes, and friction, dashpots and rolling resistance only dissipate.
#include "systems/contact/energy_budget.hpp"

#include "components/pair.hpp"
#include "engine/ordering.hpp"
#include "scenarios/specimens/small_scene.hpp"
#include "systems/contact/stable_step.hpp"
#include "systems/output/quantities.hpp"
#include "tests/stability/cases.hpp"

#include <fmt/format.h>

#include <array>

namespace bris {

namespace {

constexpr std::array laws{LawName::linear,
                          LawName::linear_viscous,
                          LawName::linear_rolling,
                          LawName::hertz_mindlin,
                          LawName::hertz_mindlin_viscous,
                          LawName::hertz_mindlin_rolling,
                          LawName::linear_edges,
                          LawName::hertz_edges};
constexpr std::array law_titles{"linear",
                                "linear, dashpots",
                                "linear, rolling",
                                "Hertz-Mindlin",
                                "Hertz-Mindlin, dashpots",
                                "Hertz-Mindlin, rolling",
                                "linear, edges",
                                "Hertz-Mindlin, edges that yield"};

template <class Column>
double sum(const World& world) {
    if (!world.table<Bodies>().has<Column>()) return 0;
    const auto column = world.column<Bodies, Column>();
    double total = 0;
    for (const Row b : rows_by_id(world.column<Bodies, BodyId>())) total += column[b];
    return total;
}

/// Energy (kinetic, elastic and potential), dissipated work and work put in, J.
struct Account {
    double energy = 0, taken = 0, put_in = 0;
    double total() const { return energy + taken - put_in; }
};

Account budget_of(const World& world) {
    const Quantities q = compute_quantities(world);
    Account a{q.kinetic_energy + q.elastic_energy, 0, 0};
    const Table& bodies = world.table<Bodies>();
    if (world.has_resource<Gravity>())
        for (const Row b : rows_by_id(bodies.column<BodyId>()))
            if (bodies.column<MotionOf>()[b] == static_cast<std::uint32_t>(Motion::free))
                a.energy -= bodies.column<Mass>()[b] *
                            world.resource<Gravity>().value.dot(bodies.column<Position>()[b]);
    a.taken = dissipated_in_contacts(world) + sum<DampingWork>(world);
    a.put_in = sum<BoundaryWork>(world) + sum<ScalingWork>(world);
    return a;
}

/// Work dissipated in the single contact of a scene, by friction, dashpots, rolling and wear.
std::array<double, 4> dissipated(const World& world) {
    return {sum<FrictionWork>(world), sum<ViscousWork>(world), sum<RollingWork>(world),
            sum<WearWork>(world)};
}

Material grain(double friction) {
    Material m = linear_material(1e6, 8e5, friction);
    m.young_modulus = 1e9;
    m.poisson_ratio = 0.25;
    m.restitution = 0.8;
    m.rolling_friction = 0.1;
    m.twisting_friction = 0.05;
    m.contact_strength = 2e7; // an impact of 1 m/s reaches three times as much
    m.cone_half_angle = pi / 3;
    m.edge_radius = 0.005;
    m.friction_rise = 0.5 * friction;
    m.friction_half_pressure = 1e7;
    m.friction_half_force = 50;
    m.couple_arm = 0.002;
    m.couple_force = 50;
    return m;
}

struct Impact {
    double least = 0;   ///< smallest dissipated work relative to the initial energy, if negative
    double closure = 0; ///< error of the budget relative to the initial energy
};

/// A spinning sphere hits a plane or another sphere at an angle (degrees) from the normal. `phase`:
/// fraction of a step from an instant to the first touch.
Impact impact(LawName law, double degrees, double friction, bool pair, double dt, double phase) {
    constexpr double radius = 0.01, speed = 1;
    World world = make_world(Grains::spheres);
    const auto material = world.resource<Materials>().add(grain(friction));
    const double angle = degrees * pi / 180;
    const EntityId ball = add_sphere(world, Vec3::Zero(), radius, material);
    const Vec3 velocity = speed * Vec3(std::sin(angle), 0, -std::cos(angle));
    value_of<Position>(world, ball) = Vec3(0, 0, radius) - (3 + phase) * dt * velocity;
    value_of<Velocity>(world, ball) = velocity;
    set_angular_velocity(world, ball, Vec3(3, -5, 7));
    if (pair)
        add_sphere(world, Vec3(0, 0, -radius), radius, material);
    else
        add_floor(world, material);
    Simulation simulation = begin(std::move(world), {.dt = dt, .law = law, .energy_budget = true});
    const double start = budget_of(simulation.world()).energy;
    Impact found;
    simulation.advance(4);
    for (int k = 0;
         k < 20'000 && (k < 3 || value_of<Acceleration>(simulation, ball).squaredNorm() > 0); ++k) {
        const auto before = dissipated(simulation.world());
        simulation.advance(1);
        const auto after = dissipated(simulation.world());
        const auto [by_friction, by_dashpots, by_rolling, by_wear] = after;
        found.least = std::min({found.least, (by_friction - before[0]) / start, by_dashpots / start,
                                (by_rolling - before[2]) / start, (by_wear - before[3]) / start});
    }
    simulation.advance(2);
    found.closure = std::abs(budget_of(simulation.world()).total() / start - 1);
    return found;
}

struct Scan {
    unsigned count = 0;
    double least = 0, closure = 0;
    std::string where;
};

/// Which impacts are computed.
struct Impacts {
    std::vector<double> frictions, angles{89}, phases{0.3};
    Impacts(bool high, bool full) {
        frictions = high   ? std::vector<double>{3, 10}
                    : full ? std::vector<double>{0, 0.01, 0.1, 0.5, 1}
                           : std::vector<double>{0, 0.1, 1};
        for (double degrees = 0; degrees < 89; degrees += full ? 3 : 20) angles.push_back(degrees);
        if (full) phases = {0.05, 0.3, 0.55, 0.8, 0.95};
    }
};

/// Impacts from 0 to 89 degrees at a fraction `share` of the critical step 2/omega of the linear
/// spring. Hertz contacts have about the same stiffness here.
Scan scan(LawName law, const Impacts& impacts, double share) {
    const double dt = share * 2 * std::sqrt(2600 * 4 * pi / 3 * 1e-6 / 1e6);
    Scan all;
    for (const double friction : impacts.frictions)
        for (const double degrees : impacts.angles)
            for (const double phase : impacts.phases)
                for (const bool pair : {false, true}) {
                    const Impact i = impact(law, degrees, friction, pair, dt, phase);
                    ++all.count;
                    all.least = std::min(all.least, i.least);
                    if (!(i.closure > all.closure)) continue;
                    all.closure = i.closure;
                    all.where = fmt::format("{} degrees, friction {}, {}", degrees, friction,
                                            pair ? "pair" : "plane");
                }
    return all;
}

void add_impacts(StressRows& rows, std::size_t which, const StressSettings& s) {
    for (const bool high : {false, true}) {
        const Impacts impacts(high, s.full);
        const Scan coarse = scan(laws[which], impacts, 0.1),
                   fine = scan(laws[which], impacts, 0.025);
        const std::string what = fmt::format("{} oblique impacts, friction {}, {}", coarse.count,
                                             high ? "3 and 10" : "0 to 1", law_titles[which]);
        rows.push_back(
            {"S6", what + ": dissipated work",
             "friction and rolling: not negative in any step; dashpots: not negative at any "
             "time, as the last step of a contact is corrected (rounding: 1e-14 of the energy)",
             fmt::format("minimum {:.1e} of the energy", std::min(coarse.least, fine.least)),
             std::min(coarse.least, fine.least) >= -1e-14});
        const double order = std::log2(coarse.closure / fine.closure) / 2;
        rows.push_back({"S6", what + ": closure of the energy budget",
                        "< 1e-2 at 0.1 and < 1e-3 at 0.025 of the critical step",
                        fmt::format("{:.1e} ({}) and {:.1e}, order {:.1f}", coarse.closure,
                                    coarse.where, fine.closure, order),
                        coarse.closure < 1e-2 && fine.closure < 1e-3});
    }
}

/// Closure of the energy budget of grains that fall into a box, whose floor rises for a while, and
/// come to rest. At start and end no power flows.
double bed_closure(LawName law, Grains grains, bool shear_dashpot, double share,
                   std::uint64_t seed) {
    World world =
        tumbling({.grains = grains, .bodies = grains == Grains::spheres ? 24u : 12u, .seed = seed});
    auto& materials = world.resource<Materials>();
    for (Material& m : materials.list) {
        const double friction = m.friction, density = m.density;
        m = grain(friction);
        m.density = density;
        m.normal_damping = has_dashpots(law) ? 500 : 0;
        m.shear_damping = shear_dashpot ? m.normal_damping / 2 : 0;
        m.young_modulus = 1e8;
    }
    materials.mix();
    for (Ball& ball : world.column<Spheres, LocalBall>())
        ball.radius *= 0.95; // nothing touches at the start
    if (!has_dashpots(law)) world.add_resource(LocalDamping{0.3});
    const EntityId host = add_boundary(world, Vec3::Zero(), 1, Motion::prescribed);
    add_plane(world, host, Vec3::Zero(), Vec3::UnitZ());
    const double dt =
        share * (is_hertz(law) ? 6e-5 : 3e-5); // fraction of about the largest stable step
    Simulation simulation = begin(std::move(world), {.dt = dt, .law = law, .energy_budget = true});
    const double start = budget_of(simulation.world()).energy;
    const auto steps = [&](double time) {
        return static_cast<std::uint64_t>(std::llround(time / dt));
    };
    simulation.advance(steps(0.03));
    value_of<DriveVelocity>(simulation, host) = Vec3(0, 0, 0.2);
    simulation.advance(steps(0.02));
    value_of<DriveVelocity>(simulation, host).setZero();
    simulation.advance(steps(0.12));
    const Account a = budget_of(simulation.world());
    return std::abs(a.total() - start) / (a.taken + std::abs(a.put_in));
}

void add_bed(StressRows& rows, std::size_t which, Grains grains, bool shear_dashpot,
             const StressSettings& s) {
    std::array<double, 3> closure{};
    double share = 0.4;
    for (double& c : closure) {
        const std::uint64_t draws = s.full ? 12 : 2;
        for (std::uint64_t k = 0; k < draws; ++k)
            c += bed_closure(laws[which], grains, shear_dashpot, share, s.seed + k) /
                 static_cast<double>(draws);
        share /= 2;
    }
    const double order = std::log2(closure[0] / closure[2]) / 2;
    rows.push_back({"S6",
                    fmt::format("{} fall and come to rest on a moving floor, {}{}",
                                grains == Grains::spheres ? "spheres" : "clumps", law_titles[which],
                                shear_dashpot ? ", also in shear" : ""),
                    // runs with different steps soon diverge, and errors of either sign cancel:
                    // each closure scatters by a factor of a few and may be small by chance, so the
                    // order has a lower bound only
                    "closure < 1e-3 at 0.1 of the stable step, order above 0.5",
                    fmt::format("{:.1e}, {:.1e}, {:.1e} at 0.4, 0.2, 0.1; order {:.2f}", closure[0],
                                closure[1], closure[2], order),
                    closure[2] < 1e-3 && order > 0.5});
}

} // namespace

StressRows stress_energy_budget(const StressSettings& s) {
    StressRows rows;
    for (std::size_t which = 0; which < laws.size(); ++which) add_impacts(rows, which, s);
    for (std::size_t which = 0; which < laws.size(); ++which) {
        // without dashpots only local damping brings bodies to rest, and its budget needs clumps
        const bool damped = has_dashpots(laws[which]);
        if (damped) add_bed(rows, which, Grains::spheres, false, s);
        if (!damped || s.full) add_bed(rows, which, Grains::clumps, false, s);
        if (damped && !has_rolling(laws[which])) add_bed(rows, which, Grains::spheres, true, s);
    }
    return rows;
}

} // namespace bris
