#pragma once

#include "components/boundary.hpp"
#include "components/kinds.hpp"
#include "components/pair.hpp"
#include "components/sphere.hpp"
#include "engine/rows.hpp"

namespace bris {

/// Shares the stiffness of each patch, the touching spheres of one clump and one partner, among its
/// pairs in proportion to their overlaps: a pair enters and leaves with nothing, and n equal pairs
/// have 1/n each. Such a force has no exact potential; what that costs is seen in the energy
/// ledger.
void share_sphere_patches(Rows<NearSpheres, const NearPair, PatchShare> near,
                          Rows<Listed, const ListedPosition, const ListedBody> listed,
                          const NearIndex<SpherePairs>& index);

/// The same for the spheres of one clump and one plane.
void share_plane_patches(Rows<NearPlanes, const NearPair, PatchShare> near,
                         Rows<Listed, const ListedPosition, const ListedBody> listed,
                         Rows<Planes, const PlanePosition> planes,
                         const NearIndex<PlanePairs>& index);

} // namespace bris
