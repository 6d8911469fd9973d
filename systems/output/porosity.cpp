#include "systems/output/porosity.hpp"

#include "components/body.hpp"
#include "components/kinds.hpp"
#include "components/sphere.hpp"

#include <algorithm>
#include <vector>

namespace bris {

namespace {

struct Interval {
    double low, high;
};

/// The same bits in whatever order intervals of one beginning come, as all those that the region
/// cuts off.
double union_length(std::vector<Interval>& list) {
    std::sort(list.begin(), list.end(),
              [](const Interval& a, const Interval& b) { return a.low < b.low; });
    double length = 0;
    for (std::size_t k = 0; k < list.size();) {
        const double begin = list[k].low;
        double end = list[k].high;
        for (++k; k < list.size() && list[k].low <= end; ++k) end = std::max(end, list[k].high);
        length += end - begin;
    }
    return length;
}

/// Midpoints of equal rectangles, on which vertical lines stand.
struct Lines {
    double x, y; ///< m, lower corner
    double dx, dy;
    int nx, ny;
    double x_of(int i) const { return x + (i + 0.5) * dx; }
    double y_of(int j) const { return y + (j + 0.5) * dy; }
    int i_of(double at) const { return index((at - x) / dx, nx); }
    int j_of(double at) const { return index((at - y) / dy, ny); }

private:
    static int index(double at, int n) {
        return std::clamp(static_cast<int>(std::floor(at)), 0, n - 1);
    }
};

/// Length (m) of all lines between two heights that lies in spheres. Lines for which inside(x, y)
/// is false do not count.
template <class Inside>
double length_in_spheres(const World& world, const Lines& lines, double low, double high,
                         Inside&& inside) {
    std::vector<std::vector<Interval>> line(static_cast<std::size_t>(lines.nx) *
                                            static_cast<std::size_t>(lines.ny));
    const Table& bodies = world.table<Bodies>();
    const auto position = bodies.column<Position>();
    const auto run = bodies.column<SpheresOf>();
    const auto ball = world.column<Spheres, LocalBall>();
    const Quat* orientation =
        bodies.has<Orientation>() ? bodies.column<Orientation>().data() : nullptr;
    for (Row b = 0; b < bodies.size(); ++b) {
        Mat3 axes = Mat3::Identity();
        if (orientation != nullptr) axes = orientation[b].toRotationMatrix();
        for (Row k = run[b].first; k < run[b].first + run[b].count; ++k) {
            const Vec3 c = position[b] + axes * ball[k].centre;
            const double r = ball[k].radius;
            if (c.z() + r < low || c.z() - r > high) continue;
            for (int j = lines.j_of(c.y() - r); j <= lines.j_of(c.y() + r); ++j)
                for (int i = lines.i_of(c.x() - r); i <= lines.i_of(c.x() + r); ++i) {
                    const double x = lines.x_of(i), y = lines.y_of(j);
                    const double dx = x - c.x(), dy = y - c.y(), h2 = r * r - dx * dx - dy * dy;
                    if (h2 <= 0 || !inside(x, y)) continue;
                    const double h = std::sqrt(h2);
                    const Interval interval{std::max(low, c.z() - h), std::min(high, c.z() + h)};
                    if (interval.high > interval.low)
                        line[static_cast<std::size_t>(j) * static_cast<std::size_t>(lines.nx) +
                             static_cast<std::size_t>(i)]
                            .push_back(interval);
                }
        }
    }
    // the sum over the lines has a fixed order
    double length = 0;
    for (auto& list : line) length += union_length(list);
    return length;
}

} // namespace

double solid_volume(const World& world, const CylinderRegion& region, int columns) {
    const double r = region.radius, pitch = 2 * r / columns;
    const double length =
        length_in_spheres(world, {-r, -r, pitch, pitch, columns, columns}, region.low, region.high,
                          [&](double x, double y) { return x * x + y * y <= r * r; });
    return length * pitch * pitch;
}

double porosity(const World& world, const CylinderRegion& region, int columns) {
    // the region's volume is counted with the same midpoints, so that a full region has porosity 0
    double inside = 0;
    for (int j = 0; j < columns; ++j)
        for (int i = 0; i < columns; ++i) {
            const double x = (i + 0.5) / columns * 2 - 1, y = (j + 0.5) / columns * 2 - 1;
            if (x * x + y * y <= 1) ++inside;
        }
    const double pitch = 2 * region.radius / columns;
    return 1 - solid_volume(world, region, columns) /
                   (inside * pitch * pitch * (region.high - region.low));
}

double porosity(const World& world, const BoxRegion& region, double pitch) {
    const Vec3 size = region.high - region.low;
    const int nx = std::max(1, static_cast<int>(std::ceil(size.x() / pitch))),
              ny = std::max(1, static_cast<int>(std::ceil(size.y() / pitch)));
    const double length = length_in_spheres(
        world, {region.low.x(), region.low.y(), size.x() / nx, size.y() / ny, nx, ny},
        region.low.z(), region.high.z(), [](double, double) { return true; });
    return 1 - length / (size.z() * nx * ny);
}

} // namespace bris
