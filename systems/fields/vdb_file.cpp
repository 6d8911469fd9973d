#include "systems/fields/vdb_file.hpp"

#include "engine/errors.hpp"

#include <fmt/format.h>
#include <openvdb/io/Stream.h>
#include <openvdb/openvdb.h>

#include <algorithm>
#include <fstream>
#include <system_error>
#include <unistd.h>

namespace bris {

namespace {

void describe(openvdb::GridBase& grid, const FieldToWrite& field, const Lattice& lattice,
              double time) {
    auto transform = openvdb::math::Transform::createLinearTransform(lattice.size);
    transform->postTranslate({lattice.origin.x(), lattice.origin.y(), lattice.origin.z()});
    grid.setTransform(transform);
    grid.setName(field.name);
    grid.setGridClass(openvdb::GRID_FOG_VOLUME);
    grid.insertMeta("units", openvdb::StringMetadata(field.units));
    grid.insertMeta("quantity", openvdb::StringMetadata(field.quantity));
    grid.insertMeta("time", openvdb::DoubleMetadata(time));
    grid.setCreator("BRIS");
}

/// A grid of the voxels that `shown` does not leave out; value(number) gives what it holds.
template <class Grid, class Value>
openvdb::GridBase::Ptr grid_of(const VoxelBlocks& blocks, const VoxelField& shown, Value&& value) {
    auto grid = Grid::create();
    for (std::size_t b = 0; b < blocks.count(); ++b) {
        const double* show = shown.block(b);
        if (std::all_of(show, show + VoxelBlocks::voxels_each, [](double x) { return x == 0; }))
            continue;
        const Voxel& first = blocks.first()[b];
        auto* leaf = grid->tree().touchLeaf({first.x, first.y, first.z});
        for (openvdb::Index k = 0; k < VoxelBlocks::voxels_each; ++k)
            if (show[k] != 0)
                leaf->setValueOn(
                    k, value(static_cast<std::uint32_t>(b * VoxelBlocks::voxels_each + k)));
    }
    return grid;
}

openvdb::GridBase::Ptr to_vdb(const FieldToWrite& field, const VoxelBlocks& blocks, double time) {
    const auto number = [&](std::size_t component, std::uint32_t n) {
        return static_cast<float>((*field.components[component])[n]);
    };
    openvdb::GridBase::Ptr grid;
    if (field.components.size() == 1) {
        grid = grid_of<openvdb::FloatGrid>(blocks, *field.shown,
                                           [&](std::uint32_t n) { return number(0, n); });
    } else {
        grid = grid_of<openvdb::Vec3SGrid>(blocks, *field.shown, [&](std::uint32_t n) {
            return openvdb::Vec3s(number(0, n), number(1, n), number(2, n));
        });
        grid->setVectorType(openvdb::VEC_CONTRAVARIANT_RELATIVE);
    }
    describe(*grid, field, blocks.lattice(), time);
    return grid;
}

template <class Grid>
VdbField from_vdb(const Grid& grid, const std::string& where) {
    const auto& transform = grid.transform();
    require(transform.isLinear() && transform.hasUniformScale(),
            where + ": expected cubic voxels along the axes, found another transform");
    const openvdb::Vec3d origin = transform.indexToWorld(openvdb::Vec3d(0, 0, 0));
    const Lattice lattice{{origin.x(), origin.y(), origin.z()}, transform.voxelSize().x()};
    const openvdb::Vec3d x = transform.indexToWorld(openvdb::Vec3d(1, 0, 0)) - origin;
    require(std::abs(x.x() - lattice.size) <= 1e-9 * lattice.size,
            where + ": expected cubic voxels along the axes, found rotated ones");
    const openvdb::CoordBBox box = grid.evalActiveVoxelBoundingBox();
    require(!box.empty(), where + ": expected values, found none");
    std::vector<Voxel> first;
    // tiles of equal values are larger than blocks
    for (auto value = grid.cbeginValueOn(); value; ++value) {
        const openvdb::CoordBBox part = value.getBoundingBox();
        for (int i = part.min().x() >> 3; i <= part.max().x() >> 3; ++i)
            for (int j = part.min().y() >> 3; j <= part.max().y() >> 3; ++j)
                for (int k = part.min().z() >> 3; k <= part.max().z() >> 3; ++k)
                    if (const Voxel v{i * 8, j * 8, k * 8}; first.empty() || first.back() != v)
                        first.push_back(v);
    }
    VdbField field;
    field.blocks = VoxelBlocks(lattice, std::move(first));
    field.values = VoxelField(field.blocks);
    field.low = {box.min().x(), box.min().y(), box.min().z()};
    field.high = {box.max().x(), box.max().y(), box.max().z()};
    const auto accessor = grid.getConstAccessor();
    for (std::uint32_t n = 0; n < field.blocks.voxels(); ++n) {
        const Voxel v = field.blocks.voxel(n);
        field.values[n] = static_cast<double>(accessor.getValue({v.x, v.y, v.z}));
    }
    if (const auto units = grid.template getMetadata<openvdb::StringMetadata>("units"))
        field.units = units->value();
    if (const auto quantity = grid.template getMetadata<openvdb::StringMetadata>("quantity"))
        field.quantity = quantity->value();
    return field;
}

/// All grids of a file: a truncated file is found out even if the grid wanted is complete.
openvdb::GridPtrVec grids_of(const std::filesystem::path& path) {
    openvdb::initialize();
    if (!std::filesystem::is_regular_file(path))
        throw OutputError(fmt::format("cannot read '{}': no such file", path.string()));
    try {
        std::ifstream file(path, std::ios::binary);
        // not by openvdb::io::File, which does not notice that a file ends too early
        openvdb::io::Stream stream(file, false);
        if (!file) throw std::runtime_error("the file ends too early");
        return *stream.getGrids();
    } catch (const std::exception& why) {
        throw InputError(
            fmt::format("{}: expected a complete .vdb file, found: {}", path.string(), why.what()));
    }
}

} // namespace

void write_vdb(const std::filesystem::path& path, const VoxelBlocks& blocks,
               const std::vector<FieldToWrite>& fields, double time,
               const std::vector<NamedValue>& meta) {
    openvdb::initialize();
    openvdb::GridPtrVec grids;
    for (const FieldToWrite& field : fields) grids.push_back(to_vdb(field, blocks, time));
    openvdb::MetaMap all;
    all.insertMeta("creator", openvdb::StringMetadata("BRIS"));
    for (const NamedValue& entry : meta)
        all.insertMeta(entry.key,
                       openvdb::StringMetadata(std::visit(
                           [](const auto& v) { return fmt::format("{}", v); }, entry.value)));
    std::filesystem::path unfinished = path;
    unfinished += fmt::format(".{}.tmp", getpid());
    std::error_code error;
    try {
        openvdb::io::File file(unfinished.string());
        file.setCompression(openvdb::io::COMPRESS_ZIP | openvdb::io::COMPRESS_ACTIVE_MASK);
        file.write(grids, all);
        file.close();
        std::filesystem::rename(unfinished, path);
    } catch (const std::exception& why) {
        std::filesystem::remove(unfinished, error);
        throw OutputError(fmt::format("cannot write '{}': {}", path.string(), why.what()));
    }
}

std::optional<VdbField> find_vdb(const std::filesystem::path& path, const std::string& name) {
    const openvdb::GridPtrVec grids = grids_of(path);
    const auto found = std::ranges::find_if(
        grids, [&](const openvdb::GridBase::Ptr& g) { return g->getName() == name; });
    if (found == grids.end()) return std::nullopt;
    const openvdb::GridBase::Ptr grid = *found;
    const std::string where = fmt::format("{}: grid {}", path.string(), name);
    if (const auto single = openvdb::gridPtrCast<openvdb::FloatGrid>(grid))
        return from_vdb(*single, where);
    if (const auto exact = openvdb::gridPtrCast<openvdb::DoubleGrid>(grid))
        return from_vdb(*exact, where);
    throw InputError(
        fmt::format("{}: expected numbers, found values of type {}", where, grid->valueType()));
}

VdbField read_vdb(const std::filesystem::path& path, const std::string& name) {
    auto found = find_vdb(path, name);
    if (found) return std::move(*found);
    std::string names;
    for (const auto& grid : grids_of(path)) names += (names.empty() ? "" : ", ") + grid->getName();
    throw InputError(fmt::format("{}: expected a grid '{}', found {}", path.string(), name,
                                 names.empty() ? "none" : names));
}

} // namespace bris
