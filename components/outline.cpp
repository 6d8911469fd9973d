#include "components/outline.hpp"

#include <algorithm>

namespace bris {

namespace {

/// Of one body.
Outline::Extent extent_of(double position, double reach) {
    return {reach - position, reach + position};
}

constexpr double for_rounding = 1 + 1e-9;

} // namespace

Outline::Outline(int axis, const Vec3& low, const Vec3& high)
    : axis_(axis), across_{(axis + 1) % 3, (axis + 2) % 3}, cells_(cells_along * cells_along) {
    for (std::size_t k = 0; k < 2; ++k) {
        const double width = high[across_[k]] - low[across_[k]];
        low_[k] = low[across_[k]];
        cells_per_metre_[k] = width > 0 ? static_cast<double>(cells_along) / width : 0;
    }
}

void Outline::clear() { std::ranges::fill(cells_, Extent{}); }

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
    const Extent own = extent_of(position[axis_], reach);
    for_cells(cells_, position, reach, [&](Extent& extent) { extent.enlarge(own); });
}

void Outline::add(const Outline& other) {
    for (std::size_t k = 0; k < cells_.size(); ++k) cells_[k].enlarge(other.cells_[k]);
}

Outline::Extent Outline::extent() const {
    Extent whole;
    for (const Extent& cell : cells_) whole.enlarge(cell);
    return whole;
}

bool Outline::may_touch(const Vec3& position, double reach) const {
    reach *= for_rounding;
    const Extent own = extent_of(position[axis_], reach);
    bool touches = false;
    for_cells(cells_, position, reach,
              [&](const Extent& extent) { touches = touches || own.meets(extent); });
    return touches;
}

} // namespace bris
