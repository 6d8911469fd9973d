#include "systems/fields/container.hpp"

#include "components/body.hpp"
#include "components/boundary.hpp"
#include "components/kinds.hpp"
#include "components/membrane.hpp"
#include "components/sleeve.hpp"
#include "engine/errors.hpp"
#include "engine/ordering.hpp"

#include <algorithm>
#include <cmath>

namespace bris {

Container::Container(const World& world, const Box3& bounds, std::vector<Box3> blocked)
    : bounds_(bounds), blocked_(std::move(blocked)) {
    std::vector<Plane> all;
    if (world.has<Planes>()) {
        const auto rows = rows_by_id(world.column<Bodies, BodyId>());
        const auto position = world.column<Bodies, Position>();
        const auto id = world.column<Planes, PlaneId>();
        const auto host = world.column<Planes, HostId>();
        const auto shape = world.column<Planes, LocalPlane>();
        all.resize(id.size());
        for (std::size_t k = 0; k < id.size(); ++k)
            all[id[k]] = {position[rows[host[k]]] + shape[k].point, shape[k].normal};
    }
    for (const Plane& p : all) {
        int axis = 0;
        (void)p.normal.cwiseAbs().maxCoeff(&axis);
        if (p.normal == Vec3(Vec3::Unit(axis)))
            bounds_.low[axis] = std::max(bounds_.low[axis], p.point[axis]);
        else if (p.normal == Vec3(-Vec3::Unit(axis)))
            bounds_.high[axis] = std::min(bounds_.high[axis], p.point[axis]);
        else
            planes_.push_back(p);
    }
    if (world.has<Elements>()) take_rings(world);
    if (world.has<Nodes>()) take_sleeve(world);
}

void Container::take_rings(const World& world) {
    const auto& membrane = world.resource<Membrane>();
    tube_.outward = membrane.outward;
    tube_.ring_height = membrane.ring_height;
    const auto id = world.column<Elements, ElementId>();
    const auto radius = world.column<Elements, ElementRadius>();
    tube_.radius.resize(radius.size());
    for (std::size_t k = 0; k < id.size(); ++k) tube_.radius[id[k]] = radius[k];
}

void Container::take_sleeve(const World& world) {
    const std::size_t columns = world.resource<Sleeve>().columns;
    const auto node = world.column<Nodes, NodePosition>();
    const std::size_t fields = node.size() / columns - 1; // one above another
    tube_.ring_height = node.back().z() / static_cast<double>(fields);
    for (std::size_t c = 0; c < columns; ++c) {
        const Vec3 chord = node[(c + 1) % columns] - node[c]; // of the clamped level
        tube_.outward.push_back(Vec3(chord.y(), -chord.x(), 0).normalized());
    }
    for (std::size_t k = 0; k < fields; ++k)
        for (std::size_t c = 0; c < columns; ++c) {
            const std::size_t next = (c + 1) % columns, low = k * columns, high = low + columns;
            tube_.radius.push_back(tube_.outward[c].dot(node[low + c] + node[low + next] +
                                                        node[high + c] + node[high + next]) /
                                   4);
        }
}

Box3 Container::bounds() const {
    Box3 box = bounds_;
    if (!tube_.radius.empty()) {
        // corners of the polygon lie outside the circle
        const double widest = std::ranges::max(tube_.radius) /
                              std::cos(pi / static_cast<double>(tube_.outward.size()));
        box.low = box.low.cwiseMax(Vec3(-widest, -widest, box.low.z()));
        box.high = box.high.cwiseMin(Vec3(widest, widest, box.high.z()));
    }
    for (int axis = 0; axis < 3; ++axis)
        require(std::isfinite(box.low[axis]) && std::isfinite(box.high[axis]) &&
                    box.low[axis] < box.high[axis],
                std::string("fields: expected planes, a membrane or a box that bound the space "
                            "along ") +
                    "xyz"[axis] + ", found " + std::to_string(box.low[axis]) + " to " +
                    std::to_string(box.high[axis]) + " m");
    return box;
}

void Container::intervals(double x, double y, std::vector<Stretch>& inside) const {
    inside.clear();
    Stretch all{bounds_.low.z(), bounds_.high.z()};
    for (const Plane& p : planes_) {
        // (x, y, z) . normal >= point . normal
        const double beyond = p.point.dot(p.normal) - x * p.normal.x() - y * p.normal.y();
        if (p.normal.z() > 0)
            all.low = std::max(all.low, beyond / p.normal.z());
        else if (p.normal.z() < 0)
            all.high = std::min(all.high, beyond / p.normal.z());
        else if (beyond > 0)
            return;
    }
    if (!(all.low < all.high)) return;
    if (tube_.radius.empty())
        inside.push_back(all);
    else
        within_tube(x, y, all, inside);
    cut_blocked(x, y, inside);
}

void Container::cut_blocked(double x, double y, std::vector<Stretch>& inside) const {
    for (const Box3& box : blocked_) {
        if (x < box.low.x() || x > box.high.x() || y < box.low.y() || y > box.high.y()) continue;
        std::vector<Stretch> left;
        for (const Stretch& i : inside) {
            const Stretch below{i.low, std::min(i.high, box.low.z())},
                above{std::max(i.low, box.high.z()), i.high};
            if (below.low < below.high) left.push_back(below);
            if (above.low < above.high) left.push_back(above);
        }
        inside = std::move(left);
    }
}

double Container::share(double x, double y, double width) const {
    const auto along = [&](double centre, double low, double high) {
        const double inside =
            std::min(centre + 0.5 * width, high) - std::max(centre - 0.5 * width, low);
        return std::clamp(inside / width, 0.0, 1.0);
    };
    return along(x, bounds_.low.x(), bounds_.high.x()) *
           along(y, bounds_.low.y(), bounds_.high.y());
}

// In each sector the surface is straight between the middles of adjacent rings, and vertical below
// the first middle and above the last.
void Container::within_tube(double x, double y, Stretch all, std::vector<Stretch>& inside) const {
    const std::size_t sectors = tube_.outward.size(), rings = tube_.radius.size() / sectors;
    std::size_t sector = 0;
    double out = -1;
    for (std::size_t s = 0; s < sectors; ++s)
        if (const double d = x * tube_.outward[s].x() + y * tube_.outward[s].y(); d > out)
            out = d, sector = s;
    const auto margin = [&](std::size_t ring) {
        return tube_.radius[ring * sectors + sector] - out; // negative outside
    };
    const auto middle = [&](std::size_t ring) {
        return (static_cast<double>(ring) + 0.5) * tube_.ring_height;
    };
    const auto add = [&](double low, double high) {
        low = std::max(low, all.low);
        high = std::min(high, all.high);
        if (!(low < high)) return;
        if (!inside.empty() && inside.back().high >= low)
            inside.back().high = high;
        else
            inside.push_back({low, high});
    };
    if (margin(0) > 0) add(all.low, middle(0));
    for (std::size_t k = 0; k + 1 < rings; ++k) {
        const double a = margin(k), b = margin(k + 1);
        const double crossing = middle(k) + a / (a - b) * tube_.ring_height;
        if (a > 0 && b > 0)
            add(middle(k), middle(k + 1));
        else if (a > 0)
            add(middle(k), crossing);
        else if (b > 0)
            add(crossing, middle(k + 1));
    }
    if (margin(rings - 1) > 0) add(middle(rings - 1), all.high);
}

bool operator==(const Container& a, const Container& b) {
    return a.bounds_.low == b.bounds_.low && a.bounds_.high == b.bounds_.high &&
           a.planes_ == b.planes_ && a.tube_ == b.tube_ && a.blocked_ == b.blocked_;
}

} // namespace bris
