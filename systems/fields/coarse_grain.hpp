#pragma once

#include "engine/world.hpp"
#include "systems/fields/voxel_field.hpp"

#include <array>

namespace bris {

/// Continuum fields of the rocks by coarse-graining (Goldhirsch 2010, Granular Matter 12, 239):
/// each rock's mass and momentum lie at its centre of mass, each contact's stress along its branch
/// vector, and all are spread by one kernel (the voxel, then `smoothed`). Total mass, momentum and
/// the integral of stress are those of the rocks exactly.
struct CoarseFields {
    VoxelBlocks blocks;                 ///< those asked for, widened by the kernel
    VoxelField mass_density;            ///< kg/m3
    std::array<VoxelField, 3> velocity; ///< m/s, momentum over mass; 0 where there is no mass
    /// 1/s, xx yy zz xy yz xz, symmetric part of the velocity gradient by differences between the
    /// next voxels; 0 where these have no mass.
    std::array<VoxelField, 6> strain_rate;
    /// Pa, xx yy zz xy yz xz, compression positive: contact part, symmetric. Empty if the world has
    /// no contacts of a step.
    std::array<VoxelField, 6> stress;
    bool has_stress = false;
};

/// `half_width`: of the kernel, voxels. Contact forces are those of the last observed step.
CoarseFields coarse_grain(const World& world, const VoxelBlocks& blocks, int half_width);

} // namespace bris
