#pragma once

#include "engine/math.hpp"

#include <memory>
#include <vector>

namespace bris {

/// Finds the nearest of many points with a k-d tree.
class NearestPoint {
public:
    /// `points`: m, at least one; they must outlive this object unchanged. Throws InputError if
    /// there are none.
    explicit NearestPoint(const std::vector<Vec3>& points);
    ~NearestPoint();
    /// Distance from a position to the nearest point, m.
    double distance(const Vec3& position) const;

private:
    struct Tree;
    std::unique_ptr<Tree> tree_;
};

} // namespace bris
