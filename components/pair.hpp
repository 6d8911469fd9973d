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

/// Radius (m) of an edge that has yielded; 0: the edge is as the material has it.
struct Worn : State<double> {
    static constexpr auto name = "worn", unit = "m";
    static bool keep(double radius) { return radius > 0; }
    /// In place of a radius: the contact has no edges that yield.
    static constexpr double never = -1;
};

/// What the pairs of one table remember. Null: the law has no such history.
struct PairHistory {
    SpringRow* spring = nullptr;
    RollRow* roll = nullptr;
    double* worn = nullptr;

    bool is_kept(Row pair) const {
        return (spring != nullptr && Spring::keep(spring[pair])) ||
               (worn != nullptr && Worn::keep(worn[pair]));
    }
    void move(Row from, Row to) const {
        if (spring != nullptr) spring[to] = spring[from];
        if (roll != nullptr) roll[to] = roll[from];
        if (worn != nullptr) worn[to] = worn[from];
        clear(from);
    }
    void clear(Row pair) const {
        if (spring != nullptr) spring[pair] = {};
        if (roll != nullptr) roll[pair] = {};
        if (worn != nullptr) worn[pair] = 0;
    }
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
/// contact point and normal force. Valid only if the pair touches, and only after steps in which
/// Observation is due.
struct alignas(64) ForceRow {
    double fx, fy, fz, overlap, px, py, pz, normal_force;
};
struct PairForce : Derived<ForceRow> {
    static constexpr auto name = "force", unit = "N, m";
    static constexpr bool is_scratch = true;
};

/// Share of a near pair in the stiffness of its contact patch, in (0, 1]. Exists only where patches
/// share one stiffness.
struct PatchShare : Derived<double> {
    static constexpr auto name = "share", unit = "";
};

/// Row of ForceSums to which the force on the partner of a near pair is added.
struct PartnerSum : Derived<Row> {
    static constexpr auto name = "partner_sum", unit = "";
};

/// The near rows of consecutive bodies, which one thread computes at a time.
struct NearChunk {
    Row first_body, last_body, first, last; ///< of bodies and of near rows; half-open
    std::size_t first_flags;                ///< first byte of `touching`
    std::size_t first_across, last_across;  ///< of `across`
};

/// Index of the near pairs by owner. The near rows of an owner are contiguous.
template <class Pairs>
struct NearIndex {
    static constexpr auto name = Pairs::name;
    static constexpr unsigned group = Pairs::rows_per_flag; ///< near rows per byte of `touching`

    std::vector<Row> owned_first; ///< bodies + 1
    std::vector<NearChunk> chunks;
    /// Near rows whose partner belongs to another chunk of the same kind of pair.
    std::vector<Row> across;
    /// True if every sphere is at the centre of its body: scenes of single spheres.
    bool centred = false;
    /// Bit k of byte first_flags + g of a chunk: near row first + group * g + k of the chunk.
    std::vector<std::uint8_t> touching;
    /// Per chunk: a near row beyond the limit of overlap or of force, or no_row.
    std::vector<Row> beyond_limit;
    /// Where bodies sleep: bits, ordered as in `touching`, of the pairs with a body that is awake;
    /// otherwise empty.
    std::vector<std::uint8_t> awake;
    /// Bits of the pairs that are computed: also those of sleeping bodies that touch one that is
    /// awake, whose springs do not change.
    std::vector<std::uint8_t> look;

    std::size_t size() const { return owned_first.empty() ? 0 : owned_first.back(); }

    /// Calls visit(near row) for the near rows whose bit is set in `flags`, which is ordered as
    /// `touching`.
    template <class Visit>
    void for_flagged(const std::vector<std::uint8_t>& flags, Visit&& visit) const {
        for (const NearChunk& c : chunks)
            for (std::size_t g = 0; c.first + group * g < c.last; ++g)
                for (unsigned bits = flags[c.first_flags + g]; bits != 0; bits &= bits - 1)
                    if (const std::size_t k =
                            c.first + group * g + static_cast<unsigned>(__builtin_ctz(bits));
                        k < c.last)
                        visit(static_cast<Row>(k));
    }
    /// Calls visit(near row) for the touching pairs, owner by owner.
    template <class Visit>
    void for_touching(Visit&& visit) const {
        for_flagged(touching, visit);
    }
};

} // namespace bris
