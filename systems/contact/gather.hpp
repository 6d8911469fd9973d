#pragma once

#include "components/body.hpp"
#include "components/kinds.hpp"
#include "components/pair.hpp"
#include "engine/lanes.hpp"
#include "engine/rows.hpp"

namespace bris {

namespace detail {

/// Sums force and torque of records about a centre. A record of a pair that does not touch is all
/// zero, and adding +0 changes no bit of a sum that began with +0.
class WrenchSum {
public:
    explicit WrenchSum(const Vec3& centre) : centre_{centre.x(), centre.y(), centre.z(), 0} {}
    void add(const ForceRow& record) {
        const Quad f = load(&record.fx), arm = load(&record.px) - centre_;
        force_ += f;
        turned_torque_ += turned_cross(arm, f);
    }
    /// What was added acts on the partners: rounding is the same for both signs.
    void reverse() {
        force_ = -force_;
        turned_torque_ = -turned_torque_;
    }
    Vec3 force() const { return {force_[0], force_[1], force_[2]}; }
    Vec3 torque() const { return {turned_torque_[1], turned_torque_[2], turned_torque_[0]}; }

private:
    Quad centre_, force_{}, turned_torque_{};
};

/// Sums the records of each body; where there is a ledger, the slip work of the pairs that it owns too.
template <class Pairs>
void gather_rows(RowRange bodies, const Vec3* position, Vec3* force, Vec3* torque, const ForceRow* record,
                 const NearIndex<Pairs>& index, const double* slip, double* friction) {
    for (Row b = bodies.first; b < bodies.last; ++b) {
        const Row incident = index.incident_first[b], incident_end = index.incident_first[b + 1];
        const Row owned = index.owned_first[b], owned_end = index.owned_first[b + 1];
        if (incident == incident_end && owned == owned_end) continue;
        WrenchSum sum(position[b]);
        for (Row k = incident; k < incident_end; ++k) sum.add(record[index.incident[k]]);
        sum.reverse();
        double work = friction != nullptr ? friction[b] : 0;
        for (Row k = owned; k < owned_end; ++k) {
            sum.add(record[k]);
            if (friction != nullptr) work += slip[k];
        }
        force[b] += sum.force();
        torque[b] += sum.torque();
        if (friction != nullptr) friction[b] = work;
    }
}

} // namespace detail

/// Adds the forces of the pairs of one kind to their bodies, boundaries included, and their torques
/// about the centre of mass. Each body sums its own records: first those in which it is the
/// partner, then those it owns, each by ascending id of the other; so the bits depend on nothing
/// but the state.
template <class Pairs>
void gather(Rows<Bodies, const Position, Force, Torque> bodies,
            Rows<typename Pairs::Near, const PairForce> near, const NearIndex<Pairs>& index) {
    if (index.size() == 0) return;
    detail::gather_rows(RowRange{bodies.first(), bodies.last()}, bodies.template column<Position>(),
                        bodies.template column<Force>(), bodies.template column<Torque>(),
                        near.template column<PairForce>(), index, nullptr, nullptr);
}

/// The same, and adds the work that friction took in this step to the owners of the pairs, in their order.
template <class Pairs>
void gather_and_book(Rows<Bodies, const Position, Force, Torque, FrictionWork> bodies,
                     Rows<typename Pairs::Near, const PairForce, const SlipWork> near, const NearIndex<Pairs>& index) {
    if (index.size() == 0) return;
    detail::gather_rows(RowRange{bodies.first(), bodies.last()}, bodies.template column<Position>(),
                        bodies.template column<Force>(), bodies.template column<Torque>(),
                        near.template column<PairForce>(), index, near.template column<SlipWork>(),
                        bodies.template column<FrictionWork>());
}

} // namespace bris
