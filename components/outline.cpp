#include "components/outline.hpp"

#include <algorithm>
#include <limits>

namespace bris {

namespace {
constexpr double for_rounding = 1 + 1e-9;
constexpr double none = -std::numeric_limits<double>::infinity();
constexpr Outline::Extent nothing{none, none};

void enlarge(Outline::Extent& extent, const Outline::Extent& by) {
    extent = {std::max(extent[0], by[0]), std::max(extent[1], by[1])};
}

} // namespace

Outline::Outline(int axis, const Vec3& low, const Vec3& high)
    : axis_(axis), across_{(axis + 1) % 3, (axis + 2) % 3}, cells_(cells_along * cells_along) {
    for (std::size_t k = 0; k < 2; ++k) {
        const double width = high[across_[k]] - low[across_[k]];
        low_[k] = low[across_[k]];
        cells_per_metre_[k] = width > 0 ? static_cast<double>(cells_along) / width : 0;
    }
    clear();
}

void Outline::clear() { std::ranges::fill(cells_, nothing); }

std::size_t Outline::cell(std::size_t direction, double position) const {
    constexpr auto last = static_cast<double>(cells_along - 1);
    const double at = (position - low_[direction]) * cells_per_metre_[direction];
    return static_cast<std::size_t>(std::clamp(at, 0.0, last));
}

template <class Cells, class Visit>
void Outline::for_cells(Cells& cells, const Vec3& position, double reach, Visit&& visit) const {
    std::array<std::size_t, 2> first{}, last{};
    for (std::size_t k = 0; k < 2; ++k) {
        first[k] = cell(k, position[across_[k]] - reach);
        last[k] = cell(k, position[across_[k]] + reach);
    }
    for (std::size_t i = first[0]; i <= last[0]; ++i)
        for (std::size_t j = first[1]; j <= last[1]; ++j) visit(cells[i * cells_along + j]);
}

void Outline::add(const Vec3& position, double reach) {
    reach *= for_rounding;
    const Extent own{reach - position[axis_], reach + position[axis_]};
    for_cells(cells_, position, reach, [&](Extent& extent) { enlarge(extent, own); });
}

void Outline::add(const Outline& other) {
    for (std::size_t k = 0; k < cells_.size(); ++k) enlarge(cells_[k], other.cells_[k]);
}

Outline::Extent Outline::extent() const {
    Extent whole = nothing;
    for (const Extent& cell : cells_) enlarge(whole, cell);
    return whole;
}

bool Outline::may_touch(const Vec3& position, double reach) const {
    reach *= for_rounding;
    const double down = reach - position[axis_], up = reach + position[axis_];
    bool touches = false;
    // the body ends above the lower end of the slab, and begins below its upper end
    for_cells(cells_, position, reach, [&](const Extent& extent) {
        touches = touches || (up >= -extent[0] && extent[1] >= -down);
    });
    return touches;
}

} // namespace bris
