#pragma once

#include "engine/math.hpp"
#include "engine/world.hpp"
#include "systems/fields/voxels.hpp"

#include <vector>

namespace bris {

/// A stretch along z, m.
struct Stretch {
    double low, high;
};

/// The space in which a scene can hold fines and water: inside a box, in front of all planes and
/// inside the membrane, if there is one, but not in blocked boxes, where bodies of facets stand.
/// Facets themselves do not bound it.
class Container {
public:
    /// Of the present planes and membrane of a world, within `bounds`, which may be infinite.
    /// Reads State only.
    Container(const World& world, const Box3& bounds, std::vector<Box3> blocked = {});

    /// The smallest box around it. Throws InputError if it is not bounded, or empty.
    Box3 bounds() const;
    /// The parts of a vertical line through x, y that are inside, in ascending order. Sides along
    /// the x and y axes do not count here: see share.
    void intervals(double x, double y, std::vector<Stretch>& inside) const;
    /// Share of a square of the given width about x, y that lies between the sides along the axes.
    double share(double x, double y, double width) const;

    friend bool operator==(const Container& a, const Container& b);

private:
    struct Plane {
        Vec3 point, normal;
        friend bool operator==(const Plane&, const Plane&) = default;
    };
    /// The inner surface of a membrane. That of a sleeve is taken as plane strips about the middles
    /// of its fields between nodes.
    struct Tube {
        std::vector<Vec3> outward;  ///< by sector
        std::vector<double> radius; ///< by element
        double ring_height = 0;
        friend bool operator==(const Tube&, const Tube&) = default;
    };
    void take_rings(const World& world);
    void take_sleeve(const World& world);
    void within_tube(double x, double y, Stretch all, std::vector<Stretch>& inside) const;
    void cut_blocked(double x, double y, std::vector<Stretch>& inside) const;

    Box3 bounds_; ///< with the planes along the axes
    std::vector<Plane> planes_;
    Tube tube_;
    std::vector<Box3> blocked_;
};

} // namespace bris
