// S12: conserved quantities stay constant over very many steps.
#include "scenarios/specimens/equilibrium.hpp"
#include "scenarios/specimens/small_scene.hpp"
#include "systems/output/quantities.hpp"
#include "tests/stability/cases.hpp"

#include <fmt/format.h>

namespace bris {

namespace {

/// A free body with three different principal moments that tumbles through all attitudes, by
/// 0.01 rad per step.
void add_top(StressRows& rows, std::uint64_t steps) {
    World world = make_world(Grains::clumps);
    Clump shape;
    shape.balls = {{Vec3::Zero(), 1}};
    shape.volume = 1;
    shape.inertia = Vec3(1, 2, 3);
    shape.bounding_radius = 1;
    const auto material = world.resource<Materials>().add(linear_material(1, 1, 0, 1));
    const EntityId body = add_clump(world, shape, 0, Vec3::Zero(), Quat::Identity(), material);
    set_angular_velocity(world, body, Vec3(0.1, 1, 0.1)); // about the middle axis: it flips
    const double dt = 0.01;
    Simulation simulation = begin(std::move(world), {.dt = dt});
    const auto energy = [&] {
        const Vec3 local = value_of<Orientation>(simulation, body).conjugate() *
                           value_of<AngularVelocity>(simulation, body);
        return 0.5 * local.cwiseAbs2().dot(shape.inertia);
    };
    const Vec3 momentum = value_of<AngularMomentum>(simulation, body);
    const double begun = energy();
    double norm = 0, turn = 0, first = 0, last = 0;
    constexpr int marks = 100;
    for (int k = 0; k < marks; ++k) {
        simulation.advance(steps / marks);
        norm = std::max(norm, std::abs(value_of<Orientation>(simulation, body).norm() - 1));
        turn = std::max(turn, (value_of<AngularMomentum>(simulation, body) - momentum).norm() /
                                  momentum.norm());
        const double error = std::abs(energy() / begun - 1);
        (k < marks / 2 ? first : last) = std::max(k < marks / 2 ? first : last, error);
    }
    const std::string what = fmt::format("a torque-free top, {} steps: ", steps);
    rows.push_back({"S12", what + "norm of the quaternion", "within 1e-12 of 1",
                    fmt::format("{:.1e}", norm), norm < 1e-12});
    rows.push_back({"S12", what + "angular momentum", "constant within 1e-9",
                    fmt::format("{:.1e}", turn), turn < 1e-9});
    // turn() is of fourth order and not symplectic: the energy drifts by less than
    // (0.01 rad)^5 / 120 per step
    const double bound = 1e-10 / 120 * static_cast<double>(steps);
    rows.push_back({"S12", what + "energy",
                    fmt::format("within {:.1e} of the initial energy", bound),
                    fmt::format("{:.1e} in the first half, {:.1e} in the second", first, last),
                    std::max(first, last) < bound});
    const Clock& clock = simulation.world().resource<Clock>();
    const double exact = static_cast<double>(steps / marks * marks) * dt;
    rows.push_back({"S12", what + "time", "exactly number of steps x dt",
                    fmt::format("{:.17g} s", clock.time()), clock.time() == exact});
}

void add_bed(StressRows& rows, Grains grains, std::uint64_t steps, std::uint64_t seed) {
    Simulation simulation = bed_at_rest(
        {.grains = grains, .bodies = grains == Grains::spheres ? 30u : 12u, .seed = seed}, 1e-9);
    const double diameter = 2 * mean_radius(simulation.world());
    std::vector<Vec3> before;
    const auto bodies = static_cast<EntityId>(simulation.world().table<Bodies>().size());
    for (EntityId id = 0; id < bodies; ++id) before.push_back(value_of<Position>(simulation, id));
    double half = 0, creep = 0;
    for (int k = 0; k < 2; ++k) {
        simulation.advance(steps / 2);
        creep = 0;
        for (EntityId id = 0; id < bodies; ++id)
            creep = std::max(creep,
                             (value_of<Position>(simulation, id) - before[id]).norm() / diameter);
        if (k == 0) half = creep;
    }
    rows.push_back({"S12",
                    fmt::format("a bed of {} at rest, {} steps",
                                grains == Grains::spheres ? "spheres" : "clumps", steps),
                    "creep < 1e-6 diameters",
                    fmt::format("{:.1e} after half of the steps, {:.1e} at the end", half, creep),
                    creep < 1e-6});
}

} // namespace

StressRows stress_long_drift(const StressSettings& s) {
    StressRows rows;
    add_top(rows, s.full ? 10'000'000 : 300'000);
    for (const Grains grains : {Grains::spheres, Grains::clumps})
        add_bed(rows, grains, s.full ? 2'000'000 : 40'000, s.seed);
    return rows;
}

} // namespace bris
