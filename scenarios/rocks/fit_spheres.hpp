#pragma once

#include "components/clump.hpp"
#include "scenarios/rocks/rock.hpp"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace bris {

/// How a set of balls is fitted to a surface. Lengths are shares of the rock's sieve size.
struct FitSettings {
    std::size_t spheres = 30;
    double min_radius = 0.12; ///< smaller balls make sharper corners but dearer, shorter steps
    double max_radius = 0.45;
    double corner_weight =
        0.3; ///< weight of the edges and corners, as a share of the whole surface
    double extreme_weight = 4.0; ///< factor where the solid is longest, widest, thickest
    double bulge_weight = 4.0; ///< weight of a union that stands out, against one that falls short
    double exponent = 3.0;     ///< of the misfit: 2 the mean counts, 4 the worst places count
    int rounds = 120;          ///< trials of moving a ball to where the fit is worst
};

/// Balls whose union approximates the solid. Minimises the weighted mean of |s|^exponent over
/// points on faces, edges and corners, s = distance to the union (negative inside it), with a
/// penalty on interior points that no ball covers. Each point belongs to its nearest ball, so a
/// step is one damped Gauss-Newton step of four unknowns per ball (the variational sphere sets of
/// Wang et al. 2006); a local minimum is left by moving the ball that is missed least to the worst
/// place. `start` is the first guess; empty: the insides of well-spread surface points. `size` is
/// the sieve size, m. Deterministic in `seed`.
std::vector<Ball> fit_spheres(const Polyhedron& polyhedron, double size,
                              const FitSettings& settings, std::uint64_t seed,
                              std::vector<Ball> start = {});

/// Moves radii (all by one length) and centres (one stretch along each principal axis of the solid)
/// so that volume and the three principal moments of the union are those of the solid to 1e-5 if
/// Newton's method can, else the volume alone by scaling. Changes of a few per cent of the size.
void match_moments(const Polyhedron& polyhedron, std::vector<Ball>& balls);

} // namespace bris
