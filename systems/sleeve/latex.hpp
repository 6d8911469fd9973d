#pragma once

#include "components/triangle_surface.hpp"

namespace bris {

/// What stretched triangles of latex exert on their corners.
struct TriangleForces {
    TriangleLanes force;           ///< N; the three add to nothing
    std::array<Lane, 3> stiffness; ///< N/m, bounds of what holds each corner
    Lane energy;                   ///< J, elastic
    Lane stretch;                  ///< largest principal stretch
};

/// Thickness at rest (m), Young's modulus (Pa) and whether the sheet folds instead of taking
/// compression.
struct Latex {
    double thickness, young_modulus;
    bool wrinkles;
};

/// Triangles at rest (RestTriangle).
struct RestLanes {
    Lane along, back, high;
};

/// Forces of triangles with these corners (m): an incompressible neo-Hookean sheet in plane stress
/// (Treloar 1944), of which the strain is the same in the whole triangle. Small strains follow
/// Hooke's law with a Poisson ratio of 1/2. With wrinkles it is the relaxed sheet of Pipkin (1986,
/// IMA J. Appl. Math. 36): no stress where both principal stretches are below 1, and simple tension
/// where the smaller one is below its natural width, 1 over the root of the larger.
TriangleForces stretch(const Latex& latex, const RestLanes& rest, const TriangleLanes& corners);

} // namespace bris
