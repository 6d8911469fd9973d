#include "systems/fields/solid_fraction.hpp"

#include "engine/parallel.hpp"
#include "systems/fields/column_of_blocks.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace bris {

namespace {

bool same_pose(const Pose& a, const Pose& b) {
    return a.position == b.position && a.orientation.coeffs() == b.orientation.coeffs();
}

} // namespace

void SolidFraction::update(const World& world, const Container* container, const Box3* covered) {
    update(spheres_of_bodies(world), container, covered);
}

// calls visit(column) for the columns of blocks that a box overlaps
template <class Visit>
void SolidFraction::for_columns_of(const Box3& box, Visit&& visit) const {
    const Voxel low = lattice_.voxel_of(box.low), high = lattice_.voxel_of(box.high);
    const auto& at = blocks_.first();
    for (int i = low.x >> 3; i <= high.x >> 3; ++i) {
        const auto less = [&](std::uint32_t block, const Voxel& v) { return at[block] < v; };
        const Voxel from{i * VoxelBlocks::edge, (low.y >> 3) * VoxelBlocks::edge,
                         std::numeric_limits<int>::min()};
        auto column = std::lower_bound(column_first_.begin(), column_first_.end() - 1, from, less);
        for (; column != column_first_.end() - 1; ++column) {
            if (at[*column].x != i * VoxelBlocks::edge || at[*column].y >> 3 > high.y >> 3) break;
            visit(static_cast<std::size_t>(column - column_first_.begin()));
        }
    }
}

void SolidFraction::set_blocks(const BodySpheres& bodies, bool with_voids, const Box3* covered) {
    std::vector<Box3> boxes;
    for (std::size_t b = 0; b < bodies.bodies(); ++b)
        if (bodies.has_spheres(b)) boxes.push_back(bodies.box[b]);
    if (covered != nullptr) boxes.push_back(*covered);
    VoxelBlocks blocks(lattice_, boxes);
    if (blocks == blocks_ && (voids_.blocks() > 0) == with_voids) return;
    pose_.clear(); // everything is computed anew
    blocks_ = std::move(blocks);
    solid_ = VoxelField(blocks_);
    error_ = VoxelField(blocks_);
    voids_ = with_voids ? VoxelField(blocks_) : VoxelField();
    column_first_ = blocks_.columns();
    difference_.assign(columns(), 0);
}

std::vector<char> SolidFraction::columns_to_compute(const BodySpheres& bodies,
                                                    const Container* container) {
    const bool anew = pose_.size() != bodies.bodies() ||
                      (container != nullptr && !(container_ && *container == *container_));
    std::vector<char> chosen(columns(), anew ? 1 : 0);
    const auto choose = [&](std::size_t column) { chosen[column] = 1; };
    for (std::size_t b = 0; !anew && b < bodies.bodies(); ++b) {
        if (!bodies.has_spheres(b) || same_pose(bodies.pose[b], pose_[b])) continue;
        for_columns_of(box_[b], choose);
        for_columns_of(bodies.box[b], choose);
    }
    pose_ = bodies.pose;
    box_ = bodies.box;
    if (container != nullptr) container_ = *container;
    return chosen;
}

void SolidFraction::update(const BodySpheres& bodies, const Container* container,
                           const Box3* covered) {
    set_blocks(bodies, container != nullptr, covered);
    const std::vector<char> chosen = columns_to_compute(bodies, container);
    // bodies of each column that is computed
    std::vector<std::vector<Row>> in_column(columns());
    for (Row b = 0; b < bodies.bodies(); ++b)
        if (bodies.has_spheres(b))
            for_columns_of(bodies.box[b], [&](std::size_t c) {
                if (chosen[c] != 0) in_column[c].push_back(b);
            });
    std::vector<std::size_t> list;
    for (std::size_t c = 0; c < columns(); ++c)
        if (chosen[c] != 0) list.push_back(c);
    computed_ = list.size();
    for_chunks(list.size(), 1, [&](std::size_t k, std::size_t, std::size_t) {
        const std::size_t c = list[k];
        detail::ColumnOfBlocks column(blocks_, column_first_[c], column_first_[c + 1], samples_);
        for (const Row b : in_column[c])
            for (Row s = bodies.first[b]; s < bodies.first[b + 1]; ++s)
                column.add(bodies.spheres[s]);
        difference_[c] = column.measure(container, solid_, error_, voids_);
    });
}

MeasuredVolume SolidFraction::volume() const {
    double difference = 0; // in the order of the columns
    for (const double d : difference_) difference += d;
    return {lattice_.volume() * solid_.sum(), 0.5 * std::abs(difference)};
}

} // namespace bris
