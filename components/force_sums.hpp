#pragma once

#include "engine/component.hpp"
#include "engine/entity.hpp"

#include <cstdint>
#include <vector>

namespace bris {

// Contact forces are added as integers, so that the order of adding does not change a bit: bodies
// can be divided among threads in any way, and the two forces of a pair cancel exactly.

/// Sums of the contact forces and torques on a body, in units of the ForceGrid.
struct alignas(64) SumRow {
    std::int64_t fx, fy, fz, unused, tx, ty, tz, unused_too;
};
/// Forces of the contacts that the body's own chunk of near rows has found.
struct ContactSum : Derived<SumRow> {
    static constexpr auto name = "contact_sum", unit = "";
};
/// First of the body's rows in ContactHalo; no_row if it has none.
struct HaloOf : Derived<Row> {
    static constexpr auto name = "halo", unit = "";
};

/// Forces that chunks of near rows exert on bodies that they do not own: a row for each chunk and
/// body, so that no two threads write the same row. The rows of a body form a linked list.
struct ContactHalo {
    static constexpr auto name = "contact_halo";
    /// Flag of a row number that refers to `rows`; otherwise it is the row of a body.
    static constexpr Row flag = Row{1} << 31;
    std::vector<SumRow> rows;
    std::vector<Row> next; ///< next row of the same body; no_row at the end
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
