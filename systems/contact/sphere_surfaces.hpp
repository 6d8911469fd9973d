#pragma once

#include "components/near_spheres.hpp"
#include "systems/contact/collide_chunk.hpp"

#include <cmath>

namespace bris::detail {

/// Geometry of two spheres, whether they are bodies themselves or belong to clumps (collide_chunk).
/// Both kernels load and subtract rows by code of their own: with functions that they share g++ 12
/// keeps fewer numbers in registers, and contacts take 1.6 times as long
/// (tests/performance/results/step.md).
struct SphereSurfaces {
    Movers movers;
    double deepest; // largest overlap accepted, over the mean radius

    unsigned touching(const NearEntry* near) const {
        return near_lanes(
            [&](int q) -> const SphereRow& { return movers.sphere_row[near[q].owner]; },
            [&](int q) -> const SphereRow& { return movers.sphere_row[near[q].other]; });
    }
    double gap(const NearEntry& near) const {
        const SphereRow &a = movers.sphere_row[near.owner], &b = movers.sphere_row[near.other];
        const double dx = a.x - b.x, dy = a.y - b.y, dz = a.z - b.z;
        return std::sqrt(dx * dx + dy * dy + dz * dz) - (a.radius + b.radius);
    }
    double radius(const NearEntry& near) const {
        const double a = movers.sphere_row[near.owner].radius,
                     b = movers.sphere_row[near.other].radius;
        return a * b / (a + b);
    }
    void prefetch_positions(const NearEntry* near) const {
        for (std::size_t q = 0; q < 8; ++q) prefetch(&movers.sphere_row[near[q].other]);
    }
    template <SumsAt where>
    void prefetch_rows(const TileTarget& to, const Row* rows) const {
        const auto own = movers.bodies_of([&](std::size_t q) { return to.near[rows[q]].owner; });
        const auto other = movers.bodies_of([&](std::size_t q) { return to.near[rows[q]].other; });
        movers.prefetch_rows(own);
        movers.prefetch_rows(other);
        to.prefetch_rows<where>(rows, {own.data(), other.data()});
    }
    void prefetch_partner(const TileTarget& to, Row row) const {
        const Row slot = to.near[row].other;
        prefetch(&movers.sphere_row[slot]);
        movers.prefetch_row(movers.body_of(slot));
        prefetch<true>(&to.sums.of_partner<SumsAt::rows>(row, 0));
    }
};

} // namespace bris::detail
