// S25: neighbour lists that are rebuilt in every step, at random, or with almost no skin give the
// same results.
#include "systems/broadphase/lists.hpp"

#include "engine/random.hpp"
#include "scenarios/specimens/small_scene.hpp"
#include "systems/output/quantities.hpp"
#include "tests/stability/cases.hpp"

#include <fmt/format.h>

namespace bris {

namespace {

struct Outcome {
    std::uint64_t hash, rebuilds, prunes;
};

/// `chance` is the probability that the lists are invalidated in a step.
Outcome run(const Tumble& scene, const ListSettings& lists, double chance, unsigned steps) {
    Simulation simulation =
        begin(tumbling(scene), {.dt = 2e-5, .law = LawName::linear_viscous, .lists = lists});
    Random random(scene.seed, 25);
    for (unsigned k = 0; k < steps; ++k) {
        if (random.uniform() < chance) invalidate_lists(simulation.world());
        simulation.advance();
    }
    const auto& state = simulation.world().resource<ListState>();
    return {fingerprint(simulation.snapshot()), state.rebuilds, state.prunes};
}

} // namespace

StressRows stress_lists(const StressSettings& s) {
    StressRows rows;
    const unsigned steps = s.full ? 20'000 : 1500;
    for (const Grains grains : {Grains::spheres, Grains::clumps}) {
        const Tumble scene{
            .grains = grains, .bodies = grains == Grains::spheres ? 100u : 30u, .seed = s.seed};
        const Outcome reference = run(scene, {}, 0, steps);
        const double diameter = 2 * mean_radius(tumbling(scene)), least = 1e-9 * diameter;
        const auto add = [&](const char* what, const ListSettings& lists, double chance) {
            const Outcome found = run(scene, lists, chance, steps);
            rows.push_back(
                {"S25",
                 fmt::format("{}: {}", grains == Grains::spheres ? "spheres" : "clumps", what),
                 fmt::format("same hash after {} steps", steps),
                 fmt::format("{:016x}, {} rebuilds, {} prunes", found.hash, found.rebuilds,
                             found.prunes),
                 found.hash == reference.hash && found.prunes > reference.prunes});
        };
        add("skins of 1e-9 diameters",
            {.outer_skin = 2 * least,
             .inner_skin = least,
             .largest_skin = 2 * least,
             .tune = false},
            0);
        add("all lists rebuilt in every step", {}, 1);
        add("all lists rebuilt at random", {}, 0.2);
    }
    return rows;
}

} // namespace bris
