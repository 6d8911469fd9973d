#pragma once

#include "systems/fields/body_spheres.hpp"
#include "systems/fields/container.hpp"
#include "systems/fields/voxel_field.hpp"

#include <optional>

namespace bris {

/// A volume and the estimate of its error, m3.
struct MeasuredVolume {
    double value = 0, error = 0;
};

/// The share of every voxel that rocks fill: that of the exact union of all spheres, in which
/// overlaps count once. Along z the union is exact; across it, each voxel has samples x samples
/// lines. The error of the volume of one sphere of radius r falls as (size / (samples r))^1.5, and
/// that of many rocks much faster, because the errors of single rocks have either sign. The error
/// is estimated from the difference between the even and the odd lines of a checkerboard.
///
/// The same bits result for any number of threads and any order of rows, and whether the fields
/// were made anew or brought up to date: only columns of blocks in which a rock has moved, appeared
/// or left are computed again.
class SolidFraction {
public:
    SolidFraction() = default;
    /// `samples`: lines along each edge of a voxel, from 2 to 64.
    explicit SolidFraction(const Lattice& lattice, int samples = 3)
        : lattice_(lattice), samples_(samples) {}

    /// Brings the fields up to date. The blocks cover the rocks and the `covered` box. With a
    /// container, its voids within these blocks are computed too.
    void update(const World& world, const Container* container = nullptr,
                const Box3* covered = nullptr);
    void update(const BodySpheres& bodies, const Container* container = nullptr,
                const Box3* covered = nullptr);

    const VoxelBlocks& blocks() const { return blocks_; }
    const Lattice& lattice() const { return lattice_; }
    int samples() const { return samples_; }
    const VoxelField& solid() const { return solid_; } ///< fraction of each voxel, in [0, 1]
    /// Estimated error of that fraction.
    const VoxelField& error() const { return error_; }
    /// Fraction of each voxel that lies in the container and outside all rocks. Empty without one.
    const VoxelField& voids() const { return voids_; }
    /// Volume of all rocks.
    MeasuredVolume volume() const;
    /// Columns of blocks that the last update computed, and all of them.
    std::size_t computed_columns() const { return computed_; }
    std::size_t columns() const { return column_first_.empty() ? 0 : column_first_.size() - 1; }

private:
    void set_blocks(const BodySpheres& bodies, bool with_voids, const Box3* covered);
    std::vector<char> columns_to_compute(const BodySpheres& bodies, const Container* container);
    template <class Visit>
    void for_columns_of(const Box3& box, Visit&& visit) const;

    Lattice lattice_;
    int samples_ = 3;
    VoxelBlocks blocks_;
    VoxelField solid_, error_, voids_;
    std::vector<std::uint32_t> column_first_; ///< first block of each column of blocks, and the end
    std::vector<double> difference_;          ///< m3, even minus odd lines, by column
    std::vector<Pose> pose_;                  ///< of the last update, by body
    std::vector<Box3> box_;
    std::optional<Container> container_;
    std::size_t computed_ = 0;
};

} // namespace bris
