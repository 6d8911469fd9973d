#pragma once

#include "engine/component.hpp"
#include "engine/entity.hpp"

#include <vector>

namespace bris {

/// Names a pair of surfaces for good: the owning body (of two spheres, the one with the lower id),
/// its partner, and which sphere or facet of each. Pairs of one owner stand in this order.
struct PairNames {
    EntityId owner, partner, sphere,
        feature; ///< sphere: place in the owner's run; feature: place in
                 ///< the partner's run, or the id of a facet or plane
    friend bool operator<(const PairNames& a, const PairNames& b) {
        if (a.owner != b.owner) return a.owner < b.owner;
        if (a.partner != b.partner) return a.partner < b.partner;
        return a.sphere != b.sphere ? a.sphere < b.sphere : a.feature < b.feature;
    }
    friend bool operator==(const PairNames&, const PairNames&) = default;
};
struct PairKey : State<PairNames, std::uint32_t> {
    static constexpr auto name = "key", unit = "";
    static constexpr bool is_key = true;
};

/// Stretch of the tangential spring, world frame, and the tangent stiffness that it was last used
/// with (1 for linear laws). Zero if the pair does not touch, so that being a candidate leaves no
/// trace.
struct alignas(32) SpringRow {
    double x, y, z, stiffness;
};
struct Spring : State<SpringRow> {
    static constexpr auto name = "spring", unit = "m";
    static bool keep(const SpringRow& s) { return s.stiffness != 0; }
};

/// Stretch of the rolling spring, world frame, and of the twisting spring: displacements of the
/// surfaces.
struct alignas(32) RollRow {
    double x, y, z, twist;
};
struct Roll : State<RollRow> {
    static constexpr auto name = "roll", unit = "m";
    static bool keep(const RollRow& r) { return r.x != 0 || r.y != 0 || r.z != 0 || r.twist != 0; }
};

/// Rows behind the names: spheres, or sphere and facet or plane; and the row of the partner body.
struct PairRowNumbers {
    Row sphere, other, partner_body, law;
};
struct PairRows : Derived<PairRowNumbers> {
    static constexpr auto name = "rows", unit = "";
};

/// An entry of the short list: slots in Listed (or a facet's or plane's row), its pair, and which
/// coefficients apply.
struct NearEntry {
    Row owner, other, pair, law;
};
struct NearPair : Derived<NearEntry> {
    static constexpr auto name = "near", unit = "";
};

/// What a pair does to its owner now: force (the partner gets the opposite), overlap, the point
/// where it acts, normal force. Means nothing unless the pair touches.
struct alignas(64) ForceRow {
    double fx, fy, fz, overlap, px, py, pz, normal_force;
};
struct PairForce : Derived<ForceRow> {
    static constexpr auto name = "force", unit = "N, m";
};

/// Share of a near pair in the stiffness of its patch, in (0, 1]; only where patches share one
/// stiffness.
struct PatchShare : Derived<double> {
    static constexpr auto name = "share", unit = "";
};

/// What rolling and twisting resistance do to the owner now (the partner gets the opposite).
struct alignas(32) TorqueRow {
    double x, y, z, unused;
};
struct PairTorque : Derived<TorqueRow> {
    static constexpr auto name = "torque", unit = "N m";
};

/// What a pair takes in this step, only where an energy ledger is kept: sliding friction (and what
/// a Mindlin spring gives up), dashpots, resistance to rolling and twisting.
struct alignas(32) WorkRow {
    double friction, viscous, rolling, unused;
};
struct PairWork : Derived<WorkRow> {
    static constexpr auto name = "work", unit = "J";
};

/// Near rows that one task works on: a multiple of NearIndex::group.
inline constexpr std::size_t near_rows_per_chunk = 1024;

/// Who is near whom, body by body. Near rows of an owner stand together; `incident` lists the near
/// rows in which a body is the partner, by ascending id of the owner.
template <class Pairs>
struct NearIndex {
    static constexpr auto name = Pairs::name;
    static constexpr unsigned group = Pairs::rows_per_flag; ///< near rows a byte of `touching`

    std::vector<Row> owned_first;    ///< bodies + 1
    std::vector<Row> incident_first; ///< bodies + 1
    std::vector<Row> incident;
    bool centred = false; ///< every sphere stands in the centre of its body: single spheres
    std::vector<std::uint8_t> touching; ///< bit k of byte g: near row group * g + k
    std::vector<Row> too_deep;        ///< per chunk, a near row beyond the overlap limit, or no_row
    std::vector<Row> contact;         ///< touching near rows of a body, from first_contact(body) on
    std::vector<Row> contact_end;     ///< bodies
    std::vector<std::uint8_t> listed; ///< `touching` when `contact` was made
    std::vector<std::uint8_t>
        awake; ///< where bodies sleep: pairs that are to be looked at, as `touching`; else empty
    std::vector<std::uint8_t> look; ///< those looked at in this step, where they are not the same:
                                    ///< springs of those that sleep do not move

    std::size_t size() const { return owned_first.empty() ? 0 : owned_first.back(); }
    bool touches(Row near) const { return ((touching[near / group] >> (near % group)) & 1) != 0; }

    /// Calls visit(near row, whether the body is the partner) for the touching pairs of a body:
    /// first those in which it is the partner, then those it owns, each by ascending id of the
    /// other. All sums over a body's contacts go in this order, so their bits depend on nothing but
    /// the state.
    template <class Visit>
    void for_contacts_of(Row body, Visit&& visit) const {
        for (Row k = first_contact(body); k < contact_end[body]; ++k)
            visit(contact[k] & ~as_partner, (contact[k] & as_partner) != 0);
    }

    static constexpr Row as_partner = Row{1} << 31; ///< of an entry of `contact`
    static constexpr Row look_ahead =
        6; ///< entries past those of a body that may be read: of any value
    Row first_contact(Row body) const { return incident_first[body] + owned_first[body]; }
};

} // namespace bris
