// S14: results do not depend on the units of a scene.
#include "scenarios/specimens/small_scene.hpp"
#include "tests/stability/cases.hpp"

#include <fmt/format.h>

namespace bris {

namespace {

/// Positions, velocities and angular velocities without units, by id.
std::vector<double> bare_state(const Tumble& t, unsigned steps) {
    Simulation simulation =
        begin(tumbling(t), {.dt = 2e-5 * t.units.time, .law = LawName::linear_viscous});
    simulation.advance(steps);
    std::vector<double> list;
    for (EntityId id = 0; id < t.bodies; ++id) {
        const Vec3 x = value_of<Position>(simulation, id) / t.units.length,
                   v = value_of<Velocity>(simulation, id) * t.units.time / t.units.length,
                   w = value_of<AngularVelocity>(simulation, id) * t.units.time;
        for (const Vec3& vector : {x, v, w})
            list.insert(list.end(), {vector.x(), vector.y(), vector.z()});
    }
    return list;
}

double largest(const std::vector<double>& list) {
    double most = 0;
    for (const double x : list) most = std::max(most, std::abs(x));
    return most;
}

/// Largest difference relative to the largest value of the same quantity.
double difference(const std::vector<double>& a, const std::vector<double>& b) {
    double worst = 0;
    for (std::size_t kind = 0; kind < 3; ++kind) {
        std::vector<double> gap, size;
        for (std::size_t k = 0; k < a.size(); ++k)
            if (k % 9 / 3 == kind) {
                gap.push_back(a[k] - b[k]);
                size.push_back(a[k]);
            }
        worst = std::max(worst, largest(gap) / largest(size));
    }
    return worst;
}

std::string sentence_of(const Units& u) {
    return fmt::format("length x {:g}, mass x {:g}, time x {:g}", u.length, u.mass, u.time);
}

} // namespace

StressRows stress_unit_scaling(const StressSettings& s) {
    StressRows rows;
    for (const Grains grains : {Grains::spheres, Grains::clumps}) {
        Tumble scene{
            .grains = grains, .bodies = grains == Grains::spheres ? 60u : 20u, .seed = s.seed};
        const char* what = grains == Grains::spheres ? "spheres" : "clumps";
        // powers of two scale every rounding error with them: all bits must be equal even after a
        // long and chaotic run
        const unsigned long_run = s.full ? 20'000 : 2500;
        const auto exact = bare_state(scene, long_run);
        for (const Units& u : {Units{0x1p-20, 1, 1}, Units{0x1p20, 1, 1}, Units{1, 0x1p-40, 1},
                               Units{1, 1, 0x1p-20}, Units{0x1p10, 0x1p30, 0x1p15}}) {
            scene.units = u;
            const double error = difference(exact, bare_state(scene, long_run));
            rows.push_back({"S14", fmt::format("{}: {}", what, sentence_of(u)),
                            fmt::format("all bits equal after {} steps", long_run),
                            error == 0 ? "equal" : fmt::format("differs by {:.2e}", error),
                            error == 0});
        }
        // other factors change rounding errors, which a short run with contacts hardly amplifies
        constexpr unsigned short_run = 300;
        scene.units = {};
        const auto plain = bare_state(scene, short_run);
        std::vector<Units> systems{{1e3, 1e-3, 1}, {1e6, 1, 1}, {1e-6, 1, 1}, {1, 1e6, 1},
                                   {1, 1e-6, 1},   {1, 1, 1e6}, {1, 1, 1e-6}};
        for (const double stiffness : {1e3, 1e4, 1e6, 1e8, 1e10})
            systems.push_back({1, 1, std::sqrt(1e5 / stiffness)}); // with speeds to match
        for (const Units& u : systems) {
            scene.units = u;
            const double error = difference(plain, bare_state(scene, short_run));
            rows.push_back({"S14", fmt::format("{}: {}", what, sentence_of(u)),
                            fmt::format("equal to 1e-12 after {} steps", short_run),
                            fmt::format("differs by {:.2e}", error), error < 1e-12});
        }
    }
    return rows;
}

} // namespace bris
