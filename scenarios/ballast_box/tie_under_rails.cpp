#include "scenarios/ballast_box/tie_under_rails.hpp"

#include "components/body.hpp"
#include "components/kinds.hpp"
#include "components/settings.hpp"
#include "engine/message.hpp"
#include "scenarios/ballast_box/box_balance.hpp"
#include "scenarios/ballast_box/box_scene.hpp"
#include "scenarios/specimens/facet_bodies.hpp"
#include "scenarios/specimens/scene.hpp"
#include "systems/broadphase/lists.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace bris {

namespace {

double damping_above_tie(const RailOnTies& rails, double mass) {
    constexpr double damping_ratio = 0.1;
    return 2 * damping_ratio * std::sqrt(stiffness_above_tie(rails) * mass);
}

} // namespace

double height_of_tie(const World& world) {
    return world
        .column<Bodies, Position>()[row_of_body(world, world.resource<BoxBodies>().ties.front())]
        .z();
}

double stiffness_above_tie(const RailOnTies& rails) {
    return in_series(rails.stiffness_without_tie(), rails.pad);
}

double mass_of_tie(const World& world) {
    return world
        .column<Bodies, Mass>()[row_of_body(world, world.resource<BoxBodies>().ties.front())];
}

void hang_tie(World& world, const RailOnTies& rails, double share, double gap) {
    const EntityId tie = world.resource<BoxBodies>().ties.front();
    const double mass = mass_of_tie(world);
    Vec3 at = value_of<Position>(world, tie);
    at.z() += gap;
    release(world, tie, at);
    Load& load = world.resource<Loads>().of_body[value_of<LoadOf>(world, tie) - 1].front();
    load.history = {.mean = mass * world.resource<Gravity>().value.z()};
    const Vec3 point = value_of<Orientation>(world, tie) * load.point;
    add_patch(world, tie,
              {.point = load.point,
               .anchor = at + point,
               .stiffness = share * stiffness_above_tie(rails),
               .damping = share * damping_above_tie(rails, mass / share)});
    invalidate_lists(world);
}

LoadHistory passing_load_of_hanging_tie(const Train& train, double speed, const RailOnTies& rails,
                                        double of_rails, double mass, double gravity) {
    constexpr double deep = 1; // m, a gap that no rail closes
    TrackRail rail = rails.rail(of_rails, deep);
    const std::size_t middle = rails.ties_on_each_side();
    const double stiffness = stiffness_above_tie(rails), damping = damping_above_tie(rails, mass),
                 at_rest = rail.under({}).at_ties[middle];
    LoadHistory history =
        history_of_passage(train, speed, rails, [&](std::span<const RailLoad> axles) {
            return rail.under(axles).at_ties[middle] - at_rest;
        });
    const std::vector<double> w = history.values;
    for (std::size_t k = 0; k < w.size(); ++k) {
        const std::size_t before = k > 0 ? k - 1 : 0, after = std::min(k + 1, w.size() - 1);
        const double rate = (w[after] - w[before]) / (history.times[after] - history.times[before]);
        history.values[k] = stiffness * w[k] + damping * rate - mass * gravity;
    }
    return history;
}

void note_pressed_tie(World& world) {
    auto& state = world.resource<BoxState>();
    state.pressed_support = box_balance(world).tie_support;
    state.pressed_height = height_of_tie(world);
}

void note_bed_stiffness(World& world, double share) {
    constexpr double softest = 1e6, stiffest = 2e9; // N/m, of any ballast
    auto& state = world.resource<BoxState>();
    const double unloaded = state.pressed_support - box_balance(world).tie_support,
                 rebound = height_of_tie(world) - state.pressed_height,
                 stiffness = unloaded / rebound / share;
    if (stiffness > softest && stiffness < stiffest)
        state.bed_stiffness = stiffness;
    else
        say(fmt::format("stiffness of the bed: not measured, since the tie rose by {:.3g} mm while "
                        "{:.3g} kN were taken off",
                        1e3 * rebound, 1e-3 * unloaded));
    state.pressed_support = 0;
}

} // namespace bris
