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

/// Records of one kind of pair. Null: the law, or the scene, has none.
struct Records {
    const ForceRow* force;
    const TorqueRow* torque;
    const WorkRow* work;
};
/// Where the work that pairs take is booked.
struct WorkAccounts { double *friction, *viscous, *rolling; };

/// Sums the records of each body; where there is a ledger, the work of the pairs that it owns too.
template <class Pairs>
void gather_rows(RowRange bodies, const Vec3* position, Vec3* force, Vec3* torque, const Records& records,
                 const NearIndex<Pairs>& index, const WorkAccounts& accounts) {
    for (Row b = bodies.first; b < bodies.last; ++b) {
        // records lie where the owners' pairs lie: the first few of a body to come are called for in time
        if (const Row coming = b + 4; coming < bodies.last)
            for (Row k = 0; k < index.look_ahead; ++k)
                __builtin_prefetch(&records.force[index.contact[index.first_contact(coming) + k] & ~index.as_partner]);
        if (index.first_contact(b) == index.contact_end[b]) continue;
        WrenchSum sum(position[b]);
        Vec3 couple = Vec3::Zero();
        WorkRow work{};
        index.for_contacts_of(b, [&](Row k, bool as_partner) {
            sum.add(records.force[k], as_partner ? -1 : 1);
            if (records.torque != nullptr) {
                const TorqueRow& t = records.torque[k];
                couple += (as_partner ? -1 : 1) * Vec3(t.x, t.y, t.z);
            }
            if (records.work == nullptr || as_partner) return;
            work.friction += records.work[k].friction;
            work.viscous += records.work[k].viscous;
            work.rolling += records.work[k].rolling;
        });
        force[b] += sum.force();
        torque[b] += sum.torque();
        if (records.torque != nullptr) torque[b] += couple;
        if (records.work == nullptr) continue;
        accounts.friction[b] += work.friction;
        accounts.viscous[b] += work.viscous;
        accounts.rolling[b] += work.rolling;
    }
}

template <class Pairs, class BodyRows, class NearRows>
void gather_all(const BodyRows& bodies, const NearRows& near, const NearIndex<Pairs>& index, const TorqueRow* couple,
                const WorkRow* work, const WorkAccounts& accounts) {
    if (index.size() == 0) return;
    gather_rows(RowRange{bodies.first(), bodies.last()}, bodies.template column<Position>(), bodies.template column<Force>(),
                bodies.template column<Torque>(), {near.template column<PairForce>(), couple, work}, index, accounts);
}

} // namespace detail

/// Adds the forces of the pairs of one kind to their bodies, boundaries included, and their torques
/// about the centre of mass. Each body sums its own records, in the order of its contacts. `More`: PairTorque, of
/// laws with resistance to rolling.
template <class Pairs, class... More>
void gather(Rows<Bodies, const Position, Force, Torque> bodies, Rows<typename Pairs::Near, const PairForce, const More...> near,
            const NearIndex<Pairs>& index) {
    const TorqueRow* couple = nullptr;
    if constexpr (sizeof...(More) > 0) couple = near.template column<PairTorque>();
    detail::gather_all<Pairs>(bodies, near, index, couple, nullptr, {});
}

/// The same, and adds the work that the pairs took in this step to their owners.
template <class Pairs, class... More>
void gather_and_book(Rows<Bodies, const Position, Force, Torque, FrictionWork, ViscousWork, RollingWork> bodies,
                     Rows<typename Pairs::Near, const PairForce, const PairWork, const More...> near, const NearIndex<Pairs>& index) {
    const TorqueRow* couple = nullptr;
    if constexpr (sizeof...(More) > 0) couple = near.template column<PairTorque>();
    detail::gather_all<Pairs>(bodies, near, index, couple, near.template column<PairWork>(),
                              {bodies.template column<FrictionWork>(), bodies.template column<ViscousWork>(),
                               bodies.template column<RollingWork>()});
}

} // namespace bris
