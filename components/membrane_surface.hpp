#pragma once

#include "components/membrane.hpp"

#include <algorithm>
#include <cmath>

namespace bris {

/// The inner surface of a membrane. In each sector it is a band of plane strips, from the middle of
/// one ring to the middle of the next, upright below the first and above the last: rings of different
/// radii share a slope, never a step. The bands of all sectors together close the surface at any
/// radii, since each is taken without ends around the axis. A contact is at the nearest point of the
/// band, so the force follows from one potential, and the energy that grains gain on a slope is work
/// of the elements.
struct MembraneSurface {
    const Vec3* outward;  ///< by sector
    const double* radius; ///< by element
    int rings, sectors;
    double ring_height;
    double cosine, sine;  ///< of the angle from a sector to the next

    MembraneSurface(const Membrane& membrane, const double* element_radius)
        : outward(membrane.outward.data()), radius(element_radius), rings(static_cast<int>(membrane.rings)),
          sectors(static_cast<int>(membrane.sectors)), ring_height(membrane.ring_height),
          cosine(outward[0].dot(outward[1])), sine(outward[0].x() * outward[1].y() - outward[0].y() * outward[1].x()) {}

    /// The ring whose middle is at or below height z; -1 and less below the first.
    int ring_below(double z) const { return static_cast<int>(std::floor(z / ring_height - 0.5)); }
    double middle(int ring) const { return (ring + 0.5) * ring_height; }
    /// The element of a ring; rings beyond the ends repeat the last.
    Row element(int ring, int sector) const {
        return static_cast<Row>(std::clamp(ring, 0, rings - 1) * sectors + sector);
    }
    double radius_at(int ring, int sector) const { return radius[element(ring, sector)]; }

    /// Distance from the axis at `share` of the way from the middle of a ring to that of the next.
    double radius_between(int ring, double share, int sector) const {
        return (1 - share) * radius_at(ring, sector) + share * radius_at(ring + 1, sector);
    }
    /// Width (m) of a sector there, between the planes of the sectors beside it; negative if they hide it.
    double exposed_width(int ring, double share, int sector) const {
        const double before = radius_between(ring, share, sector > 0 ? sector - 1 : sectors - 1),
                     after = radius_between(ring, share, sector + 1 < sectors ? sector + 1 : 0);
        return (before + after - 2 * radius_between(ring, share, sector) * cosine) / sine;
    }

    struct Nearest {
        double distance;      ///< m, from the surface to the centre; negative behind it
        double radial, axial; ///< unit normal towards the grains
        Foot foot;
    };
    /// The point of a sector's band nearest to a centre at `out` (m, along the sector's outward
    /// direction) and height z. The band is searched one ring below and above: enough for centres
    /// nearer than a ring's height.
    Nearest nearest(int sector, double out, double z) const {
        const int here = ring_below(z);
        double best = 0, foot_out = 0, foot_z = 0;
        Nearest n{};
        for (int ring = here - 1; ring <= here + 1; ++ring) {
            const double from = radius_at(ring, sector), slope = radius_at(ring + 1, sector) - from;
            const double up = z - middle(ring);
            const double along = ((out - from) * slope + up * ring_height) / (slope * slope + ring_height * ring_height);
            const double share = std::clamp(along, 0.0, 1.0);
            const double a = out - from - share * slope, b = up - share * ring_height, squared = a * a + b * b;
            if (ring > here - 1 && squared >= best) continue;
            best = squared;
            foot_out = a;
            foot_z = b;
            n.foot = {share, element(ring, sector), element(ring + 1, sector)};
        }
        const double t = (z - middle(here)) / ring_height;
        const bool inside = out < (1 - t) * radius_at(here, sector) + t * radius_at(here + 1, sector);
        const double distance = std::sqrt(best), inverse = (inside ? 1 : -1) / std::max(distance, 1e-300);
        n.distance = inside ? distance : -distance;
        n.radial = foot_out * inverse;
        n.axial = foot_z * inverse;
        return n;
    }
    /// No point of the band within a ring's height of z is nearer to the axis.
    double least_radius(int sector, double z) const {
        const int here = ring_below(z);
        return std::min(std::min(radius_at(here - 1, sector), radius_at(here, sector)),
                        std::min(radius_at(here + 1, sector), radius_at(here + 2, sector)));
    }
};

} // namespace bris
