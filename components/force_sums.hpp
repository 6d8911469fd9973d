#pragma once

#include "engine/component.hpp"
#include "engine/entity.hpp"

#include <array>
#include <cstdint>
#include <vector>

namespace bris {

// Contact forces are added as integers, so that the order of adding does not change a bit: bodies
// can be divided among threads in any way, and the two forces of a pair cancel exactly.

/// Sums of the contact forces and torques on a body, in units of the ForceGrid.
struct alignas(64) SumRow {
    std::int64_t fx, fy, fz, unused, tx, ty, tz, unused_too;
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

/// Units of the sums, powers of two. The scene determines them: the force of a contact at the limit
/// of overlap has between 2^54 and 2^55 units. The rounding error of a force is half a unit.
struct ForceGrid {
    static constexpr auto name = "force_grid";
    double force = 0;                         ///< N
    double torque = 0;                        ///< N m, of bodies with spheres
    double host_torque = 0;                   ///< N m, of boundaries, whose lever arms are longer
    static constexpr double largest = 0x1p59; ///< largest force of one contact, in units
    static constexpr double largest_sum = 0x1p62; ///< of a body, in units
};

} // namespace bris
