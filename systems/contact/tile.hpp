#pragma once

#include "components/body.hpp"
#include "components/force_sums.hpp"
#include "components/material.hpp"
#include "components/pair.hpp"
#include "components/settings.hpp"
#include "components/sphere.hpp"
#include "engine/clock.hpp"
#include "engine/lane_math.hpp"
#include "engine/prefetch.hpp"
#include "engine/rows.hpp"
#include "systems/contact/columns_of_law.hpp"

#include <vector>

namespace bris::detail {

/// Where contacts add the forces on partners: to the sums of these bodies, if they belong to the
/// chunk of the near row as the owners do, or to those that PartnerSum names.
enum class SumsAt { bodies, rows };

/// The sums to which the forces of pairs are added, and their units.
struct SumTarget {
    SumRow* sum;
    const Row* partner;                               ///< row of the partner's sum, by near row
    double per_force, per_torque, per_partner_torque; ///< units per N and N m

    SumTarget(SumRow* sums, const Row* partners, const ForceGrid& grid, bool with_boundary)
        : sum(sums), partner(partners), per_force(1 / grid.force), per_torque(1 / grid.torque),
          per_partner_torque(1 / (with_boundary ? grid.host_torque : grid.torque)) {}
    /// The sum for the partner of a near pair, a body in row `body`, which does not matter for
    /// SumsAt::rows.
    template <SumsAt where>
    SumRow& of_partner(Row near_row, std::size_t body) const {
        return sum[where == SumsAt::bodies ? body : partner[near_row]];
    }
};

/// Rows of the bodies of lane_count contacts: of boundaries any.
struct BodiesOfTile {
    const std::size_t *own, *partner;
};

/// Columns (J, by body) in which owners accumulate the work that their pairs dissipate. Null: there
/// is no energy budget.
struct WorkTarget {
    double *friction = nullptr, *viscous = nullptr, *rolling = nullptr, *wear = nullptr;
};

/// Coefficients and springs that the kernels of all kinds of pairs read and write. Null: the law or
/// the scene has none.
struct TileTarget {
    const NearEntry* near;
    PairHistory history;
    ForceRow* force;
    const double* share; ///< by near row, where patches share one stiffness
    const LawRow* laws;
    const RollingRow* rolling_laws;
    const EdgeRow* edges;
    const OwnRow* own; ///< coefficients that only this law reads, by pair of materials
    bool one_law;      ///< all pairs have the coefficients of laws[0]
    bool observed;     ///< the records of forces are written
    SumTarget sums;
    WorkTarget work;
    LawStep step;

    /// Prefetches the rows that the contacts of these near rows write.
    template <SumsAt where>
    void prefetch_rows(const Row* rows, const BodiesOfTile& bodies) const {
        for (int q = 0; q < lane_count; ++q) prefetch<true>(&sums.sum[bodies.own[q]]);
        for (int q = 0; q < lane_count; ++q)
            prefetch<true>(&sums.of_partner<where>(rows[q], bodies.partner[q]));
        if (history.spring != nullptr)
            for (int q = 0; q < lane_count; ++q)
                prefetch<true>(&history.spring[near[rows[q]].pair]);
        if (history.roll != nullptr)
            for (int q = 0; q < lane_count; ++q) prefetch<true>(&history.roll[near[rows[q]].pair]);
        if (history.worn != nullptr)
            for (int q = 0; q < lane_count; ++q) prefetch<true>(&history.worn[near[rows[q]].pair]);
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

/// Resources that the systems of all kinds of pairs share.
struct ContactScene {
    Rows<ForceSums, ContactSum> sums;
    const ForceGrid& grid;
    const Materials& materials;
    const Limits& limits;
    const Observation& observation;
    const Clock& clock;
};

template <class Law, class NearRows, class PairRowsOf, class BodyRows>
TileTarget target_of(const NearRows& near, const PairRowsOf& pairs, const BodyRows& bodies,
                     const ContactScene& scene) {
    const auto& laws = Law::Normal::rows(scene.materials);
    const WorkTarget work{column_or_null<FrictionWork>(bodies), column_or_null<ViscousWork>(bodies),
                          column_or_null<RollingWork>(bodies), column_or_null<WearWork>(bodies)};
    return {
        near.template column<NearPair>(),
        {column_or_null<Spring>(pairs), column_or_null<Roll>(pairs), column_or_null<Worn>(pairs)},
        near.template column<PairForce>(),
        column_or_null<const PatchShare>(near),
        laws.data(),
        scene.materials.rolling_pairs.data(),
        scene.materials.edge_pairs.data(),
        scene.materials.own_pairs.data(),
        laws.size() == 1,
        scene.observation.due,
        {scene.sums.column<ContactSum>(), near.template column<PartnerSum>(), scene.grid,
         !std::is_same_v<typename NearRows::TableKind, NearSpheres>},
        work,
        {scene.materials.policy, scene.clock.dt, work.friction != nullptr}};
}

using ListedSpheres = Rows<Listed, const ListedPosition, const ListedBody>;
template <class Law, class... Work>
using MovingBodies =
    std::conditional_t<Law::has_dashpots,
                       Rows<Bodies, const RigidMotion, const CentreOf, const Kick, Work...>,
                       Rows<Bodies, const RigidMotion, const CentreOf, Work...>>;

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
    /// Rows of the bodies of the spheres that slot_of(0) to slot_of(lane_count - 1) name.
    template <class SlotOf>
    std::array<std::size_t, lane_count> bodies_of(SlotOf&& slot_of) const {
        std::array<std::size_t, lane_count> bodies;
        for (std::size_t q = 0; q < lane_count; ++q) bodies[q] = body_of(slot_of(q));
        return bodies;
    }
    /// Prefetches what contacts read of a body, except positions of its spheres.
    void prefetch_row(std::size_t b) const {
        prefetch(&motion[b]);
        if (kick != nullptr) prefetch(&kick[b]);
        if (centre != nullptr) prefetch(&centre[b]);
    }
    /// The same of several bodies.
    void prefetch_rows(const std::array<std::size_t, lane_count>& bodies) const {
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

/// Whether the near rows have the coefficients of the same pair of materials, as most tiles do.
[[gnu::always_inline]] inline bool have_one_law(const TileTarget& to, const Row* rows) {
    if (to.one_law) return true;
    const Row first = to.near[rows[0]].law;
    Row different = 0;
    for (int q = 1; q < lane_count; ++q) different |= to.near[rows[q]].law ^ first;
    return different == 0;
}

[[gnu::always_inline]] inline CoefficientLanes coefficients(const TileTarget& to, const Row* rows) {
    if (have_one_law(to, rows)) {
        const LawRow& k = to.laws[to.one_law ? 0 : to.near[rows[0]].law];
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

[[gnu::always_inline]] inline EdgeLanes edge_coefficients(const TileTarget& to, const Row* rows) {
    if (have_one_law(to, rows)) {
        const EdgeRow& e = to.edges[to.one_law ? 0 : to.near[rows[0]].law];
        return {lanes(e.yield_ratio), lanes(e.blunting),        lanes(e.radius),
                lanes(e.rise),        lanes(e.easing_pressure), lanes(e.easing_force),
                lanes(e.arm),         lanes(e.couple_easing)};
    }
    const auto four_from = [&](auto member) {
        return transpose(
            load_rows([&](int q) { return &(to.edges[to.near[rows[q]].law].*member); }));
    };
    const auto first = four_from(&EdgeRow::yield_ratio),
               second = four_from(&EdgeRow::easing_pressure);
    return {first[0], first[1], first[2], first[3], second[0], second[1], second[2], second[3]};
}

[[gnu::always_inline]] inline OwnLanes own_coefficients(const TileTarget& to, const Row* rows) {
    return {transpose(load_rows([&](int q) { return to.own[to.near[rows[q]].law].value; }))};
}

inline Lane size_of(const Vec3Lanes& v) { return magnitude(v.x) + magnitude(v.y) + magnitude(v.z); }

/// What contacts add to the sums of their bodies, in units of the grid: to the owner force and
/// torque, to the partner the opposite force and torque.
class UnitLanes {
public:
    [[gnu::always_inline]] UnitLanes(const Vec3Lanes& force, const Vec3Lanes& own_torque,
                                     const Vec3Lanes& partner_torque)
        : force_(force), own_(own_torque), partner_(partner_torque),
          size_(size_of(force) + (size_of(own_torque) + size_of(partner_torque))) {}

    /// Bits of the lanes that the grid cannot hold or that are not numbers.
    [[gnu::always_inline]] unsigned beyond() const {
        return ~bits(size_ <= ForceGrid::largest) & all_lanes;
    }
    /// They move nobody in the step in which they stop the run.
    void drop_beyond() {
        const LaneMask held = size_ <= ForceGrid::largest;
        const Vec3Lanes none{};
        force_ = select(held, force_, none);
        own_ = select(held, own_, none);
        partner_ = select(held, partner_, none);
        size_ = held ? size_ : Lane{};
    }
    /// Adds the first `count` lanes. `rows`: near rows.
    template <SumsAt where>
    [[gnu::always_inline]] void add(const SumTarget& to, const Row* rows,
                                    const BodiesOfTile& bodies, int count) const {
        const auto integers = [](const Vec3Lanes& v, const Lane& fourth) {
            const auto of = [](const Lane& a) {
                return reinterpret_cast<Lane>(nearest_integers(a));
            };
            return transpose({of(v.x), of(v.y), of(v.z), fourth});
        };
        // the low bits of a number from 2^52 to 2^53 are an integer, and so are those of sums
        const Lane size = size_ * (1 / SumRow::size_unit) + 0x1p52;
        const auto minus_size =
            reinterpret_cast<Lane>(BitsOfLane{} - reinterpret_cast<BitsOfLane>(size));
        const FourLanes forces = integers(force_, Lane{});
        const FourLanes own = integers(own_, size), partner = integers(partner_, minus_size);
        add_integer_rows<false>(forces, own, count,
                                [&](int q) { return &to.sum[bodies.own[q]].fx; });
        add_integer_rows<true>(forces, partner, count, [&](int q) {
            return &to.template of_partner<where>(rows[q], bodies.partner[q]).fx;
        });
    }

private:
    Vec3Lanes force_, own_, partner_;
    Lane size_; ///< sums of the magnitudes
};

/// Contact points, and the lever arms to them from the centres of mass of both bodies (m).
struct Levers {
    Vec3Lanes point, own, partner;

    const Vec3Lanes& contact_point() const { return point; }
    [[gnu::always_inline]] UnitLanes units(const SumTarget& to, const ForceLanes& f) const {
        const Vec3Lanes force{f.x, f.y, f.z}, couple{f.torque_x, f.torque_y, f.torque_z};
        return {to.per_force * force, to.per_torque * (cross(own, force) + couple),
                to.per_partner_torque * (cross(partner, force) + couple)};
    }
};

/// Writes the records of `count` contacts, for readers outside the step.
inline void record(const TileTarget& to, const Row* rows, int count, const ForceLanes& f,
                   const Lane& overlap, const Vec3Lanes& point) {
    store_rows(transpose({f.x, f.y, f.z, overlap}), count,
               [&](int q) { return &to.force[rows[q]].fx; });
    store_rows(transpose({point.x, point.y, point.z, f.normal}), count,
               [&](int q) { return &to.force[rows[q]].px; });
}

inline void add_work(const WorkTarget& to, const std::size_t* own, int count, const WorkLanes& work,
                     unsigned left_out) {
    for (int q = 0; q < count; ++q) {
        if ((left_out >> q) & 1) continue;
        to.friction[own[q]] += work.friction[q];
        to.viscous[own[q]] += work.viscous[q];
        to.rolling[own[q]] += work.rolling[q];
        if (to.wear != nullptr) to.wear[own[q]] += work.wear[q];
    }
}

/// Does nothing with the forces of a tile.
struct NoReader {
    void operator()(const Row*, int, const ForceLanes&, unsigned) const {}
};

/// Applies the law to `count` contacts, the near rows `rows` (padded to lane_count with valid
/// rows), advances their springs and adds their forces to both bodies by `arms` (Levers).
/// `too_deep`: bits of the contacts beyond the limit of overlap. `reader` is
/// then called with the near rows, their number, their forces, and the bits of those whose force is
/// beyond the grid and was not added. Returns these bits and those of the contacts beyond the
/// limit.
template <class Law, SumsAt where = SumsAt::rows, class Arms, class Reader = NoReader>
[[gnu::always_inline]] inline unsigned
apply_law(const TileTarget& to, const Row* rows, const BodiesOfTile& bodies, int count,
          ContactLanes& c, const Arms& arms, LaneMask too_deep, const Reader& reader = {}) {
    if (to.share != nullptr) {
        alignas(64) std::array<double, lane_count> share;
        for (std::size_t q = 0; q < lane_count; ++q) share[q] = to.share[rows[q]];
        c.share = load_lane(share.data());
    }
    std::array<std::size_t, lane_count> pair;
    for (std::size_t q = 0; q < lane_count; ++q) pair[q] = to.near[rows[q]].pair;
    const auto pair_of = [&](int q) { return pair[static_cast<std::size_t>(q)]; };
    SpringLanes spring{};
    RollLanes roll{};
    RollingLanes rolling{};
    Lane worn{};
    if constexpr (Law::has_history) {
        const auto stored =
            transpose(load_rows([&](int q) { return &to.history.spring[pair_of(q)].x; }));
        spring = {stored[0], stored[1], stored[2], stored[3]};
    }
    if constexpr (Law::has_rolling) {
        const auto stored =
            transpose(load_rows([&](int q) { return &to.history.roll[pair_of(q)].x; }));
        roll = {stored[0], stored[1], stored[2], stored[3]};
        const auto k = transpose(load_rows(
            [&](int q) { return &to.rolling_laws[to.near[rows[q]].law].rolling_friction; }));
        rolling = {k[0], k[1], k[2], k[3]};
    }
    if constexpr (Law::has_wear) {
        alignas(64) std::array<double, lane_count> radius;
        for (std::size_t q = 0; q < lane_count; ++q) radius[q] = to.history.worn[pair[q]];
        worn = load_lane(radius.data());
    }
    const ForceLanes f = [&]() __attribute__((always_inline)) {
        CoefficientLanes k = coefficients(to, rows);
        if constexpr (Law::has_edges) k.edges = edge_coefficients(to, rows);
        if constexpr (Law::has_wear)
            return Law::force(c, k, rolling, to.step, spring, roll, worn);
        else if constexpr (Law::has_reach)
            return Law::force(c, k, own_coefficients(to, rows), rolling, to.step, spring, roll);
        else
            return Law::force(c, k, rolling, to.step, spring, roll);
    }
    ();
    if constexpr (Law::has_wear)
        for (std::size_t q = 0; q < static_cast<std::size_t>(count); ++q)
            to.history.worn[pair[q]] = worn[q];
    if constexpr (Law::has_history)
        store_rows(transpose({spring.x, spring.y, spring.z, spring.stiffness}), count,
                   [&](int q) { return &to.history.spring[pair_of(q)].x; });
    if constexpr (Law::has_rolling)
        store_rows(transpose({roll.x, roll.y, roll.z, roll.twist}), count,
                   [&](int q) { return &to.history.roll[pair_of(q)].x; });
    UnitLanes units = arms.units(to.sums, f);
    const unsigned left_out = units.beyond(), beyond = bits(too_deep) | left_out;
    if (to.observed || beyond != 0) {
        record(to, rows, count, f, c.overlap, arms.contact_point());
        if (left_out != 0) units.drop_beyond();
    }
    units.template add<where>(to.sums, rows, bodies, count);
    if (to.work.friction != nullptr) add_work(to.work, bodies.own, count, f.work, left_out);
    reader(rows, count, f, left_out);
    return beyond & ((1u << count) - 1);
}

/// Whether a law with reach still acts on a near pair whose surfaces are `gap` (m) apart. The
/// spring of the pair records that it has touched, and is kept until the law no longer acts on the
/// pair.
template <class Law>
bool is_held(const TileTarget& to, const NearEntry& near, double gap, double radius) {
    return Spring::keep(to.history.spring[near.pair]) && gap < Law::reach(to.own[near.law], radius);
}

/// Selects, in each group of eight pairs, those whose contacts have to be evaluated, and restores
/// the springs of sleeping pairs, which must not advance.
class Sleepers {
public:
    /// `awake`, `look`: flags of a chunk; null where no body can sleep. In observed steps all pairs
    /// are evaluated.
    Sleepers(const TileTarget& to, const std::uint8_t* awake, const std::uint8_t* look)
        : to_(to), awake_(awake), look_(to.observed ? nullptr : look) {}

    bool skips(std::size_t group) const { return look_ != nullptr && look_[group] == 0; }
    /// Pairs that count as touching: evaluated pairs that touch `now`, and others as `before`.
    unsigned touching(std::size_t group, unsigned now, unsigned before) const {
        if (look_ == nullptr) return now;
        return (before & ~unsigned{look_[group]}) | (now & look_[group]);
    }
    /// Those of the touching pairs to which the law is applied; keeps the springs of sleeping ones.
    /// `first`: near row of the group's first pair.
    unsigned asked(std::size_t group, Row first, unsigned touching) {
        if (awake_ == nullptr) return touching;
        if (look_ != nullptr) touching &= look_[group];
        for (unsigned remaining = touching & ~unsigned{awake_[group]}; remaining != 0;
             remaining &= remaining - 1)
            keep(to_.near[first + static_cast<Row>(__builtin_ctz(remaining))].pair);
        return touching;
    }
    /// Restores the springs of the sleeping pairs.
    void put_springs_back() {
        const PairHistory& to = to_.history;
        for (const auto& [pair, spring, roll, worn] : kept_) {
            if (to.spring != nullptr) to.spring[pair] = spring;
            if (to.roll != nullptr) to.roll[pair] = roll;
            if (to.worn != nullptr) to.worn[pair] = worn;
        }
        kept_.clear();
    }

private:
    struct Kept {
        Row pair;
        SpringRow spring;
        RollRow roll;
        double worn;
    };
    void keep(Row pair) {
        const PairHistory& of = to_.history;
        kept_.push_back({pair, of.spring == nullptr ? SpringRow{} : of.spring[pair],
                         of.roll == nullptr ? RollRow{} : of.roll[pair],
                         of.worn == nullptr ? 0 : of.worn[pair]});
    }
    const TileTarget& to_;
    const std::uint8_t *awake_, *look_;
    std::vector<Kept> kept_;
};

/// Clears the history of those pairs of a group that have separated (bits of `apart`).
inline void forget(const TileTarget& to, Row first, unsigned apart) {
    if (to.history.spring == nullptr) return;
    for (; apart != 0; apart &= apart - 1)
        to.history.clear(to.near[first + static_cast<Row>(__builtin_ctz(apart))].pair);
}

/// Pairs that have separated in the last step and are evaluated once more, only for the work that
/// their springs lose. Their springs are cleared afterwards.
class Separated {
public:
    void add(Row pair) { pairs_.push_back(pair); }
    void clear_springs(const TileTarget& to) {
        for (const Row pair : pairs_) to.history.clear(pair);
        pairs_.clear();
    }

private:
    std::vector<Row> pairs_; ///< allocates only with an energy budget
};

} // namespace bris::detail
