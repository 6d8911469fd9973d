#pragma once

#include "components/sphere.hpp"
#include "systems/fields/container.hpp"
#include "systems/fields/voxel_field.hpp"

#include <cstdint>
#include <vector>

namespace bris::detail {

/// Measures the union of spheres in the blocks [first, last), which stand above each other, along
/// samples x samples vertical lines through each voxel.
class ColumnOfBlocks {
public:
    ColumnOfBlocks(const VoxelBlocks& blocks, std::uint32_t first, std::uint32_t last, int samples);

    void add(const SphereRow& sphere);
    /// Writes the fractions of the voxels of these blocks; to `voids` only with a container.
    /// Returns the volume (m3) by which the even lines differ from the odd ones.
    double measure(const Container* container, VoxelField& solid, VoxelField& error,
                   VoxelField& voids);

private:
    /// A part of the union on one line.
    struct Part {
        std::uint32_t line;
        double low, high;
    };
    void extend(std::uint32_t line, double low, double high);
    void sort_parts();
    void unite(std::uint32_t line, std::vector<Stretch>& parts) const;
    void deposit(std::vector<double>& lengths, std::size_t column, double low, double high,
                 double weight = 1) const;
    void write(const std::vector<double>& even, const std::vector<double>& odd, VoxelField& solid,
               VoxelField& error, double& difference) const;
    void write_voids(const std::vector<double>& lengths, VoxelField& voids) const;

    const VoxelBlocks& blocks_;
    std::uint32_t first_, last_;
    int samples_, lines_; // lines along an edge of the column
    std::size_t height_;  // voxels
    double pitch_;
    Vec3 corner_;
    std::vector<Stretch> current_; // of each line; low > high: none
    std::vector<Part> parts_;
    std::vector<std::uint32_t> line_first_;
    std::vector<Stretch> sorted_;
};

} // namespace bris::detail
