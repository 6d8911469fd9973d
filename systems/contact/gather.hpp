#pragma once

#include "components/body.hpp"
#include "components/kinds.hpp"
#include "components/pair.hpp"
#include "engine/lanes.hpp"
#include "engine/rows.hpp"

namespace bris {

namespace detail {

/// Sums force and torque of records about a centre.
class WrenchSum {
public:
    explicit WrenchSum(const Vec3& centre) : centre_{centre.x(), centre.y(), centre.z(), 0} {}
    /// `sign` 1 for the owner, -1 for the partner of the pair.
    void add(const ForceRow& record, double sign) {
        const Quad f = sign * load(&record.fx), arm = load(&record.px) - centre_;
        force_ += f;
        turned_torque_ += turned_cross(arm, f);
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
        // records lie where the owners' pairs lie: the first few of a body to come are called for in time
        if (const Row coming = b + 4; coming < bodies.last)
            for (Row k = 0; k < index.look_ahead; ++k)
                __builtin_prefetch(&record[index.contact[index.first_contact(coming) + k] & ~index.as_partner]);
        if (index.first_contact(b) == index.contact_end[b]) continue;
        WrenchSum sum(position[b]);
        double work = friction != nullptr ? friction[b] : 0;
        index.for_contacts_of(b, [&](Row k, bool as_partner) {
            sum.add(record[k], as_partner ? -1 : 1);
            if (friction != nullptr && !as_partner) work += slip[k];
        });
        force[b] += sum.force();
        torque[b] += sum.torque();
        if (friction != nullptr) friction[b] = work;
    }
}

} // namespace detail

/// Adds the forces of the pairs of one kind to their bodies, boundaries included, and their torques
/// about the centre of mass. Each body sums its own records, in the order of its contacts.
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
