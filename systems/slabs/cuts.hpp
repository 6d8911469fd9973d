#pragma once

#include "components/census.hpp"
#include "components/slab.hpp"
#include "engine/world.hpp"

#include <cstdint>
#include <span>
#include <vector>

namespace bris::detail {

/// Work of the bodies with spheres along an axis, in bins of equal width.
struct Work {
    double low = 0, high = 0; ///< m
    std::vector<std::int64_t> bins;
};

/// Axis (0 to 2) along which the centres of the bodies with spheres extend farthest.
int longest_axis(const World& world);

/// Work of the bodies of a world: the number of their spheres and of the near pairs that they own.
/// `ghost`: bodies that do not count, by row; empty: all count.
Work work_along(const World& world, int axis, std::span<const std::uint32_t> ghost);

/// The same over all ranks.
Work work_of_ranks(const World& part, int axis);

/// Cuts of slabs with nearly equal work; ranks + 1, of which the outer ones are infinite.
std::vector<double> even_cuts(const Work& work, unsigned ranks);

/// Distance (m) from a slab within which a body may touch one of the slab before new lists are
/// made.
inline double reach_of(double radius, const Census& census, const Slab& slab) {
    return (1 + 1e-9) * (radius + census.largest_radius + 2 * slab.widest_skin);
}
class Reach {
public:
    Reach(const World& world, const Slab& slab);
    double operator[](Row b) const { return reach_of(radius_[b], census_, slab_); }

private:
    std::span<const double> radius_;
    const Census& census_;
    const Slab& slab_;
};

/// Marks the bodies with spheres whose centres lie in other slabs.
void mark_ghosts(World& part);

} // namespace bris::detail
