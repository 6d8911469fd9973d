#pragma once

#include "components/body.hpp"
#include "components/kinds.hpp"
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

/// Work of the bodies of a world: the number of their spheres and of the near pairs that they own.
/// `ghost`: bodies that do not count, by row; empty: all count.
Work work_along(const World& world, int axis, std::span<const std::uint32_t> ghost);

/// The same over all ranks.
Work work_of_ranks(const World& part, int axis);

/// Cuts of slabs with nearly equal work; ranks + 1, of which the outer ones are infinite.
std::vector<double> even_cuts(const Work& work, unsigned ranks);

/// Adds the bodies of its slab to the outline of this rank.
void outline_own_slab(Slab& slab, const World& whole);

/// Brings the outlines of this slab and of the near ones up to date after new cuts, while bodies
/// are still where they were computed. All ranks call it; each hears from its neighbours only.
void share_outlines(Slab& slab, const World& part);

/// The sum of bounding radius and outer skin (m) of each body.
class Reach {
public:
    Reach(const double* radius, const double* skin) : radius_(radius), skin_(skin) {}
    explicit Reach(const World& world)
        : Reach(world.column<Bodies, BoundingRadius>().data(),
                world.column<Bodies, OuterSkin>().data()) {}
    double operator[](Row b) const { return radius_[b] + skin_[b]; }

private:
    const double *radius_, *skin_;
};

/// Marks the bodies with spheres whose centres lie in other slabs.
void mark_ghosts(World& part);

} // namespace bris::detail
