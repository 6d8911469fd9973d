#pragma once

#include "components/membrane.hpp"
#include "engine/lanes.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace bris {

/// The point of a band nearest to a sphere's centre, for one centre (double) or lane_count of them
/// (Lane).
template <class Number>
struct NearestOnBand {
    Number distance;      ///< m, from the surface to the centre; negative behind the surface
    Number radial, axial; ///< unit normal towards the grains
    /// The point is on the strip from ring `here` + strip to the next one, strip = -1, 0 or 1, at
    /// the fraction `share` of its height.
    Number strip, share;
};

/// Finds the nearest point on the three strips between four consecutive rings of the given radii
/// (m). The centre is at distance `out` (m) along the sector's outward direction and at height `up`
/// (m) above the middle of the second ring, which is ring `here`.
template <class Number>
NearestOnBand<Number> nearest_on_band(Number out, Number up, const std::array<Number, 4>& radius,
                                      double ring_height) {
    using bris::sqrt, std::sqrt;
    const Number none{}, one = none + 1.0;
    Number best = none + std::numeric_limits<double>::infinity(), foot_out = none, foot_up = none;
    NearestOnBand<Number> n{};
    for (int k = 0; k < 3; ++k) {
        const auto i = static_cast<std::size_t>(k);
        const Number from = radius[i], slope = radius[i + 1] - from,
                     above = up - (k - 1) * ring_height;
        const Number along = ((out - from) * slope + above * ring_height) /
                             (slope * slope + ring_height * ring_height);
        const Number low = along > none ? along : none, share = low < one ? low : one;
        const Number a = out - from - share * slope, b = above - share * ring_height,
                     squared = a * a + b * b;
        const auto nearer = squared < best;
        best = nearer ? squared : best;
        foot_out = nearer ? a : foot_out;
        foot_up = nearer ? b : foot_up;
        n.share = nearer ? share : n.share;
        n.strip = nearer ? none + (k - 1.0) : n.strip;
    }
    const Number distance = sqrt(best), t = up * (1 / ring_height);
    const auto inside = out < (one - t) * radius[1] + t * radius[2];
    const Number side = inside ? one : -one,
                 inverse = side / (distance > 1e-300 ? distance : none + 1e-300);
    n.distance = side * distance;
    n.radial = foot_out * inverse;
    n.axial = foot_up * inverse;
    return n;
}

/// The inner surface of a membrane. In each sector it is a band of plane strips from the middle of
/// one ring to the middle of the next, vertical below the first middle and above the last. Rings of
/// different radii are therefore joined by a slope, never by a step. The bands extend without limit
/// around the axis, so together they close the surface at any radii. A contact is at the nearest
/// point of the band, so the force derives from one potential, and the energy that grains gain on a
/// slope is work of the elements.
struct MembraneSurface {
    const Vec3* outward;  ///< unit vector of each sector
    const double* radius; ///< m, of each element
    int rings, sectors;
    double ring_height;
    double cosine, sine; ///< of the angle between adjacent sectors

    MembraneSurface(const Membrane& membrane, const double* element_radius)
        : outward(membrane.outward.data()), radius(element_radius),
          rings(static_cast<int>(membrane.rings)), sectors(static_cast<int>(membrane.sectors)),
          ring_height(membrane.ring_height), cosine(outward[0].dot(outward[1])),
          sine(outward[0].x() * outward[1].y() - outward[0].y() * outward[1].x()) {}

    /// The ring whose middle is at or below height z; -1 or less below the first middle.
    int ring_below(double z) const { return static_cast<int>(std::floor(z / ring_height - 0.5)); }
    double middle(int ring) const { return (ring + 0.5) * ring_height; }
    /// Row of an element; rings beyond either end repeat the end ring.
    Row element(int ring, int sector) const {
        return static_cast<Row>(std::clamp(ring, 0, rings - 1) * sectors + sector);
    }
    double radius_at(int ring, int sector) const { return radius[element(ring, sector)]; }

    /// Distance from the axis (m) at the fraction `share` of the height from the middle of a ring
    /// to the middle of the next.
    double radius_between(int ring, double share, int sector) const {
        return (1 - share) * radius_at(ring, sector) + share * radius_at(ring + 1, sector);
    }
    /// Width (m) of a sector at that height between the planes of the adjacent sectors; negative if
    /// they hide it.
    double exposed_width(int ring, double share, int sector) const {
        const double before = radius_between(ring, share, sector > 0 ? sector - 1 : sectors - 1),
                     after = radius_between(ring, share, sector + 1 < sectors ? sector + 1 : 0);
        return (before + after - 2 * radius_between(ring, share, sector) * cosine) / sine;
    }

    struct Nearest {
        double distance;      ///< m, from the surface to the centre; negative behind the surface
        double radial, axial; ///< unit normal towards the grains
        Foot foot;
    };
    /// The point of a sector's band nearest to a centre at distance `out` (m) along the sector's
    /// outward direction and height z (m). The search extends one ring below and above, which is
    /// enough for centres closer to the band than the height of a ring.
    Nearest nearest(int sector, double out, double z) const {
        const int here = ring_below(z);
        const auto n =
            nearest_on_band<double>(out, z - middle(here), radii_around(here, sector), ring_height);
        return {n.distance, n.radial, n.axial,
                foot(here + static_cast<int>(n.strip), sector, n.share)};
    }
    /// Contact at the fraction `share` of the strip from a ring to the next.
    Foot foot(int ring, int sector, double share) const {
        return {share, element(ring, sector), element(ring + 1, sector)};
    }
    /// Radii (m) of the ring below, of ring `here` and of the two rings above it.
    std::array<double, 4> radii_around(int here, int sector) const {
        return {radius_at(here - 1, sector), radius_at(here, sector), radius_at(here + 1, sector),
                radius_at(here + 2, sector)};
    }
    /// Lower bound (m) on the distance from the axis of the band's points within the height of a
    /// ring from z.
    double least_radius(int sector, double z) const {
        const int here = ring_below(z);
        return std::ranges::min(radii_around(here, sector));
    }
};

} // namespace bris
