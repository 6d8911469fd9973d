#pragma once

#include "components/boundary.hpp"
#include "components/kinds.hpp"
#include "components/pair.hpp"
#include "components/sphere.hpp"
#include "engine/rows.hpp"

namespace bris {

/// Divides the stiffness of each patch (the touching pairs between the spheres of one clump and one
/// partner) among its pairs in proportion to their overlaps. A pair joins and leaves a patch with a
/// share of zero, and each of n equal pairs has the share 1/n. Such a force has no exact potential;
/// the resulting error appears in the energy budget.
void share_sphere_patches(Rows<NearSpheres, const NearPair, PatchShare> near,
                          Rows<Listed, const ListedPosition, const ListedBody> listed,
                          const NearIndex<SpherePairs>& index);

/// The same for the spheres of one clump and one plane.
void share_plane_patches(Rows<NearPlanes, const NearPair, PatchShare> near,
                         Rows<Listed, const ListedPosition, const ListedBody> listed,
                         Rows<Planes, const PlanePosition> planes,
                         const NearIndex<PlanePairs>& index);

} // namespace bris
