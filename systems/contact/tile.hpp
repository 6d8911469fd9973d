#pragma once

#include "components/body.hpp"
#include "components/material.hpp"
#include "components/pair.hpp"
#include "components/sphere.hpp"
#include "engine/clock.hpp"
#include "engine/prefetch.hpp"
#include "engine/rows.hpp"
#include "systems/contact/columns_of_law.hpp"

#include <vector>

namespace bris::detail {

/// Coefficients, springs and records that the kernels of all kinds of pairs read and write. Null:
/// the law or the scene has none.
struct TileTarget {
    const NearEntry* near;
    SpringRow* spring;
    RollRow* roll;
    ForceRow* force;
    TorqueRow* torque;
    WorkRow* work;
    const double* share; ///< by near row, where patches share one stiffness
    const LawRow* laws;
    const RollingRow* rolling_laws;
    const OwnRow* own; ///< coefficients that only this law reads, by pair of materials
    bool one_law;      ///< all pairs have the coefficients of laws[0]
    LawStep step;

    /// Prefetches the rows that the contacts of these near rows write.
    void prefetch_rows(const Row* rows) const {
        for (int q = 0; q < lane_count; ++q) prefetch<true>(&force[rows[q]]);
        if (spring != nullptr)
            for (int q = 0; q < lane_count; ++q) prefetch<true>(&spring[near[rows[q]].pair]);
        if (roll != nullptr)
            for (int q = 0; q < lane_count; ++q) prefetch<true>(&roll[near[rows[q]].pair]);
    }
};

template <class C, class K, class... Cs>
auto* column_or_null(const Rows<K, Cs...>& rows) {
    using Value =
        std::conditional_t<std::is_const_v<C>, const typename C::Value, typename C::Value>;
    if constexpr ((std::is_same_v<Cs, C> || ...))
        return rows.template column<std::remove_const_t<C>>();
    else
        return static_cast<Value*>(nullptr);
}

template <class Law, class NearRows, class PairRowsOf>
TileTarget target_of(const NearRows& near, const PairRowsOf& pairs, const Materials& materials,
                     const Clock& clock) {
    WorkRow* work = column_or_null<PairWork>(near);
    const auto& laws = Law::Normal::rows(materials);
    return {near.template column<NearPair>(),
            column_or_null<Spring>(pairs),
            column_or_null<Roll>(pairs),
            near.template column<PairForce>(),
            column_or_null<PairTorque>(near),
            work,
            column_or_null<const PatchShare>(near),
            laws.data(),
            materials.rolling_pairs.data(),
            materials.own_pairs.data(),
            laws.size() == 1,
            {materials.policy, clock.dt, work != nullptr}};
}

using ListedSpheres = Rows<Listed, const ListedPosition, const ListedBody>;
template <class Law>
using MovingBodies = std::conditional_t<Law::has_dashpots,
                                        Rows<Bodies, const RigidMotion, const CentreOf, const Kick>,
                                        Rows<Bodies, const RigidMotion, const CentreOf>>;

/// Columns that contacts read: of spheres, by slot, and of their bodies.
struct Movers {
    const SphereRow* sphere_row;
    const Row* body;         ///< null if every sphere is a body, so that slots are rows of bodies
    const MotionRow* motion; ///< by body
    const CentreRow* centre; ///< by body; null if every sphere lies in the centre of its body
    const KickRow* kick;     ///< null if the law has no dashpots
    template <class MovingRows, class Pairs>
    Movers(const ListedSpheres& listed, const MovingRows& bodies, const NearIndex<Pairs>& index)
        : sphere_row(listed.column<ListedPosition>()),
          body(index.centred ? nullptr : listed.column<ListedBody>()),
          motion(bodies.template column<RigidMotion>()),
          centre(index.centred ? nullptr : bodies.template column<CentreOf>()),
          kick(kick_of(bodies)) {}
    std::size_t body_of(std::size_t slot) const { return body == nullptr ? slot : body[slot]; }
    /// Prefetches what contacts read of the bodies of these spheres, except positions of spheres.
    void prefetch_rows(const std::array<std::size_t, lane_count>& slots) const {
        std::array<std::size_t, lane_count> bodies;
        for (std::size_t q = 0; q < lane_count; ++q) bodies[q] = body_of(slots[q]);
        for (const std::size_t b : bodies) prefetch(&motion[b]);
        if (kick != nullptr)
            for (const std::size_t b : bodies) prefetch(&kick[b]);
        if (centre != nullptr)
            for (const std::size_t b : bodies) prefetch(&centre[b]);
    }

private:
    template <class... Cs>
    static const KickRow* kick_of(const Rows<Bodies, Cs...>& bodies) {
        if constexpr ((std::is_same_v<Cs, const Kick> || ...))
            return bodies.template column<Kick>();
        else
            return nullptr;
    }
};

inline CoefficientLanes coefficients(const TileTarget& to, const Row* rows) {
    if (to.one_law) {
        const LawRow& k = to.laws[0];
        return {lanes(k.kn),          lanes(k.ks),         lanes(k.friction),
                lanes(k.normal_rate), lanes(k.shear_rate), lanes(k.normal_ratio),
                lanes(k.shear_ratio)};
    }
    const auto first =
        transpose(load_rows([&](int q) { return &to.laws[to.near[rows[q]].law].kn; }));
    const auto remaining =
        transpose(load_rows([&](int q) { return &to.laws[to.near[rows[q]].law].shear_rate; }));
    return {first[0], first[1], first[2], first[3], remaining[0], remaining[1], remaining[2]};
}

inline OwnLanes own_coefficients(const TileTarget& to, const Row* rows) {
    return {transpose(load_rows([&](int q) { return to.own[to.near[rows[q]].law].value; }))};
}

/// Applies the law to `count` contacts, the near rows `rows` (padded to lane_count with valid
/// rows), and writes their springs and records.
template <class Law>
[[gnu::always_inline]] inline void apply_law(const TileTarget& to, const Row* rows, int count,
                                             ContactLanes& c, Lane px, Lane py, Lane pz) {
    if (to.share != nullptr)
        for (int q = 0; q < lane_count; ++q) c.share[q] = to.share[rows[q]];
    std::array<std::size_t, lane_count> pair;
    for (std::size_t q = 0; q < lane_count; ++q) pair[q] = to.near[rows[q]].pair;
    const auto pair_of = [&](int q) { return pair[static_cast<std::size_t>(q)]; };
    SpringLanes spring{};
    RollLanes roll{};
    RollingLanes rolling{};
    if constexpr (Law::has_history) {
        const auto stored = transpose(load_rows([&](int q) { return &to.spring[pair_of(q)].x; }));
        spring = {stored[0], stored[1], stored[2], stored[3]};
    }
    if constexpr (Law::has_rolling) {
        const auto stored = transpose(load_rows([&](int q) { return &to.roll[pair_of(q)].x; }));
        roll = {stored[0], stored[1], stored[2], stored[3]};
        const auto k = transpose(load_rows(
            [&](int q) { return &to.rolling_laws[to.near[rows[q]].law].rolling_friction; }));
        rolling = {k[0], k[1], k[2], k[3]};
    }
    const ForceLanes f = [&] {
        if constexpr (Law::has_reach)
            return Law::force(c, coefficients(to, rows), own_coefficients(to, rows), rolling,
                              to.step, spring, roll);
        else
            return Law::force(c, coefficients(to, rows), rolling, to.step, spring, roll);
    }();
    if constexpr (Law::has_history)
        store_rows(transpose({spring.x, spring.y, spring.z, spring.stiffness}), count,
                   [&](int q) { return &to.spring[pair_of(q)].x; });
    if constexpr (Law::has_rolling) {
        store_rows(transpose({roll.x, roll.y, roll.z, roll.twist}), count,
                   [&](int q) { return &to.roll[pair_of(q)].x; });
        store_rows(transpose({f.torque_x, f.torque_y, f.torque_z, Lane{}}), count,
                   [&](int q) { return &to.torque[rows[q]].x; });
    }
    store_rows(transpose({f.x, f.y, f.z, c.overlap}), count,
               [&](int q) { return &to.force[rows[q]].fx; });
    store_rows(transpose({px, py, pz, f.normal}), count,
               [&](int q) { return &to.force[rows[q]].px; });
    if (to.work != nullptr)
        store_rows(transpose({f.work.friction, f.work.viscous, f.work.rolling, Lane{}}), count,
                   [&](int q) { return &to.work[rows[q]].friction; });
}

/// Whether a law with reach still acts on a near pair whose surfaces are `gap` (m) apart. The
/// spring of the pair records that it has touched, and is kept until the law no longer acts on the
/// pair.
template <class Law>
bool is_held(const TileTarget& to, const NearEntry& near, double gap, double radius) {
    return Spring::keep(to.spring[near.pair]) && gap < Law::reach(to.own[near.law], radius);
}

/// Selects, in each group of eight pairs, those whose contacts have to be evaluated, and restores
/// the springs of sleeping pairs, which must not advance.
template <class Pairs>
class Sleepers {
public:
    Sleepers(const TileTarget& to, const NearIndex<Pairs>& index)
        : to_(to), awake_(index.awake.empty() ? nullptr : index.awake.data()),
          look_(index.look.empty() ? awake_ : index.look.data()) {}

    bool skips(std::size_t group) const { return look_ != nullptr && look_[group / 8] == 0; }
    /// Pairs that count as touching: evaluated pairs that touch `now`, and others as `before`.
    unsigned touching(std::size_t group, unsigned now, unsigned before) const {
        if (look_ == nullptr) return now;
        return (before & ~unsigned{look_[group / 8]}) | (now & look_[group / 8]);
    }
    /// Those of the touching pairs to which the law is applied; keeps the springs of sleeping ones.
    unsigned asked(std::size_t group, unsigned touching) {
        if (look_ == nullptr) return touching;
        touching &= look_[group / 8];
        for (unsigned remaining = touching & ~unsigned{awake_[group / 8]}; remaining != 0;
             remaining &= remaining - 1)
            keep(to_.near[group + static_cast<std::size_t>(__builtin_ctz(remaining))].pair);
        return touching;
    }
    /// Restores the springs of the sleeping pairs.
    void put_springs_back() {
        for (const auto& [pair, spring, roll] : kept_) {
            if (to_.spring != nullptr) to_.spring[pair] = spring;
            if (to_.roll != nullptr) to_.roll[pair] = roll;
        }
    }

private:
    struct Kept {
        Row pair;
        SpringRow spring;
        RollRow roll;
    };
    void keep(Row pair) {
        kept_.push_back({pair, to_.spring == nullptr ? SpringRow{} : to_.spring[pair],
                         to_.roll == nullptr ? RollRow{} : to_.roll[pair]});
    }
    const TileTarget& to_;
    const std::uint8_t *awake_, *look_;
    std::vector<Kept> kept_;
};

/// Clears the springs of those pairs of a group that have separated (bits of `apart`).
inline void forget(const TileTarget& to, Row first, unsigned apart) {
    if (to.spring == nullptr) return;
    for (; apart != 0; apart &= apart - 1) {
        const Row pair = to.near[first + static_cast<Row>(__builtin_ctz(apart))].pair;
        to.spring[pair] = {};
        if (to.roll != nullptr) to.roll[pair] = {};
    }
}

} // namespace bris::detail
