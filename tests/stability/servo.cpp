// S7: the servo of membrane and platen reaches its target pressure within its speed limit, and
// walls do not pass through each other; otherwise the run stops with a reason.
#include "components/membrane.hpp"
#include "components/platen.hpp"
#include "engine/errors.hpp"
#include "engine/random.hpp"
#include "scenarios/specimens/small_scene.hpp"
#include "systems/broadphase/lists.hpp"
#include "tests/stability/cases.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <numeric>

namespace bris {

namespace {

constexpr double tube_radius = 0.05, grain_radius = 0.0075;

struct Tube {
    double stiffness = 1e5;    ///< N/m, of all contacts
    double pressure = 1e4;     ///< Pa, target of rings and platen
    double speed = 0;          ///< m/s, initial speed of the grains
    double damping = 0.7;      ///< local damping of the grains
    double wall_damping = 0.7; ///< local damping of rings and platen
    int layers = 5;            ///< number of layers of grains; 0: no grains
    int columns = 4;           ///< number of grains along each side of a layer
    double height = 0.1;       ///< m
    double filling = 1;        ///< size of the grains relative to the size that fits
    std::uint64_t seed = 1;
};

/// Grains on a lattice in a membrane of 2 x 8 elements, which is closed by a floor and a servo
/// platen. There is no gravity.
Simulation make_tube(const Tube& t) {
    World world = make_world(Grains::spheres);
    auto& materials = world.resource<Materials>();
    const auto grain = materials.add(linear_material(t.stiffness, 0.3 * t.stiffness, 0.3));
    Membrane membrane;
    membrane.rings = 2;
    membrane.sectors = 8;
    membrane.ring_height = t.height / membrane.rings;
    membrane.target_pressure = t.pressure;
    membrane.contact_stiffness = t.stiffness;
    membrane.largest_step = 1e-4 * tube_radius;
    membrane.damping = t.wall_damping;
    add_membrane(world, std::move(membrane), tube_radius, grain);
    const EntityId bottom = add_boundary(world, Vec3::Zero(), grain);
    const EntityId top = add_boundary(world, Vec3(0, 0, t.height), grain, Motion::servo);
    add_plane(world, bottom, Vec3::Zero(), Vec3(0, 0, 1));
    Platen platen;
    platen.plane = add_plane(world, top, Vec3::Zero(), Vec3(0, 0, -1));
    platen.controlled = true;
    platen.target_pressure = t.pressure;
    platen.contact_stiffness = t.stiffness;
    platen.largest_step = 1e-4 * tube_radius;
    platen.damping = t.wall_damping;
    world.add_resource(platen);
    world.add_resource(LocalDamping{t.damping});
    Random random(t.seed, 7);
    const double pitch = 0.0165;
    double mass = 2600 * 4 * pi / 3 * std::pow(grain_radius, 3);
    for (int n = 0; n < t.layers * t.columns * t.columns; ++n) {
        const int layer = n / (t.columns * t.columns), i = n % t.columns,
                  j = n / t.columns % t.columns;
        const Vec3 position(pitch * (i - 0.5 * (t.columns - 1)),
                            pitch * (j - 0.5 * (t.columns - 1)),
                            grain_radius + 0.001 + pitch * layer);
        const double radius = t.filling * grain_radius * random.uniform(0.85, 1);
        const EntityId id =
            add_sphere(world, position + 0.0003 * random.direction(), radius, grain);
        value_of<Velocity>(world, id) = t.speed * random.direction();
    }
    if (t.layers == 0) mass = 1;
    world.resource<Limits>().speed = 1e9; // no limit but the servo's own one
    return begin(std::move(world),
                 {.dt = 0.2 * std::sqrt(mass / t.stiffness), .law = LawName::linear});
}

/// Observations of the walls in a run.
struct Watch {
    double fastest = 0;          ///< largest speed of a wall relative to its limit
    double least_radius = 1e300; ///< m
    double least_height = 1e300; ///< m
    double peak = 0;             ///< Pa, the highest pressure of any wall
    std::vector<double> late;    ///< Pa, mean pressures of the walls in the last tenth of the run
    std::string stop;            ///< reason for which the run stopped; empty: it did not

    double mean() const {
        return late.empty() ? 0
                            : std::accumulate(late.begin(), late.end(), 0.0) /
                                  static_cast<double>(late.size());
    }
    double deviation() const {
        double squares = 0;
        for (const double p : late) squares += (p - mean()) * (p - mean());
        return late.empty() ? 0 : std::sqrt(squares / static_cast<double>(late.size()));
    }
};

/// Runs a simulation and observes the walls every `every` steps. `w`: what was observed before.
Watch watch(Simulation& simulation, std::uint64_t steps, std::uint64_t every = 1, Watch w = {}) {
    w.late.clear();
    const World& world = simulation.world();
    try {
        for (std::uint64_t k = 0; k < steps; k += every) {
            simulation.advance(every);
            const auto& membrane = world.resource<Membrane>();
            const auto& platen = world.resource<Platen>();
            const double dt = world.resource<Clock>().dt;
            double sum = platen.pressure;
            for (const double p : membrane.pressure) sum += p;
            for (const double p : membrane.pressure) w.peak = std::max(w.peak, p);
            w.peak = std::max(w.peak, platen.pressure);
            for (const double v : world.column<Elements, ElementSpeed>())
                w.fastest = std::max(w.fastest, std::abs(v) * dt / membrane.largest_step);
            for (const double r : world.column<Elements, ElementRadius>())
                w.least_radius = std::min(w.least_radius, r);
            w.fastest = std::max(w.fastest, std::abs(platen.speed) * dt / platen.largest_step);
            const Row host = world.column<Planes, HostRow>()[platen.plane];
            w.least_height = std::min(w.least_height, world.column<Bodies, Position>()[host].z());
            if (k >= steps - steps / 10)
                w.late.push_back(sum / static_cast<double>(membrane.pressure.size() + 1));
        }
    } catch (const SimulationError& error) {
        w.stop = error.what();
    }
    return w;
}

void add_walls(StressRows& rows, const std::string& what, const Watch& w) {
    rows.push_back(
        {"S7", what + ": walls", "within the speed limit, no wall passes through another",
         fmt::format("{:.3f} of the speed limit, smallest radius {:.1f} mm, height {:.1f} mm",
                     w.fastest, 1e3 * w.least_radius, 1e3 * w.least_height),
         w.fastest <= 1 + 1e-12 && w.least_radius > 0 && w.least_height > 0});
}

bool has_settled(const Watch& w, double target) {
    // with a target of 0 the error is relative to the pressure before
    const double scale = target > 0 ? target : Tube{}.pressure;
    return w.stop.empty() && std::abs(w.mean() - target) < 0.01 * scale &&
           w.deviation() < 1e-3 * scale;
}

/// If `may_stop`, the run may also stop with a reason, since there is too little to push against.
void add_settled(StressRows& rows, const std::string& what, const Watch& w, double target,
                 bool may_stop = false) {
    const bool settled = has_settled(w, target);
    rows.push_back(
        {"S7", what + ": pressure",
         may_stop ? "settles at the target: mean within 1 %, standard deviation below 0.1 %; or "
                    "stops with a reason"
                  : "settles at the target: mean within 1 %, standard deviation below 0.1 %",
         w.stop.empty() ? fmt::format("mean {:.5g} of {:.5g} Pa, standard deviation {:.1e} Pa",
                                      w.mean(), target, w.deviation())
                        : w.stop,
         settled || (may_stop && !w.stop.empty())});
}

void add_overshoot(StressRows& rows, const std::string& what, const Watch& w, double target) {
    rows.push_back({"S7", what + ": overshoot", "< 5 %",
                    fmt::format("{:.2f} %", 100 * (w.peak / target - 1)),
                    w.stop.empty() && w.peak > 0.9 * target && w.peak < 1.05 * target});
}

void set_target(Simulation& simulation, double pressure) {
    simulation.world().resource<Membrane>().target_pressure = pressure;
    simulation.world().resource<Platen>().target_pressure = pressure;
}

/// Makes all grains smaller, so that every contact is lost.
void shrink(Simulation& simulation, double factor) {
    for (Ball& ball : simulation.world().column<Spheres, LocalBall>()) ball.radius *= factor;
    invalidate_lists(simulation.world());
}

void add_gas_and_few(StressRows& rows, std::uint64_t steps) {
    const auto try_tube = [&](const std::string& what, const Tube& t) {
        Simulation simulation = make_tube(t);
        const Watch w = watch(simulation, steps);
        add_walls(rows, what, w);
        add_settled(rows, what, w, t.pressure, true);
    };
    try_tube("an empty tube", {.layers = 0});
    try_tube("a gas", {.speed = 1, .damping = 0, .layers = 4, .columns = 3, .filling = 0.5});
    try_tube("one grain", {.layers = 1, .columns = 1});
}

void add_loaded(StressRows& rows, double wall_damping, std::uint64_t steps) {
    const Tube t{.wall_damping = wall_damping};
    Simulation simulation = make_tube(t);
    const Watch first = watch(simulation, steps);
    const std::string bed = fmt::format("a bed, wall damping {}: ", wall_damping);
    add_walls(rows, bed + "first loading", first);
    add_settled(rows, bed + "first loading", first, t.pressure);
    const Archive settled = simulation.snapshot();
    const auto again = [&](const std::string& what, double target,
                           const std::function<void()>& change) {
        simulation.restore(settled);
        change();
        const Watch w = watch(simulation, steps);
        add_walls(rows, what, w);
        add_settled(rows, what, w, target);
        return w;
    };
    again(bed + "sudden loss of all contacts", t.pressure, [&] { shrink(simulation, 0.9); });
    again(bed + "target 0", 0, [&] { set_target(simulation, 0); });
    const Watch up = again(bed + "target x 1.5", 1.5 * t.pressure,
                           [&] { set_target(simulation, 1.5 * t.pressure); });
    add_overshoot(rows, bed + "target x 1.5", up, 1.5 * t.pressure);
    again(bed + "target / 100", t.pressure / 100,
          [&] { set_target(simulation, t.pressure / 100); });
    simulation.restore(settled);
    set_target(simulation, t.pressure / 100);
    watch(simulation, steps);
    set_target(simulation, t.pressure);
    const Watch w = watch(simulation, steps);
    add_walls(rows, bed + "target x 100", w);
    add_settled(rows, bed + "target x 100", w, t.pressure);
    add_overshoot(rows, bed + "target x 100", w, t.pressure);
}

/// Stiffer grains force the walls to take shorter steps, so the same displacement needs more steps.
/// The walls can settle only when the loose bed has stopped compacting, and how long that takes is
/// a matter of chance: at 1e8 N/m the volume falls until 0.5 to 1 million steps, with five servos
/// (damping of the walls of 0.3, 0.7 and 0.9, walls ten times heavier, softer damping of the
/// grains) and three seeds alike, and from then on the pressure is constant to 1e-6. So a run goes
/// on for up to four times `all_steps`; an oscillation of the servo itself would not end by then.
void add_stiffnesses(StressRows& rows, double stiffest, std::uint64_t all_steps) {
    for (const double stiffness : {1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10}) {
        if (stiffness > stiffest) continue;
        const auto steps = static_cast<std::uint64_t>(static_cast<double>(all_steps) *
                                                      std::max(1.0, std::sqrt(stiffness / 1e5)));
        const Tube t{.stiffness = stiffness,
                     .pressure = stiffness < 1e5 ? 1e4 * stiffness / 1e5 : 1e4};
        Simulation simulation = make_tube(t);
        Watch w;
        std::uint64_t parts = 0;
        do w = watch(simulation, steps, 50, w); // millions of steps of the stiffest
        while (++parts < 4 && w.stop.empty() && !has_settled(w, t.pressure));
        const std::string what = fmt::format("stiffness {:.0e} N/m", stiffness);
        add_walls(rows, what, w);
        add_settled(rows, fmt::format("{}, {} steps", what, parts * steps), w, t.pressure);
    }
}

} // namespace

StressRows stress_servo(const StressSettings& s) {
    StressRows rows;
    const std::uint64_t steps = s.full ? 40'000 : 25'000;
    add_gas_and_few(rows, steps);
    add_loaded(rows, 0.7, steps);
    if (s.full) add_loaded(rows, 0.9, steps);
    add_stiffnesses(rows, s.full ? 1e10 : 1e5, 20'000);
    return rows;
}

} // namespace bris
