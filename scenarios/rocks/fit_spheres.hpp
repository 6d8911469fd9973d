#pragma once

#include "components/clump.hpp"
#include "scenarios/rocks/rock.hpp"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace bris {

/// Settings of the fit of spheres to a surface. Lengths are relative to the sieve size of the rock.
struct FitSettings {
    std::size_t spheres = 30;
    /// Smaller spheres make sharper corners, but the time step becomes shorter and more costly.
    double min_radius = 0.12;
    double max_radius = 0.45;
    /// Weight of the edges and corners, as a share of the weight of the whole surface.
    double corner_weight = 0.3;
    /// Factor of the weights at both ends of the longest, intermediate and shortest dimension.
    double extreme_weight = 4.0;
    /// Weight of a union that protrudes from the solid, relative to one that falls short of it.
    double bulge_weight = 4.0;
    /// Exponent of the misfit: with 2 the mean dominates, with 4 the largest distances.
    double exponent = 3.0;
    /// Number of attempts to move a sphere to where the fit is worst.
    int rounds = 120;
};

/// Fits spheres whose union approximates the solid (the variational sphere sets of Wang et al.
/// 2006). Minimises the weighted mean of |s|^exponent over points on faces, edges and corners,
/// where s is the distance to the union (negative inside it), with a penalty on interior points
/// that no sphere covers. Each point belongs to its nearest sphere, so an iteration is one damped
/// Gauss-Newton step with four unknowns per sphere. To leave a local minimum, the sphere that
/// contributes least is moved to where the fit is worst. `size`: sieve size, m. `start`: first
/// guess; if empty, spheres touching well-spread surface points from inside. The result depends on
/// the arguments and `seed` alone.
std::vector<Ball> fit_spheres(const Polyhedron& polyhedron, double size,
                              const FitSettings& settings, std::uint64_t seed,
                              std::vector<Ball> start = {});

/// Adjusts spheres so that the volume and the three principal moments of inertia of their union are
/// those of the solid to 1e-5: adds one length to all radii and stretches the centres along each
/// principal axis of the solid. If Newton's method does not converge, the spheres are scaled to
/// match the volume alone. The changes are a few per cent of the size.
void match_moments(const Polyhedron& polyhedron, std::vector<Ball>& balls);

} // namespace bris
