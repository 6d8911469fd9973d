#include "tests/verification/cooling.hpp"

#include "components/settings.hpp"
#include "engine/errors.hpp"
#include "engine/estimation/linear_fit.hpp"
#include "engine/random.hpp"
#include "scenarios/collision/impact.hpp"
#include "scenarios/specimens/small_scene.hpp"

#include <cmath>
#include <vector>

namespace bris {

namespace {

/// Twice the translational kinetic energy, J. The spheres are smooth and do not rotate.
double motion_of(const World& world) {
    const auto velocity = world.column<Bodies, Velocity>();
    const auto mass = world.column<Bodies, InertialMass>();
    double sum = 0;
    for (Row b = 0; b < mass.size(); ++b) sum += mass[b] * velocity[b].squaredNorm();
    return sum;
}

} // namespace

CoolingResult run_experiment(const Cooling& s) {
    require(s.material.restitution > 0 && s.material.restitution < 1,
            "cooling: expected a coefficient of restitution between 0 and 1");
    require(s.pitch > 1 && s.from <= 1 && s.to < s.from && s.to > 0,
            "cooling: expected a pitch above 1 and 1 >= from > to > 0");
    const double dt = like_spheres(s.material, s.law, s.radius, s.speed).time() /
                      s.steps_per_contact,
                 unit = 2 * s.radius / s.speed;

    World world = make_world(Grains::spheres);
    auto& materials = world.resource<Materials>();
    const auto grain = materials.add(s.material), wall = materials.add(s.material);
    materials.set_pair(grain, wall, {.restitution = 1});
    const double pitch = 2 * s.radius * s.pitch;
    for (unsigned i = 0; i < s.side * s.side * s.side; ++i) {
        Random random(s.seed, i);
        const Vec3 site =
            pitch * Vec3(i % s.side + 0.5, i / s.side % s.side + 0.5, i / s.side / s.side + 0.5);
        const EntityId id = add_sphere(world, site, s.radius, grain);
        value_of<Velocity>(world, id) = s.speed * random.direction();
    }
    add_box(world, Vec3::Zero(), Vec3::Constant(pitch * s.side), wall);
    const double first = motion_of(world);
    Simulation sim = begin(std::move(world), {.dt = dt, .law = s.law, .unlimited = true});

    CoolingResult r;
    std::vector<double> time, root; // 1/sqrt(T / T0)
    const auto every = static_cast<std::uint64_t>(std::max(1.0, 0.2 * unit / dt));
    const auto limit = static_cast<std::uint64_t>(1e4 * unit / dt);
    double left = 1;
    while (left > s.to && r.steps < limit) {
        sim.advance(every);
        r.steps += every;
        left = motion_of(sim.world()) / first;
        if (left > s.from) continue;
        time.push_back(sim.world().resource<Clock>().time() / unit);
        root.push_back(1 / std::sqrt(left));
    }
    if (left > s.to) throw SimulationError("cooling: the gas does not reach the final temperature");
    const LinearFit fit = fit_line(time, root, time.front(), time.back());
    const double n = static_cast<double>(fit.points), squares = fit.slope * fit.slope;
    r.r_squared = squares / (squares + (n - 2) * fit.slope_error * fit.slope_error);
    r.time = fit.intercept / fit.slope;
    r.samples = fit.points;
    return r;
}

} // namespace bris
