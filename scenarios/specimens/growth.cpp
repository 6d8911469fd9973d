#include "scenarios/specimens/growth.hpp"

#include "components/body.hpp"
#include "components/body_contacts.hpp"
#include "components/kinds.hpp"
#include "components/pair.hpp"
#include "components/sphere.hpp"
#include "engine/ordering.hpp"
#include "scenarios/specimens/specimen.hpp"
#include "systems/broadphase/lists.hpp"

#include <algorithm>

namespace bris {

namespace {

template <class Pairs>
void note_overlaps(const World& world, std::span<double> largest) {
    if (!world.has<Pairs>()) return;
    const BodyContacts<Pairs> contacts(world);
    const auto force = world.column<typename Pairs::Near, PairForce>();
    for (Row b = 0; b < largest.size(); ++b)
        contacts.visit(b,
                       [&](Row k, bool) { largest[b] = std::max(largest[b], force[k].overlap); });
}

} // namespace

std::vector<double> largest_overlaps(const World& world) {
    std::vector<double> largest(world.table<Bodies>().size(), 0.0);
    for_each_kind_of_pair([&]<class Pairs>() { note_overlaps<Pairs>(world, largest); });
    return largest;
}

void resize_rocks(World& world, std::span<const EntityId> rocks) {
    const auto& specimen = world.resource<Specimen>();
    const auto rows = rows_by_id(world.column<Bodies, BodyId>());
    const auto shape = world.column<Bodies, ShapeOf>();
    const auto run = world.column<Bodies, SpheresOf>();
    const auto growth = world.column<Bodies, Growth>();
    const auto ball = world.column<Spheres, LocalBall>();
    for (const EntityId id : rocks) {
        const Row r = rows[id];
        const Clump& clump = specimen.clumps[shape[r]];
        const double size = growth[r] * specimen.scale[id];
        for (Row k = 0; k < run[r].count; ++k)
            ball[run[r].first + k] = {size * clump.balls[k].centre, size * clump.balls[k].radius};
    }
    invalidate_lists(world);
}

bool grow_rocks(World& world, std::span<const EntityId> rocks, std::span<const double> squeezed,
                double factor, double limit) {
    const auto rows = rows_by_id(world.column<Bodies, BodyId>());
    const auto growth = world.column<Bodies, Growth>();
    const auto radius = world.column<Bodies, BoundingRadius>();
    bool all = true, grown = false;
    for (const EntityId id : rocks) {
        const Row r = rows[id];
        if (squeezed[r] < limit * radius[r] && growth[r] < 1) {
            growth[r] = std::min(1.0, growth[r] * factor);
            grown = true;
        }
        all = all && growth[r] == 1;
    }
    if (grown) resize_rocks(world, rocks);
    return all;
}

} // namespace bris
