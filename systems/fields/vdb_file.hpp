#pragma once

#include "engine/named_value.hpp"
#include "systems/fields/voxel_field.hpp"

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace bris {

/// A grid of a .vdb file.
struct VdbField {
    VoxelBlocks blocks;
    VoxelField values;
    std::string units, quantity;
    Voxel low, high; ///< corners of the voxels that the file holds
    Box3 box() const {
        const Vec3 half = Vec3::Constant(0.5 * blocks.lattice().size);
        return {blocks.lattice().centre(low) - half, blocks.lattice().centre(high) + half};
    }
};

/// A field to be written. `shown` tells which voxels belong to it (values other than 0); the others
/// are left out.
struct FieldToWrite {
    std::string name, units, quantity;         ///< quantity: one sentence
    std::vector<const VoxelField*> components; ///< one, or three of a vector
    const VoxelField* shown;
};

/// Writes grids of single precision to NAME.vdb: fog volumes whose voxel centres lie at integer
/// indices, with the metadata `units`, `quantity` and `time` (s). A vector is a grid of vectors,
/// and a velocity for programs that tell them apart. `meta` belongs to the file as a whole. The
/// file is replaced completely or not at all. Throws OutputError.
void write_vdb(const std::filesystem::path& path, const VoxelBlocks& blocks,
               const std::vector<FieldToWrite>& fields, double time,
               const std::vector<NamedValue>& meta);

/// Reads a grid of numbers of single or double precision with cubic voxels, in a child process with
/// limits of memory and time, because the library takes gigabytes for damaged ones. Throws
/// InputError if the file is no .vdb file, is truncated, lacks the grid, or claims more blocks of
/// voxels than 10 240 and one for each 64 bytes; OutputError if it cannot be read.
VdbField read_vdb(const std::filesystem::path& path, const std::string& grid);
/// The same, or nothing if the file lacks the grid.
std::optional<VdbField> find_vdb(const std::filesystem::path& path, const std::string& grid);

} // namespace bris
