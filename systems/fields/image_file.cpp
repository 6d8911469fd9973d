#include "systems/fields/image_file.hpp"

#include "engine/errors.hpp"
#include "engine/io/hdf5.hpp"
#include "engine/io/unfinished_file.hpp"
#include "engine/ranks.hpp"

#include <array>

namespace bris {

namespace {

std::vector<float> dense(const VoxelBlocks& blocks, const VoxelField& field,
                         const VoxelField& shown, const VoxelRange& range) {
    std::vector<float> values(range.size(0) * range.size(1) * range.size(2));
    std::size_t k = 0;
    for (int z = range.low.z; z <= range.high.z; ++z) // x counts fastest
        for (int y = range.low.y; y <= range.high.y; ++y)
            for (int x = range.low.x; x <= range.high.x; ++x, ++k)
                if (const std::uint32_t n = blocks.number({x, y, z});
                    n != VoxelBlocks::none && shown[n] != 0)
                    values[k] = static_cast<float>(field[n]);
    return values;
}

void set_grid(Hdf5File& file, const Lattice& lattice, const VoxelRange& range) {
    const std::array<std::int64_t, 2> version{1, 0};
    std::array<std::int64_t, 6> extent{};
    for (std::size_t axis = 0; axis < 3; ++axis)
        extent[2 * axis + 1] = static_cast<std::int64_t>(range.size(static_cast<int>(axis))) - 1;
    const Vec3 origin = lattice.centre(range.low);
    const std::array<double, 3> spacing{lattice.size, lattice.size, lattice.size};
    const std::array<double, 9> direction{1, 0, 0, 0, 1, 0, 0, 0, 1};
    file.make_group("/VTKHDF");
    file.set_attribute("/VTKHDF", "Version", std::span<const std::int64_t>(version));
    file.set_attribute("/VTKHDF", "Type", std::string("ImageData"));
    file.set_attribute("/VTKHDF", "WholeExtent", std::span<const std::int64_t>(extent));
    file.set_attribute("/VTKHDF", "Origin", std::span<const double>(origin.data(), 3));
    file.set_attribute("/VTKHDF", "Spacing", std::span<const double>(spacing));
    file.set_attribute("/VTKHDF", "Direction", std::span<const double>(direction));
}

} // namespace

std::size_t VoxelRange::size(int axis) const {
    const int extent = axis == 0 ? high.x - low.x : axis == 1 ? high.y - low.y : high.z - low.z;
    return static_cast<std::size_t>(extent + 1);
}

VoxelRange shown_range(const VoxelBlocks& blocks, const VoxelField& shown) {
    VoxelRange range;
    for (std::uint32_t n = 0; n < blocks.voxels(); ++n) {
        if (shown[n] == 0) continue;
        const Voxel v = blocks.voxel(n);
        if (range.empty()) range = {v, v};
        range.low = {std::min(range.low.x, v.x), std::min(range.low.y, v.y),
                     std::min(range.low.z, v.z)};
        range.high = {std::max(range.high.x, v.x), std::max(range.high.y, v.y),
                      std::max(range.high.z, v.z)};
    }
    return range;
}

void write_image(const std::filesystem::path& path, const VoxelBlocks& blocks,
                 const std::vector<FieldToWrite>& fields, double time,
                 const std::vector<NamedValue>& meta) {
    const VoxelRange range = fields.empty() ? VoxelRange{} : shown_range(blocks, *fields[0].shown);
    if (range.empty()) throw OutputError("cannot write '" + path.string() + "': no voxels to show");
    if (!Ranks::writes()) return;
    UnfinishedFile unfinished(path);
    Hdf5File file = Hdf5File::create(unfinished.path());
    set_grid(file, blocks.lattice(), range);
    const Hdf5File::Shape shape{range.size(2), range.size(1), range.size(0)};
    for (const FieldToWrite& field : fields)
        for (std::size_t k = 0; k < field.components.size(); ++k) {
            std::string dataset = "/VTKHDF/PointData/" + field.name;
            if (field.components.size() > 1) dataset += std::string("_") + "xyz"[k];
            const auto values = dense(blocks, *field.components[k], *field.shown, range);
            file.write(dataset, std::span<const float>(values), shape);
            file.set_attribute(dataset, "units", field.units);
            file.set_attribute(dataset, "quantity", field.quantity);
        }
    file.make_group("/meta");
    file.set_attribute("/meta", "time_s", time);
    for (const NamedValue& entry : meta)
        std::visit(
            [&]<class T>(const T& value) {
                if constexpr (std::same_as<T, bool>)
                    file.set_attribute<std::uint8_t>("/meta", entry.key, value ? 1 : 0);
                else
                    file.set_attribute("/meta", entry.key, value);
            },
            entry.value);
    file.close();
    unfinished.put_in_place();
}

} // namespace bris
