// S4: spheres fall into a box and come to rest. A packing depends on its history, so all variants
// of a seed start from the same spheres, and the error of a variant is the mean difference to its
// reference over the seeds.
#include "components/settings.hpp"
#include "engine/choice.hpp"
#include "engine/ordering.hpp"
#include "engine/random.hpp"
#include "scenarios/collision/impact.hpp"
#include "scenarios/specimens/small_scene.hpp"
#include "scenarios/specimens/sphere_bed.hpp"
#include "systems/broadphase/lists.hpp"
#include "systems/output/balance.hpp"
#include "systems/output/frames.hpp"
#include "systems/output/quantities.hpp"
#include "systems/steps.hpp"
#include "tests/performance/time_vs_error/scene.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace bris::time_vs_error {

namespace {

constexpr unsigned spheres = 1000;
constexpr double radius = 0.01, spread = 0.2; // m, of radii
constexpr double speed = 0.5; // m/s, at which Hertz contacts last as long as linear contacts
constexpr double longest = 3; // s, largest simulated time

/// Material with a stiffness for which a contact of two mean spheres lasts equally long with every
/// law.
Material grain_of(const Settings& settings) {
    const double kn = settings.number("stiffness");
    Material m = linear_material(kn, settings.number("shear_ratio") * kn, 0.5);
    m.restitution = settings.number("restitution");
    m.poisson_ratio = 0.25;
    m.young_modulus = 1e8;
    const double linear = like_spheres(m, LawName::linear, radius, speed).time();
    const double hertz = like_spheres(m, LawName::hertz_mindlin, radius, speed).time();
    m.young_modulus *=
        std::pow(hertz / linear, 2.5); // contact time is proportional to modulus^(-2/5)
    return m;
}

ListSettings lists_of(const Settings& settings) {
    if (settings.word("skin") == "tuned") return {};
    const double skin = settings.number("skin") * radius;
    return {.outer_skin = 3 * skin, .inner_skin = skin, .largest_skin = 3 * skin, .tune = false};
}

Simulation make_bed(const Settings& settings, std::uint64_t seed, double& contact_time) {
    SphereBed bed;
    bed.spheres = spheres;
    bed.radius = radius;
    bed.size_spread = spread;
    bed.seed = seed;
    World world = make_sphere_bed(bed);
    const auto law = named<LawName>(settings.word("law"));
    auto& materials = world.resource<Materials>();
    materials.list.front() = grain_of(settings);
    materials.mix();
    contact_time = like_spheres(materials.list.front(), LawName::linear, radius, speed).time();
    world.resource<Clock>().dt = settings.number("step") * contact_time;
    // random velocities large enough to destroy the order of the lattice
    const auto mass = world.column<Bodies, Mass>();
    for (Row b = 0; b < mass.size(); ++b) {
        Random random(seed, 4000 + world.column<Bodies, BodyId>()[b]);
        if (mass[b] > 0) world.column<Bodies, Velocity>()[b] = 0.4 * random.direction();
    }
    if (settings.number("damping") > 0)
        world.add_resource(LocalDamping{settings.number("damping")});
    add_lists(world, law, lists_of(settings));
    return Simulation(std::move(world), steps(law));
}

/// Solid fraction below twice the height of the centre of gravity, which is the whole bed including
/// the regions near walls and surface. It is smaller than in the bulk, but so precise that a few
/// seeds show its changes.
double solid_fraction(const World& world, double width) {
    const Table& bodies = world.table<Bodies>();
    double mass = 0, moment = 0, volume = 0;
    for (const Row b : rows_by_id(bodies.column<BodyId>())) { // sums do not depend on row order
        const double m = bodies.column<Mass>()[b];
        mass += m;
        moment += m * bodies.column<Position>()[b].z();
        if (m > 0) volume += 4.0 / 3 * pi * std::pow(bodies.column<BoundingRadius>()[b], 3);
    }
    return volume / (width * width * 2 * moment / mass);
}

/// Mean number of partners of the spheres with at least two partners. A sphere with fewer carries
/// no load.
double coordination(const World& world) {
    double sum = 0, carriers = 0;
    for (const float z : frame_of_bodies(world).coordination)
        if (z >= 2) sum += static_cast<double>(z), ++carriers;
    return carriers > 0 ? sum / carriers : 0;
}

Outcome run(const Settings& settings, std::uint64_t seed) {
    double contact_time = 0;
    Simulation sim = make_bed(settings, seed, contact_time);
    const World& world = sim.world();
    const double dt = world.resource<Clock>().dt;
    const auto block =
        static_cast<std::uint64_t>(std::max(1.0, std::round(20 * contact_time / dt)));
    const auto at_rest = [&] {
        const Balance balance = compute_balance(world);
        return balance.contacts >= balance.free_bodies &&
               balance.unbalanced_ratio <= settings.number("rest");
    };
    Outcome outcome;
    outcome.wall_time = median_time(1, 0, [&] {
        do sim.advance(block);
        while (!at_rest() && world.resource<Clock>().time() < longest);
    });
    const Quantities q = compute_quantities(world);
    outcome.steps = world.resource<Clock>().step;
    outcome.contacts = static_cast<double>(q.contacts);
    outcome.measured = {{solid_fraction(world, world.resource<Limits>().high.x() -
                                                   world.resource<Limits>().low.x()),
                         unknown},
                        {coordination(world), unknown},
                        {q.boundary_force.z() / q.weight.z(), 1},
                        {q.unbalanced_ratio, 0}};
    outcome.fingerprint = hexadecimal(fingerprint(sim.snapshot()));
    outcome.note = fmt::format("{} after {:.2f} s, mean overlap {:.2e} of the radius",
                               at_rest() ? "at rest" : "not at rest",
                               world.resource<Clock>().time(), q.mean_overlap / radius);
    return outcome;
}

} // namespace

Scene packing() {
    Scene s{"S4",
            fmt::format("packing of {} spheres under their weight", spheres),
            {{"step", "0.05"},
             {"skin", "tuned"},
             {"stiffness", "3e4"},
             {"law", "linear_viscous"},
             {"damping", "0.3"},
             {"restitution", "0.3"},
             {"shear_ratio", "0.8"},
             {"rest", "1e-3"}},
            {},
            {},
            run,
            "packing"};
    s.kinds = {{"solid_fraction", 0.002},
               {"coordination", 0.05},
               {"floor_force", 1e-3, false, true},
               {"unbalanced", 1e-3, false, true}};
    s.knobs = {{"step", "step", {"0.1", "0.05", "0.02", "0.01"}, {}, {{"step", "0.01"}}},
               {"unbalanced ratio",
                "rest",
                {"0.1", "1e-2", "1e-3", "1e-4", "1e-5"},
                {},
                {{"rest", "1e-5"}}},
               {"stiffness (N/m)",
                "stiffness",
                {"3e3", "1e4", "3e4", "1e5", "3e5"},
                {},
                {{"stiffness", "3e5"}}},
               {"ks/kn", "shear_ratio", {"0.2", "0.5", "0.8", "1"}, {}, {{"shear_ratio", "0.8"}}},
               {"law",
                "law",
                {"linear_viscous", "hertz_mindlin_viscous"},
                {},
                {{"law", "hertz_mindlin_viscous"}}},
               {"local damping", "damping", {"0", "0.1", "0.3", "0.7"}, {}, {{"damping", "0"}}},
               {"skin (radii)", "skin", {"tuned", "0.02", "0.1", "0.3"}, {}, {}, true}};
    return s;
}

} // namespace bris::time_vs_error
