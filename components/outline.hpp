#pragma once

#include "engine/math.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <limits>
#include <span>
#include <vector>

namespace bris {

/// How far the bodies of one slab of a divided world reach along its axis, cell by cell of the
/// cross-section. A body of another slab can touch one of them only where it reaches into their
/// outline, so that a large body makes ghosts only of those around it.
class Outline {
public:
    static constexpr std::size_t cells_along = 32; ///< in both directions of the cross-section
    /// How far bodies reach in the negative and in the positive direction of the axis (m); without
    /// bodies minus infinity.
    struct Extent {
        double down = -std::numeric_limits<double>::infinity(), up = down;
        void enlarge(const Extent& by) {
            down = std::max(down, by.down);
            up = std::max(up, by.up);
        }
        /// Whether each begins before the other ends.
        bool meets(const Extent& other) const { return up >= -other.down && other.up >= -down; }
    };

    Outline() = default;
    /// An outline without bodies. `axis`: along which the world is divided (0 to 2); `low`, `high`:
    /// corners of the cross-section (m). Bodies beyond it count in the outermost cells.
    Outline(int axis, const Vec3& low, const Vec3& high);

    void clear();
    /// Adds a body of the slab. `reach`: bounding radius and outer skin (m).
    void add(const Vec3& position, double reach);
    /// Adds the bodies of an outline of the same cross-section.
    void add(const Outline& other);
    /// Whether a body may touch one of those that were added.
    bool may_touch(const Vec3& position, double reach) const;

    Extent extent() const; ///< of all bodies
    /// The numbers of all cells.
    std::span<double> numbers() { return numbers_of(cells_); }
    static std::span<double> numbers_of(std::vector<Extent>& extents) {
        static_assert(sizeof(Extent) == 2 * sizeof(double));
        return {&extents.front().down, 2 * extents.size()};
    }

private:
    /// Calls visit(extent) for the cells into which a body reaches.
    template <class Cells, class Visit>
    void for_cells(Cells& cells, const Vec3& position, double reach, Visit&& visit) const;
    std::size_t cell(std::size_t direction, double position) const;

    int axis_ = 0;
    std::array<int, 2> across_{};
    std::array<double, 2> low_{}, cells_per_metre_{};
    std::vector<Extent> cells_;
};

} // namespace bris
