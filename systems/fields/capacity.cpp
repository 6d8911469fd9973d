#include "systems/fields/capacity.hpp"

#include "engine/parallel.hpp"

#include <algorithm>

namespace bris {

namespace {

/// A field whose values are value(voids in m3, mass of fines in kg) of each voxel.
template <class Value>
VoxelField by_voxel(const Fouling& f, Value&& value) {
    VoxelField field(f.blocks);
    const double volume = f.blocks.lattice().volume();
    for_chunks(f.blocks.count(), 8, [&](std::size_t, std::size_t first, std::size_t last) {
        for (std::size_t b = first; b < last; ++b)
            for (std::size_t k = 0; k < VoxelBlocks::voxels_each; ++k)
                field.block(b)[k] =
                    value(volume * f.solid.voids().block(b)[k], f.fines.block(b)[k]);
    });
    return field;
}

} // namespace

VoxelField fines_capacity(const Fouling& f) {
    const double per_volume = f.settings.density / (1 + f.settings.least_void_ratio);
    return by_voxel(f, [&](double voids, double) { return per_volume * voids; });
}

VoxelField water_capacity(const Fouling& f) {
    return by_voxel(f, [&](double voids, double fines) {
        return std::max(voids - fines / f.settings.density, 0.0);
    });
}

} // namespace bris
