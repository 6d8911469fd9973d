#include "systems/fields/column_of_blocks.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace bris::detail {

namespace {

constexpr int edge = VoxelBlocks::edge;
constexpr Stretch nothing{1, 0};
constexpr int most_lines = edge * 64;

} // namespace

ColumnOfBlocks::ColumnOfBlocks(const VoxelBlocks& blocks, std::uint32_t first, std::uint32_t last,
                               int samples)
    : blocks_(blocks), first_(first), last_(last), samples_(samples), lines_(edge * samples),
      height_(
          static_cast<std::size_t>(blocks.first()[last - 1].z - blocks.first()[first].z + edge)),
      pitch_(blocks.lattice().size / samples),
      corner_(blocks.lattice().centre(blocks.first()[first]) -
              Vec3::Constant(0.5 * blocks.lattice().size)),
      current_(static_cast<std::size_t>(lines_) * static_cast<std::size_t>(lines_), nothing) {}

// Most spheres of a rock overlap on a line, so one interval per line is extended in place. A sphere
// that does not touch it begins another; `unite` puts them together. The union does not depend on
// the order of the spheres.
void ColumnOfBlocks::extend(std::uint32_t line, double low, double high) {
    Stretch& now = current_[line];
    if (low <= now.high && high >= now.low) {
        now.low = std::min(now.low, low);
        now.high = std::max(now.high, high);
        return;
    }
    if (now.low <= now.high) parts_.push_back({line, now.low, now.high});
    now = {low, high};
}

void ColumnOfBlocks::add(const SphereRow& s) {
    const double r2 = s.radius * s.radius, x = s.x - corner_.x(), y = s.y - corner_.y();
    const auto range = [&](double centre, double reach) {
        const double low = std::ceil((centre - reach) / pitch_ - 0.5),
                     high = std::floor((centre + reach) / pitch_ - 0.5);
        return std::pair(static_cast<int>(std::clamp(low, 0.0, static_cast<double>(lines_))),
                         static_cast<int>(std::clamp(high, -1.0, static_cast<double>(lines_ - 1))));
    };
    const auto [i_low, i_high] = range(x, s.radius);
    std::array<double, most_lines> half;
    for (int i = i_low; i <= i_high; ++i) {
        const double dx = (i + 0.5) * pitch_ - x, across = r2 - dx * dx;
        if (across <= 0) continue;
        const auto [j_low, j_high] = range(y, std::sqrt(across));
        for (int j = j_low; j <= j_high; ++j) {
            const double dy = (j + 0.5) * pitch_ - y;
            half[static_cast<std::size_t>(j)] = std::sqrt(std::max(across - dy * dy, 0.0));
        }
        const auto first_line = static_cast<std::uint32_t>(i * lines_);
        for (int j = j_low; j <= j_high; ++j)
            if (const double h = half[static_cast<std::size_t>(j)]; h > 0)
                extend(first_line + static_cast<std::uint32_t>(j), s.z - h, s.z + h);
    }
}

// parts of each line side by side
void ColumnOfBlocks::sort_parts() {
    for (std::uint32_t line = 0; line < current_.size(); ++line)
        if (current_[line].low <= current_[line].high)
            parts_.push_back({line, current_[line].low, current_[line].high});
    line_first_.assign(current_.size() + 1, 0);
    for (const Part& p : parts_) ++line_first_[p.line + 1];
    for (std::size_t line = 0; line < current_.size(); ++line)
        line_first_[line + 1] += line_first_[line];
    sorted_.resize(parts_.size());
    std::vector<std::uint32_t> next(line_first_.begin(), line_first_.end() - 1);
    for (const Part& p : parts_) sorted_[next[p.line]++] = {p.low, p.high};
}

void ColumnOfBlocks::unite(std::uint32_t line, std::vector<Stretch>& parts) const {
    parts.assign(sorted_.begin() + line_first_[line], sorted_.begin() + line_first_[line + 1]);
    if (parts.size() < 2) return;
    std::ranges::sort(parts, {}, &Stretch::low);
    std::size_t last = 0;
    for (std::size_t k = 1; k < parts.size(); ++k)
        if (parts[k].low <= parts[last].high)
            parts[last].high = std::max(parts[last].high, parts[k].high);
        else
            parts[++last] = parts[k];
    parts.resize(last + 1);
}

/// Adds the length of an interval, in voxels and by weight, to the voxels of a column of voxels.
void ColumnOfBlocks::deposit(std::vector<double>& lengths, std::size_t column, double low,
                             double high, double weight) const {
    const double size = blocks_.lattice().size, top = static_cast<double>(height_);
    const double a = std::clamp((low - corner_.z()) / size, 0.0, top),
                 b = std::clamp((high - corner_.z()) / size, 0.0, top);
    if (!(a < b)) return;
    double* voxel = &lengths[column * height_];
    const auto from = std::min(static_cast<std::size_t>(a), height_ - 1),
               to = std::min(static_cast<std::size_t>(b), height_ - 1);
    if (from == to) {
        voxel[from] += weight * (b - a);
        return;
    }
    voxel[from] += weight * (static_cast<double>(from + 1) - a);
    for (std::size_t k = from + 1; k < to; ++k) voxel[k] += weight;
    voxel[to] += weight * (b - static_cast<double>(to));
}

double ColumnOfBlocks::measure(const Container* container, VoxelField& solid, VoxelField& error,
                               VoxelField& voids) {
    sort_parts();
    std::vector<double> even(edge * edge * height_), odd(even.size()), empty;
    if (container != nullptr) empty.resize(even.size());
    std::vector<Stretch> parts, inside;
    for (int i = 0; i < lines_; ++i)
        for (int j = 0; j < lines_; ++j) {
            const auto line = static_cast<std::uint32_t>(i * lines_ + j);
            const auto column = static_cast<std::size_t>((i / samples_) * edge + j / samples_);
            unite(line, parts);
            auto& lengths = (i % samples_ + j % samples_) % 2 == 0 ? even : odd;
            for (const Stretch& part : parts) deposit(lengths, column, part.low, part.high);
            if (container == nullptr) continue;
            const double x = corner_.x() + (i + 0.5) * pitch_, y = corner_.y() + (j + 0.5) * pitch_,
                         weight = container->share(x, y, pitch_);
            if (!(weight > 0)) continue;
            container->intervals(x, y, inside);
            for (const Stretch& in : inside) {
                double low = in.low;
                for (const Stretch& part : parts) {
                    if (part.high <= low) continue;
                    if (part.low >= in.high) break;
                    if (part.low > low) deposit(empty, column, low, part.low, weight);
                    low = part.high;
                }
                if (low < in.high) deposit(empty, column, low, in.high, weight);
            }
        }
    double difference = 0;
    write(even, odd, solid, error, difference);
    if (container != nullptr) write_voids(empty, voids);
    return difference * blocks_.lattice().volume();
}

void ColumnOfBlocks::write(const std::vector<double>& even, const std::vector<double>& odd,
                           VoxelField& solid, VoxelField& error, double& difference) const {
    const int all = samples_ * samples_, evens = (all + 1) / 2;
    for (std::uint32_t b = first_; b < last_; ++b) {
        const auto above =
            static_cast<std::size_t>(blocks_.first()[b].z - blocks_.first()[first_].z);
        double *fraction = solid.block(b), *estimate = error.block(b);
        for (std::size_t k = 0; k < VoxelBlocks::voxels_each; ++k) {
            const std::size_t from = (k / edge) * height_ + above + k % edge;
            fraction[k] = std::min((even[from] + odd[from]) / all, 1.0);
            const double apart = even[from] / evens - odd[from] / (all - evens);
            difference += apart;
            estimate[k] = 0.5 * std::abs(apart);
        }
    }
}

void ColumnOfBlocks::write_voids(const std::vector<double>& lengths, VoxelField& voids) const {
    for (std::uint32_t b = first_; b < last_; ++b) {
        const auto above =
            static_cast<std::size_t>(blocks_.first()[b].z - blocks_.first()[first_].z);
        double* fraction = voids.block(b);
        for (std::size_t k = 0; k < VoxelBlocks::voxels_each; ++k)
            fraction[k] = std::min(
                lengths[(k / edge) * height_ + above + k % edge] / (samples_ * samples_), 1.0);
    }
}

} // namespace bris::detail
