#pragma once

#include "components/sleeve.hpp"
#include "engine/lane_math.hpp"

namespace bris {

/// Corners (m) of lane_count triangles, counter-clockwise as seen from the grains.
using TriangleLanes = std::array<Vec3Lanes, 3>;

/// The triangles at(0) to at(lane_count - 1).
template <class At>
TriangleLanes triangle_lanes(At&& at) {
    TriangleLanes all;
    for (std::size_t k = 0; k < 3; ++k) {
        const auto c = transpose(load_rows([&](int q) { return at(q).corners[k].data(); }));
        all[k] = {c[0], c[1], c[2]};
    }
    return all;
}

/// The points of triangles that are nearest to the centres of spheres.
struct NearestOnTriangle {
    Lane distance;             ///< m; negative where the centre is behind the triangle
    Vec3Lanes normal;          ///< unit vector towards the grains
    std::array<Lane, 3> share; ///< of the corners in the point; they add to 1
};

/// Finds the point of each triangle that is nearest to a centre. The distance changes continuously
/// with the centre and the corners, so that a force that follows from it derives from one
/// potential.
inline NearestOnTriangle nearest_on_triangle(const TriangleLanes& t, const Vec3Lanes& centre) {
    const Lane none{}, one = none + 1.0;
    const Vec3Lanes e = t[1] - t[0], f = t[2] - t[0], way = centre - t[0], area = cross(e, f);
    const Lane ee = dot(e, e), ef = dot(e, f), ff = dot(f, f), we = dot(way, e), wf = dot(way, f);
    const Lane squared_area = dot(area, area), inverse = one / squared_area;
    const Vec3Lanes normal = (one / sqrt(squared_area)) * area;
    const Lane v = (ff * we - ef * wf) * inverse, w = (ee * wf - ef * we) * inverse,
               u = one - v - w, height = dot(way, normal);
    const LaneMask inside = (u >= none) & (v >= none) & (w >= none);

    // otherwise the nearest point lies on an edge
    const auto clamped = [&](const Lane& x) { return min(max(x, none), one); };
    const Lane on_e = clamped(we / ee), on_f = clamped(wf / ff);
    const Vec3Lanes g = f - e, from_e = way - e;
    const Lane on_g = clamped(dot(from_e, g) / dot(g, g));
    const Vec3Lanes ways[3] = {way - on_e * e, way - on_f * f, from_e - on_g * g};
    const Lane squares[3] = {dot(ways[0], ways[0]), dot(ways[1], ways[1]), dot(ways[2], ways[2])};
    const LaneMask f_first = squares[1] < squares[0];
    const Lane of_two = f_first ? squares[1] : squares[0];
    const LaneMask g_first = squares[2] < of_two;
    const Lane squared = g_first ? squares[2] : of_two, distance = sqrt(squared);
    const Vec3Lanes nearest = select(g_first, ways[2], select(f_first, ways[1], ways[0]));
    const Lane second = g_first ? one - on_g : (f_first ? none : on_e),
               third = g_first ? on_g : (f_first ? on_f : none);
    NearestOnTriangle n;
    n.distance = inside ? height : distance;
    n.normal = select(inside, normal, (one / max(distance, none + 1e-300)) * nearest);
    n.share[1] = inside ? v : second;
    n.share[2] = inside ? w : third;
    n.share[0] = one - n.share[1] - n.share[2];
    return n;
}

/// The same for one triangle: distance (m).
inline double distance_from_triangle(const PlacedTriangle& t, const Vec3& x) {
    return nearest_on_triangle(triangle_lanes([&](int) -> const PlacedTriangle& { return t; }),
                               {lanes(x.x()), lanes(x.y()), lanes(x.z())})
        .distance[0];
}

} // namespace bris
