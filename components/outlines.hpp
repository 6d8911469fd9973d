#pragma once

#include "engine/math.hpp"

#include <array>
#include <cstddef>
#include <span>
#include <vector>

namespace bris {

/// How far the bodies of each slab of a divided world reach along its axis, cell by cell of the
/// cross-section. A body of one slab can touch one of another only where it reaches into the
/// outline of that slab, so that a large body makes ghosts only of those around it.
class Outlines {
public:
    static constexpr std::size_t cells_along = 32; ///< in both directions of the cross-section

    Outlines() = default;
    /// Outlines without bodies. `axis`: along which the world is divided (0 to 2); `low`, `high`:
    /// corners of the cross-section (m). Bodies beyond it count in the outermost cells.
    Outlines(std::size_t ranks, int axis, const Vec3& low, const Vec3& high);

    void clear();
    /// Adds a body of a slab. `reach`: bounding radius and outer skin (m).
    void add(std::size_t rank, const Vec3& position, double reach);
    /// Whether a body may touch one of those that were added to a slab.
    bool may_touch(std::size_t rank, const Vec3& position, double reach) const;

    /// The numbers of all cells. The largest ones of several Outlines are those of all their
    /// bodies.
    std::span<double> extents() { return {extents_.front().data(), 2 * extents_.size()}; }

private:
    /// How far bodies reach in the negative and in the positive direction of the axis (m).
    using Extent = std::array<double, 2>;
    /// Calls visit(extent) for the cells into which a body reaches.
    template <class Extents, class Visit>
    void for_cells(Extents& extents, std::size_t rank, const Vec3& position, double reach,
                   Visit&& visit) const;
    std::size_t cell(std::size_t direction, double position) const;

    int axis_ = 0;
    std::array<int, 2> across_{};
    std::array<double, 2> low_{}, cells_per_metre_{};
    std::vector<Extent> extents_; // by rank and cell
};

} // namespace bris
