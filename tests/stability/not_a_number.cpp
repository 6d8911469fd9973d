// S22: a NaN anywhere in the state is detected at once, and the run continues from the last valid
// state.
#include "components/pair.hpp"
#include "engine/random.hpp"
#include "scenarios/specimens/small_scene.hpp"
#include "tests/stability/cases.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace bris {

namespace {

constexpr unsigned block = 50; // steps
constexpr double none = std::numeric_limits<double>::quiet_NaN();

/// Quantities of the state into which a NaN is inserted in turn.
constexpr std::array columns{"position", "velocity", "angular momentum", "spring"};

/// Inserts a NaN into a quantity of a body, or of a random contact.
void hit(World& world, std::size_t column, EntityId body, Random& random) {
    const auto axis = static_cast<Eigen::Index>(random.bits() % 3);
    if (column == 0)
        value_of<Position>(world, body)[axis] = none;
    else if (column == 1)
        value_of<Velocity>(world, body)[axis] = none;
    else if (column == 2)
        value_of<AngularMomentum>(world, body)[axis] = none;
    else {
        const auto spring = world.column<SpherePairs, Spring>();
        std::vector<std::size_t> stretched;
        for (std::size_t k = 0; k < spring.size(); ++k)
            if (Spring::keep(spring[k])) stretched.push_back(k);
        if (!stretched.empty())
            spring[stretched[random.bits() % stretched.size()]].x = none;
        else
            value_of<Position>(world, body)[axis] = none;
    }
}

/// Whether no NaN is left: a spring whose pair separates in the next step is discarded unread.
bool all_finite(const World& world) {
    const Table& bodies = world.table<Bodies>();
    for (Row b = 0; b < bodies.size(); ++b)
        if (!bodies.column<Position>()[b].allFinite() ||
            !bodies.column<Velocity>()[b].allFinite() ||
            !bodies.column<AngularMomentum>()[b].allFinite())
            return false;
    return std::ranges::all_of(world.column<SpherePairs, Spring>(),
                               [](const SpringRow& s) { return std::isfinite(s.x + s.y + s.z); });
}

struct Outcome {
    unsigned discarded = 0, caught = 0, named = 0, recovered = 0, tries = 0;
};

void attack(const Tumble& scene, std::size_t column, std::uint64_t draw, Outcome& o) {
    Random random(scene.seed, 2200 + draw);
    Simulation simulation = begin(tumbling(scene), {.dt = 2e-5, .law = LawName::linear_viscous});
    simulation.advance(300 + random.bits() % 600);
    const Archive good = simulation.snapshot();
    simulation.advance(block);
    const auto expected = fingerprint(simulation.snapshot());
    simulation.restore(good);
    simulation.advance(1); // so that lists exist when the NaN is inserted
    const auto body = static_cast<EntityId>(random.bits() % scene.bodies);
    hit(simulation.world(), column, body, random);
    const std::string message = refusal_of([&] { simulation.advance(block); });
    ++o.tries;
    o.discarded += message.empty() && all_finite(simulation.world()) ? 1u : 0u;
    o.caught += message.empty() ? 0u : 1u;
    const auto says = [&](const char* word) { return message.find(word) != std::string::npos; };
    o.named += (says("body ") || says("bodies ")) && says("step") ? 1u : 0u;
    simulation.restore(good);
    simulation.advance(block);
    o.recovered += fingerprint(simulation.snapshot()) == expected ? 1u : 0u;
}

} // namespace

StressRows stress_not_a_number(const StressSettings& s) {
    StressRows rows;
    const unsigned tries = s.full ? 100 : 6;
    for (const Grains grains : {Grains::spheres, Grains::clumps})
        for (std::size_t column = 0; column < columns.size(); ++column) {
            const Tumble scene{
                .grains = grains, .bodies = grains == Grains::spheres ? 60u : 20u, .seed = s.seed};
            Outcome o;
            for (unsigned k = 0; k < tries; ++k) attack(scene, column, k, o);
            const char* what = grains == Grains::spheres ? "spheres" : "clumps";
            rows.push_back(
                {"S22", fmt::format("{}: NaN in a {}", what, columns[column]),
                 fmt::format("detected within {} steps with the body's name, or discarded with its "
                             "contact",
                             block),
                 fmt::format("{} of {} detected, {} with name, {} discarded", o.caught, o.tries,
                             o.named, o.discarded),
                 o.caught + o.discarded == tries && o.named == o.caught && o.caught > 0});
            rows.push_back({"S22", fmt::format("{}: continued from the snapshot before it", what),
                            "same hash as an undisturbed run",
                            fmt::format("{} of {}", o.recovered, o.tries), o.recovered == tries});
        }
    return rows;
}

} // namespace bris
