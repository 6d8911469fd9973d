#pragma once

#include "engine/math.hpp"

#include <cstdint>
#include <unordered_map>
#include <vector>

namespace bris {

/// Spheres sorted into cells that are as wide as the largest of them, so that only neighbouring
/// cells need to be searched for one that overlaps another.
class SphereCells {
public:
    /// `largest`: m, radius of the largest sphere that will be added or asked for, > 0. Centres lie
    /// within 1 000 diameters of the origin.
    explicit SphereCells(double largest) : side_(2 * largest) {}

    void add(const Vec3& centre, double radius) {
        cells_[key(cell(centre))].push_back({centre, radius});
    }
    /// Whether a sphere overlaps none of those added.
    bool is_clear(const Vec3& centre, double radius) const {
        const Eigen::Array3i middle = cell(centre);
        for (int k = 0; k < 27; ++k) {
            const auto found =
                cells_.find(key(middle + Eigen::Array3i(k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1)));
            if (found == cells_.end()) continue;
            for (const Placed& other : found->second) {
                const double apart = other.radius + radius;
                if ((other.centre - centre).squaredNorm() < apart * apart) return false;
            }
        }
        return true;
    }

private:
    struct Placed {
        Vec3 centre;
        double radius;
    };
    Eigen::Array3i cell(const Vec3& x) const {
        return Eigen::Array3d(Eigen::Vector3d(x / side_)).floor().cast<int>();
    }
    static std::uint64_t key(const Eigen::Array3i& c) {
        return (static_cast<std::uint64_t>(c[0] + 1024) << 40) |
               (static_cast<std::uint64_t>(c[1] + 1024) << 20) |
               static_cast<std::uint64_t>(c[2] + 1024);
    }
    double side_;                                                  // m
    std::unordered_map<std::uint64_t, std::vector<Placed>> cells_; // looked up, never iterated
};

} // namespace bris
