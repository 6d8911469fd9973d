#include "systems/fields/smooth.hpp"

#include "engine/parallel.hpp"

#include <array>
#include <cstdlib>

namespace bris {

namespace {

Voxel along(const Voxel& v, int axis, int steps) {
    return {v.x + (axis == 0 ? steps : 0), v.y + (axis == 1 ? steps : 0),
            v.z + (axis == 2 ? steps : 0)};
}

/// Values of a line of voxels through a block, `margin` voxels beyond it on either side.
void read_line(const VoxelField& field, const VoxelBlocks& blocks, const Voxel& from, int axis,
               int margin, std::vector<double>& line) {
    line.resize(static_cast<std::size_t>(VoxelBlocks::edge + 2 * margin));
    for (int k = 0; k < VoxelBlocks::edge + 2 * margin; ++k) {
        const std::uint32_t n = blocks.number(along(from, axis, k - margin));
        line[static_cast<std::size_t>(k)] = n == VoxelBlocks::none ? 0 : field[n];
    }
}

VoxelField smoothed_along(const VoxelField& field, const VoxelBlocks& blocks, int axis, int w) {
    VoxelField result(blocks);
    const double weight = 1.0 / ((w + 1) * (w + 1));
    for_chunks(blocks.count(), 1, [&](std::size_t b, std::size_t, std::size_t) {
        std::vector<double> line;
        for (int i = 0; i < VoxelBlocks::edge; ++i)
            for (int j = 0; j < VoxelBlocks::edge; ++j) {
                const Voxel from =
                    along(along(blocks.first()[b], (axis + 1) % 3, i), (axis + 2) % 3, j);
                read_line(field, blocks, from, axis, w, line);
                for (int k = 0; k < VoxelBlocks::edge; ++k) {
                    double sum = 0;
                    for (int o = -w; o <= w; ++o)
                        sum += (w + 1 - std::abs(o)) * line[static_cast<std::size_t>(k + o + w)];
                    result.block(b)[VoxelBlocks::within(along(from, axis, k))] = weight * sum;
                }
            }
    });
    return result;
}

} // namespace

VoxelField smoothed(const VoxelField& field, const VoxelBlocks& blocks, int half_width) {
    VoxelField result = field;
    for (int axis = 0; half_width > 0 && axis < 3; ++axis)
        result = smoothed_along(result, blocks, axis, half_width);
    return result;
}

VoxelBlocks widened(const VoxelBlocks& blocks, int voxels) {
    const int more = (voxels + VoxelBlocks::edge - 1) / VoxelBlocks::edge;
    std::vector<Voxel> first;
    for (const Voxel& f : blocks.first())
        for (int i = -more; i <= more; ++i)
            for (int j = -more; j <= more; ++j)
                for (int k = -more; k <= more; ++k)
                    first.push_back({f.x + i * VoxelBlocks::edge, f.y + j * VoxelBlocks::edge,
                                     f.z + k * VoxelBlocks::edge});
    return {blocks.lattice(), std::move(first)};
}

} // namespace bris
