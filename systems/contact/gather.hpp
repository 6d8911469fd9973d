#pragma once

#include "components/body.hpp"
#include "components/kinds.hpp"
#include "components/pair.hpp"
#include "engine/lanes.hpp"
#include "engine/prefetch.hpp"
#include "engine/rows.hpp"

namespace bris {

namespace detail {

/// Force and torque about a centre, summed from contact records. It is passed by value, so that the
/// sums stay in registers.
struct Wrench {
    Quad force{}, turned_torque{};

    /// Adds a record. `as_partner` is that bit of an entry of NearIndex::contact, 0 for the owner.
    /// There is no branch, because it would be mispredicted at every body.
    [[gnu::always_inline]] void add(const ForceRow& record, Row as_partner, Quad centre) {
        const Quad f = flipped(load(&record.fx), as_partner), arm = load(&record.px) - centre;
        force += f;
        turned_torque += turned_cross(arm, f);
    }
};

inline void add_to(Vec3& sum, Quad more) {
    sum[0] += more[0];
    sum[1] += more[1];
    sum[2] += more[2];
}

/// Records of one kind of pair. Null: the law or the scene has none.
struct Records {
    const ForceRow* force;
    const TorqueRow* torque;
    const WorkRow* work;
};
/// Columns (J, by body) in which the work dissipated by pairs is accumulated.
struct WorkSums {
    double *friction, *viscous, *rolling;
};

/// Adds the couples and the work of a body's records, which only some laws have.
template <class Pairs>
void gather_more(Row b, Vec3& torque, const Records& records, const NearIndex<Pairs>& index,
                 const WorkSums& work_sums) {
    Vec3 couple = Vec3::Zero();
    WorkRow work{};
    index.for_contacts_of(b, [&](Row k, bool as_partner) {
        if (records.torque != nullptr) {
            const TorqueRow& t = records.torque[k];
            couple += (as_partner ? -1 : 1) * Vec3(t.x, t.y, t.z);
        }
        if (records.work == nullptr || as_partner) return;
        work.friction += records.work[k].friction;
        work.viscous += records.work[k].viscous;
        work.rolling += records.work[k].rolling;
    });
    if (records.torque != nullptr) torque += couple;
    if (records.work == nullptr) return;
    work_sums.friction[b] += work.friction;
    work_sums.viscous[b] += work.viscous;
    work_sums.rolling[b] += work.rolling;
}

/// Sums the records of each body and, with an energy budget, the work of the pairs that it owns.
template <class Pairs>
void gather_rows(RowRange bodies, const Vec3* position, Vec3* force, Vec3* torque,
                 const Records& records, const NearIndex<Pairs>& index, const WorkSums& work_sums) {
    const Row *contact = index.contact.data(), *owned = index.owned_first.data(),
              *incident = index.incident_first.data(), *end = index.contact_end.data();
    const bool more = records.torque != nullptr || records.work != nullptr;
    for (Row b = bodies.first; b < bodies.last; ++b) {
        const Row first = incident[b] + owned[b], last = end[b];
        if (first == last) continue;
        // records are stored in the order of the owners' pairs, so the first few of a later body
        // are prefetched
        if (const Row coming = b + 16; coming < bodies.last)
            for (Row k = 0; k < index.look_ahead; ++k)
                prefetch(&records.force[contact[incident[coming] + owned[coming] + k] &
                                        ~index.as_partner]);
        const Vec3& x = position[b];
        const Quad centre{x[0], x[1], x[2], 0};
        Wrench sum;
        for (Row k = first; k < last; ++k)
            sum.add(records.force[contact[k] & ~index.as_partner], contact[k] & index.as_partner,
                    centre);
        add_to(force[b], sum.force);
        add_to(torque[b],
               __builtin_shufflevector(sum.turned_torque, sum.turned_torque, 1, 2, 0, 3));
        if (more) gather_more(b, torque[b], records, index, work_sums);
    }
}

template <class Pairs, class BodyRows, class NearRows>
void gather_all(const BodyRows& bodies, const NearRows& near, const NearIndex<Pairs>& index,
                const TorqueRow* couple, const WorkRow* work, const WorkSums& work_sums) {
    if (index.size() == 0) return;
    gather_rows(RowRange{bodies.first(), bodies.last()}, bodies.template column<Position>(),
                bodies.template column<Force>(), bodies.template column<Torque>(),
                {near.template column<PairForce>(), couple, work}, index, work_sums);
}

} // namespace detail

/// Adds the forces of the pairs of one kind, and their torques about the centre of mass, to their
/// bodies, including boundaries. Each body sums its own records in the order of its contacts.
/// `More` is PairTorque for laws with resistance to rolling.
template <class Pairs, class... More>
void gather(Rows<Bodies, const Position, Force, Torque> bodies,
            Rows<typename Pairs::Near, const PairForce, const More...> near,
            const NearIndex<Pairs>& index) {
    const TorqueRow* couple = nullptr;
    if constexpr (sizeof...(More) > 0) couple = near.template column<PairTorque>();
    detail::gather_all<Pairs>(bodies, near, index, couple, nullptr, {});
}

/// The same, and adds the work that the pairs dissipated in this step to their owners.
template <class Pairs, class... More>
void gather_and_accumulate_work(
    Rows<Bodies, const Position, Force, Torque, FrictionWork, ViscousWork, RollingWork> bodies,
    Rows<typename Pairs::Near, const PairForce, const PairWork, const More...> near,
    const NearIndex<Pairs>& index) {
    const TorqueRow* couple = nullptr;
    if constexpr (sizeof...(More) > 0) couple = near.template column<PairTorque>();
    detail::gather_all<Pairs>(bodies, near, index, couple, near.template column<PairWork>(),
                              {bodies.template column<FrictionWork>(),
                               bodies.template column<ViscousWork>(),
                               bodies.template column<RollingWork>()});
}

} // namespace bris
