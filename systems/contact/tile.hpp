#pragma once

#include "components/body.hpp"
#include "components/material.hpp"
#include "components/pair.hpp"
#include "components/sphere.hpp"
#include "engine/rows.hpp"
#include "systems/contact/laws/law.hpp"

namespace bris::detail {

/// What the kernels of the three pair kinds share: where the coefficients, springs and records are.
struct TileTarget {
    const NearEntry* near;
    SpringRow* spring; ///< null if the law has no history
    ForceRow* force;
    double* slip_work; ///< null if no ledger is kept
    const LawRow* laws;
    bool one_law; ///< all pairs have the coefficients of laws[0]
    double dt;
};

using ListedSpheres = Rows<Listed, const Place, const ListedBody>;
using MovingBodies = Rows<Bodies, const RigidMotion, const CentreOf>;

/// What contacts read of spheres, by slot, and of their bodies.
struct Movers {
    const PlaceRow* place;
    const Row* body;
    const MotionRow* motion; ///< by body, as the centre
    const CentreRow* centre; ///< null if every sphere stands in the centre of its body
    template <class Pairs>
    Movers(const ListedSpheres& listed, const MovingBodies& bodies, const NearIndex<Pairs>& index)
        : place(listed.column<Place>()), body(listed.column<ListedBody>()), motion(bodies.column<RigidMotion>()),
          centre(index.centred ? nullptr : bodies.column<CentreOf>()) {}
};

/// Where a system's near rows book slip work: null unless its signature has the column.
template <class K, class... Cs> double* ledger_of(const Rows<K, Cs...>& near) {
    if constexpr ((std::is_same_v<Cs, SlipWork> || ...)) return near.template column<SlipWork>();
    else return nullptr;
}

inline CoefficientLanes coefficients(const TileTarget& to, const Row* rows) {
    if (to.one_law) {
        const LawRow& k = to.laws[0];
        return {lanes(k.kn), lanes(k.ks), lanes(k.friction), lanes(k.normal_damping),
                lanes(k.shear_damping)};
    }
    const auto first = transpose(load_rows([&](int q) { return &to.laws[to.near[rows[q]].law].kn; }));
    const auto rest =
        transpose(load_rows([&](int q) { return &to.laws[to.near[rows[q]].law].shear_damping; }));
    return {first[0], first[1], first[2], first[3], rest[0]};
}

/// Applies the law to `count` contacts, the near rows `rows` (padded to lane_count with valid rows),
/// and writes their springs and records.
template <class Law>
void apply_law(const TileTarget& to, const Row* rows, int count, const ContactLanes& c, Lane px,
               Lane py, Lane pz) {
    SpringLanes spring{};
    FourLanes stored;
    if constexpr (Law::has_history) {
        stored = transpose(load_rows([&](int q) { return &to.spring[to.near[rows[q]].pair].x; }));
        spring = {stored[0], stored[1], stored[2]};
    }
    const ForceLanes f = Law::force(c, coefficients(to, rows), to.dt, spring);
    if constexpr (Law::has_history)
        store_rows(transpose({spring.x, spring.y, spring.z, stored[3]}), count,
                   [&](int q) { return &to.spring[to.near[rows[q]].pair].x; });
    store_rows(transpose({f.x, f.y, f.z, c.overlap}), count, [&](int q) { return &to.force[rows[q]].fx; });
    store_rows(transpose({px, py, pz, f.normal}), count, [&](int q) { return &to.force[rows[q]].px; });
    if (to.slip_work != nullptr)
        for (int q = 0; q < count; ++q) to.slip_work[rows[q]] = f.slip_work[q];
}

/// Clears the springs of the pairs of one group that have come apart.
inline void forget(const TileTarget& to, Row first, unsigned apart) {
    if (to.spring == nullptr) return;
    for (; apart != 0; apart &= apart - 1) to.spring[to.near[first + static_cast<Row>(__builtin_ctz(apart))].pair] = {};
}

} // namespace bris::detail
