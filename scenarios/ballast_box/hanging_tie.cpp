#include "scenarios/ballast_box/hanging_tie.hpp"

#include "components/body.hpp"
#include "components/kinds.hpp"
#include "components/settings.hpp"
#include "scenarios/ballast_box/box_scene.hpp"
#include "scenarios/specimens/facet_bodies.hpp"
#include "scenarios/specimens/scene.hpp"
#include "systems/broadphase/lists.hpp"

#include <cmath>

namespace bris {

void hang_tie(World& world, const RailOnTies& rails, double share, double gap) {
    constexpr double damping_ratio = 0.1;
    const EntityId tie = world.resource<BoxBodies>().ties.front();
    const double stiffness = share * rails.stiffness_without_tie(),
                 mass = value_of<Mass>(world, tie);
    Vec3 at = value_of<Position>(world, tie);
    at.z() += gap;
    release(world, tie, at);
    Load& load = world.resource<Loads>().of_body[value_of<LoadOf>(world, tie) - 1].front();
    load.history = {.mean = -weight_of_tie(world)};
    const Vec3 point = value_of<Orientation>(world, tie) * load.point;
    add_patch(world, tie,
              {.point = load.point,
               .anchor = at + point,
               .stiffness = stiffness,
               .damping = 2 * damping_ratio * std::sqrt(stiffness * mass)});
    invalidate_lists(world);
}

LoadHistory passing_load_of_hanging_tie(const Train& train, double speed, const RailOnTies& rails,
                                        double dead_load, double weight) {
    constexpr double deep = 1; // m, a gap that no rail closes
    TrackRail rail = rails.rail(dead_load, deep);
    const std::size_t middle = rails.ties_on_each_side();
    const double at_rest = rail.under({}).at_ties[middle],
                 stiffness = rails.stiffness_without_tie();
    return history_of_passage(train, speed, rails, [&](std::span<const RailLoad> axles) {
        return stiffness * (rail.under(axles).at_ties[middle] - at_rest) - weight;
    });
}

double weight_of_tie(const World& world) {
    const Row tie = row_of_body(world, world.resource<BoxBodies>().ties.front());
    return -world.column<Bodies, Mass>()[tie] * world.resource<Gravity>().value.z();
}

} // namespace bris
