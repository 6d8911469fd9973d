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

double union_length(std::vector<Interval>& list) {
    std::sort(list.begin(), list.end(),
              [](const Interval& a, const Interval& b) { return a.low < b.low; });
    double length = 0, end = -1e300;
    for (const Interval& i : list) {
        length += std::max(0.0, i.high - std::max(end, i.low));
        end = std::max(end, i.high);
    }
    return length;
}

} // namespace

double solid_volume(const World& world, const CylinderRegion& region, int columns) {
    const auto n = static_cast<std::size_t>(columns);
    const double pitch = 2 * region.radius / columns;
    std::vector<std::vector<Interval>> column(n * n);
    const auto coordinate = [&](int i) { return -region.radius + (i + 0.5) * pitch; };
    const auto clamped = [&](double x) {
        return std::clamp(static_cast<int>(std::floor((x + region.radius) / pitch)), 0,
                          columns - 1);
    };
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
            if (c.z() + r < region.low || c.z() - r > region.high ||
                c.head<2>().norm() - r > region.radius)
                continue;
            for (int j = clamped(c.y() - r); j <= clamped(c.y() + r); ++j)
                for (int i = clamped(c.x() - r); i <= clamped(c.x() + r); ++i) {
                    const double x = coordinate(i), y = coordinate(j);
                    const double dx = x - c.x(), dy = y - c.y(), h2 = r * r - dx * dx - dy * dy;
                    if (h2 <= 0 || x * x + y * y > region.radius * region.radius) continue;
                    const double h = std::sqrt(h2);
                    const Interval interval{std::max(region.low, c.z() - h),
                                            std::min(region.high, c.z() + h)};
                    if (interval.high > interval.low)
                        column[static_cast<std::size_t>(j) * n + static_cast<std::size_t>(i)]
                            .push_back(interval);
                }
        }
    }
    // the sum over the columns has a fixed order
    double length = 0;
    for (auto& list : column) length += union_length(list);
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

} // namespace bris
