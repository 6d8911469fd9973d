#pragma once

#include "engine/component.hpp"
#include "engine/entity.hpp"

#include <vector>

namespace bris {

/// Permanent name of a pair of surfaces: the body that owns it (of two spheres, the one with the
/// lower id), the partner body, and the sphere or facet of each. The pairs of one owner are sorted
/// in this order.
struct PairNames {
    /// sphere: index in the owner's run of spheres; feature: index in the partner's run, or the id
    /// of a facet or plane.
    EntityId owner, partner, sphere, feature;
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

/// Elongation of the tangential spring in the global frame, and the tangent stiffness with which it
/// was last used (1 for linear laws). Zero if the pair does not touch, so a pair that is only a
/// candidate has no history.
struct alignas(32) SpringRow {
    double x, y, z, stiffness;
};
struct Spring : State<SpringRow> {
    static constexpr auto name = "spring", unit = "m";
    static bool keep(const SpringRow& s) { return s.stiffness != 0; }
};

/// Elongations of the rolling spring, in the global frame, and of the twisting spring, as
/// displacements of the surfaces.
struct alignas(32) RollRow {
    double x, y, z, twist;
};
struct Roll : State<RollRow> {
    static constexpr auto name = "roll", unit = "m";
    static bool keep(const RollRow& r) { return r.x != 0 || r.y != 0 || r.z != 0 || r.twist != 0; }
};

/// Rows that belong to the names: those of the two spheres, or of the sphere and the facet or
/// plane; the row of the partner body; and the row of the law's coefficients.
struct PairRowNumbers {
    Row sphere, other, partner_body, law;
};
struct PairRows : Derived<PairRowNumbers> {
    static constexpr auto name = "rows", unit = "";
};

/// An entry of the short list: the slots in Listed of its spheres (or the row of its facet or
/// plane), the row of its pair, and the row of the law's coefficients.
struct NearEntry {
    Row owner, other, pair, law;
};
struct NearPair : Derived<NearEntry> {
    static constexpr auto name = "near", unit = "";
};

/// Contact force of a pair: force on the owner (the partner receives the opposite), overlap,
/// contact point and normal force. Valid only if the pair touches.
struct alignas(64) ForceRow {
    double fx, fy, fz, overlap, px, py, pz, normal_force;
};
struct PairForce : Derived<ForceRow> {
    static constexpr auto name = "force", unit = "N, m";
};

/// Share of a near pair in the stiffness of its contact patch, in (0, 1]. Exists only where patches
/// share one stiffness.
struct PatchShare : Derived<double> {
    static constexpr auto name = "share", unit = "";
};

/// Torque of rolling and twisting resistance on the owner (the partner receives the opposite).
struct alignas(32) TorqueRow {
    double x, y, z, unused;
};
struct PairTorque : Derived<TorqueRow> {
    static constexpr auto name = "torque", unit = "N m";
};

/// Energy that a pair dissipates in this step: by sliding friction (including what a Mindlin spring
/// loses), by dashpots, and by rolling and twisting resistance. Exists only with an energy budget.
struct alignas(32) WorkRow {
    double friction, viscous, rolling, unused;
};
struct PairWork : Derived<WorkRow> {
    static constexpr auto name = "work", unit = "J";
};

/// Near rows per task: a multiple of NearIndex::group.
inline constexpr std::size_t near_rows_per_chunk = 1024;

/// Index of the near pairs by body. The near rows of an owner are contiguous; `incident` lists the
/// near rows in which a body is the partner, by ascending id of the owner.
template <class Pairs>
struct NearIndex {
    static constexpr auto name = Pairs::name;
    static constexpr unsigned group = Pairs::rows_per_flag; ///< near rows per byte of `touching`

    std::vector<Row> owned_first;    ///< bodies + 1
    std::vector<Row> incident_first; ///< bodies + 1
    std::vector<Row> incident;
    /// True if every sphere is at the centre of its body: scenes of single spheres.
    bool centred = false;
    std::vector<std::uint8_t> touching; ///< bit k of byte g: near row group * g + k
    std::vector<Row> too_deep;        ///< per chunk: a near row beyond the overlap limit, or no_row
    std::vector<Row> contact;         ///< touching near rows of a body, from first_contact(body) on
    std::vector<Row> contact_end;     ///< bodies
    std::vector<std::uint8_t> listed; ///< copy of `touching` from when `contact` was made
    /// Where bodies sleep: bits, ordered as in `touching`, of the pairs with a body that is awake;
    /// otherwise empty.
    std::vector<std::uint8_t> awake;
    /// Bits of the pairs that are computed in this step, where they differ from `awake`: the
    /// springs of sleeping pairs do not change.
    std::vector<std::uint8_t> look;

    std::size_t size() const { return owned_first.empty() ? 0 : owned_first.back(); }
    bool touches(Row near) const { return ((touching[near / group] >> (near % group)) & 1) != 0; }

    /// Calls visit(near row, whether the body is the partner) for the touching pairs of a body:
    /// first the pairs in which it is the partner, then those it owns, each by ascending id of the
    /// other body. All sums over a body's contacts use this order, so that their bits depend on the
    /// state alone.
    template <class Visit>
    void for_contacts_of(Row body, Visit&& visit) const {
        for (Row k = first_contact(body); k < contact_end[body]; ++k)
            visit(contact[k] & ~as_partner, (contact[k] & as_partner) != 0);
    }

    /// Flag in an entry of `contact`: the body is the partner.
    static constexpr Row as_partner = Row{1} << 31;
    /// Entries of `contact` past those of a body that may be read; their values do not matter.
    static constexpr Row look_ahead = 6;
    Row first_contact(Row body) const { return incident_first[body] + owned_first[body]; }
};

} // namespace bris
