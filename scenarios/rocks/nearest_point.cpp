#include "scenarios/rocks/nearest_point.hpp"

#include "engine/errors.hpp"

#include <nanoflann.hpp>

#include <cmath>
#include <cstdint>

namespace bris {

namespace {

/// Points with the interface that nanoflann requires.
struct Cloud {
    const std::vector<Vec3>& points;
    std::size_t kdtree_get_point_count() const { return points.size(); }
    double kdtree_get_pt(std::size_t k, std::size_t axis) const {
        return points[k][static_cast<Eigen::Index>(axis)];
    }
    template <class Box>
    bool kdtree_get_bbox(Box&) const {
        return false;
    }
};

// the type of numbers of points is said, for its default differs between versions
using Number = std::uint32_t;
using Index =
    nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<double, Cloud, double, Number>,
                                        Cloud, 3, Number>;

} // namespace

struct NearestPoint::Tree {
    Cloud cloud;
    Index index;
    explicit Tree(const std::vector<Vec3>& points) : cloud{points}, index(3, cloud) {}
};

NearestPoint::NearestPoint(const std::vector<Vec3>& points) {
    require(!points.empty(), "nearest point: expected at least one point, found none");
    tree_ = std::make_unique<Tree>(points);
}

NearestPoint::~NearestPoint() = default;

double NearestPoint::distance(const Vec3& position) const {
    Number nearest = 0;
    double squared = 0;
    (void)tree_->index.knnSearch(position.data(), 1, &nearest, &squared);
    return std::sqrt(squared);
}

} // namespace bris
