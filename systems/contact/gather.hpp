#pragma once

#include "components/body.hpp"
#include "components/kinds.hpp"
#include "components/pair.hpp"
#include "engine/lanes.hpp"
#include "engine/rows.hpp"

namespace bris {

namespace detail {

struct Wrench {
    Quad force{}, torque{};
    // a record of a pair that does not touch is all zero, and adding +0 changes no bit of a sum
    // that began with +0
    void add(const ForceRow& record, Quad centre, double sign) {
        const Quad f = sign * load(&record.fx);
        force += f;
        torque += cross(load(&record.px) - centre, f);
    }
};

} // namespace detail

/// Adds the forces of the pairs of one kind to their bodies, boundaries included, and their torques
/// about the centre of mass. Each body sums its own records: first those in which it is the
/// partner, then those it owns, each by ascending id of the other; so the bits depend on nothing
/// but the state.
template <class Pairs>
void gather(Rows<Bodies, const Position, Force, Torque> bodies,
            Rows<typename Pairs::Near, const PairForce> near, const NearIndex<Pairs>& index) {
    if (index.size() == 0) return;
    const Vec3* position = bodies.template column<Position>();
    Vec3* force = bodies.template column<Force>();
    Vec3* torque = bodies.template column<Torque>();
    const ForceRow* record = near.template column<PairForce>();
    for (Row b = bodies.first(); b < bodies.last(); ++b) {
        const Row incident = index.incident_first[b], incident_end = index.incident_first[b + 1];
        const Row owned = index.owned_first[b], owned_end = index.owned_first[b + 1];
        if (incident == incident_end && owned == owned_end) continue;
        const Vec3& x = position[b];
        const Quad centre{x.x(), x.y(), x.z(), 0};
        detail::Wrench sum;
        for (Row k = incident; k < incident_end; ++k) sum.add(record[index.incident[k]], centre, -1);
        for (Row k = owned; k < owned_end; ++k) sum.add(record[k], centre, 1);
        force[b] += Vec3(sum.force[0], sum.force[1], sum.force[2]);
        torque[b] += Vec3(sum.torque[0], sum.torque[1], sum.torque[2]);
    }
}

} // namespace bris
