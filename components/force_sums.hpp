#pragma once

#include "engine/component.hpp"
#include "engine/entity.hpp"

#include <array>
#include <cstdint>
#include <vector>

namespace bris {

// Contact forces are added as integers, so that the order of adding does not change a bit: bodies
// can be divided among threads in any way, and the two forces of a pair cancel exactly. Integers
// wrap, so each row also adds the magnitudes of its contributions: while they fit, nothing has.

/// Sums of the contact forces and torques on a body, in units of the ForceGrid.
struct alignas(64) SumRow {
    std::int64_t fx, fy, fz, unused, tx, ty, tz;
    /// The low 52 bits are the sum of the sizes of all contributions in units of size_unit. The
    /// size of a contribution is the sum of the magnitudes of its force and of both torques.
    std::int64_t size;

    static constexpr double size_unit = 0x1p36; ///< of the grid; 2^26 of the largest add to 2^52
    static constexpr std::int64_t size_bits = (std::int64_t{1} << 52) - 1;
};
/// Column of ForceSums. The row of a body has the forces that the chunk of near rows that owns it
/// has found. What a chunk exerts on a body that it does not own has a row for each chunk and body,
/// so that no two threads write the same row. These rows of a body form a linked list.
struct ContactSum : Derived<SumRow> {
    static constexpr auto name = "contact_sum", unit = "";
};
/// The next row of the same body's list; no_row at its end.
struct NextSum : Derived<Row> {
    static constexpr auto name = "next", unit = "";
};
/// First row of the body's list; no_row if it is empty.
struct SumsFromOthers : Derived<Row> {
    static constexpr auto name = "sums_from_others", unit = "";
};

__extension__ using WideInteger = __int128;

/// Sums of the contact forces and torques on the boundaries, in units of the ForceGrid and in the
/// order of Census::boundaries. A boundary may have more contacts than 64 bits can add.
struct BoundarySums {
    static constexpr auto name = "boundary_sums";
    std::vector<std::array<WideInteger, 6>> of;
};

/// Sums of the contacts on the elements of a membrane, over all chunks and ranks: outward force in
/// units of ForceGrid::force, and number in units of ElementSums::hold_unit.
struct MembraneSums {
    static constexpr auto name = "membrane_sums";
    std::vector<std::array<WideInteger, 2>> of;
};

/// Units of the sums, powers of two. The scene determines them: the force of a contact at the limit
/// of overlap has between 2^54 and 2^55 units, or less where dashpots exert more than eight times
/// as much or radii differ by more than a factor of 32. The rounding error of a force is half a
/// unit.
struct ForceGrid {
    static constexpr auto name = "force_grid";
    double force = 0;       ///< N
    double torque = 0;      ///< N m, of bodies with spheres
    double host_torque = 0; ///< N m, of boundaries, whose lever arms are longer
    double at_limit = 0;    ///< N, largest force of a spring at the limit of overlap
    double dashpot = 0;     ///< N, of the fastest pair that stops there; 0 without dashpots
    static constexpr double units_at_limit = 0x1p55;
    static constexpr double largest = 0x1p61;     ///< size of one contribution, in units
    static constexpr double largest_sum = 0x1p62; ///< of the sizes on a body, in units
    static constexpr auto largest_sum_of_sizes =
        static_cast<std::int64_t>(largest_sum / SumRow::size_unit);

    /// Whether no sum of the row has wrapped: the magnitude of a sum is at most that of the sizes.
    static bool holds(const SumRow& sum) {
        return (sum.size & SumRow::size_bits) <= largest_sum_of_sizes;
    }
    /// The sum of the sizes of a row, N.
    double size_of(const SumRow& sum) const {
        return force * SumRow::size_unit * static_cast<double>(sum.size & SumRow::size_bits);
    }
    double largest_size() const { return force * largest; }     ///< N
    double limit_of_sum() const { return force * largest_sum; } ///< N
};

/// The body whose contact forces add to more than the grid holds; the guard stops the run in that
/// step. They are left out of its motion.
struct Overload {
    static constexpr auto name = "overload";
    static constexpr bool is_state = true; // so that nobody leaves out the systems that find it
    EntityId body = nobody;
    double size = 0; ///< N, sum of the sizes of its contributions
    /// Of a boundary, `size` is that of one chunk of near rows, whose sums are added in 128 bits.
    bool is_boundary = false;
    std::uint64_t contacts = 0; ///< touching pairs of the body

    /// Of several bodies the one with the lowest id counts, whatever the order of rows.
    void note(EntityId of_body, double of_size, bool of_boundary) {
        if (of_body < body) *this = {of_body, of_size, of_boundary, 0};
    }
};

} // namespace bris
