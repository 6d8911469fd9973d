#pragma once

#include "engine/math.hpp"

#include <memory>
#include <vector>

namespace bris {

/// The nearest of many points, by a tree of them.
class NearestPoint {
public:
    /// `points`: m, one at least, to be kept as they are meanwhile.
    explicit NearestPoint(const std::vector<Vec3>& points);
    ~NearestPoint();
    /// m, from a place to the nearest of the points.
    double distance(const Vec3& position) const;

private:
    struct Tree;
    std::unique_ptr<Tree> tree_;
};

} // namespace bris
