#include "systems/fields/vdb_file.hpp"

#include "engine/errors.hpp"
#include "engine/io/limited_child.hpp"
#include "engine/io/unfinished_file.hpp"
#include "engine/io/whole_file.hpp"
#include "engine/ranks.hpp"

#include <fmt/format.h>
#include <openvdb/io/Stream.h>
#include <openvdb/openvdb.h>

#include <algorithm>
#include <fstream>
#include <system_error>

namespace bris {

namespace {

void set_metadata(openvdb::GridBase& grid, const FieldToWrite& field, const Lattice& lattice,
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
    set_metadata(*grid, field, blocks.lattice(), time);
    return grid;
}

// The library crashes on some damaged files and takes gigabytes for others, so a child process
// reads a file and passes the numbers on.

using Pipe = LimitedChild::Pipe;
enum class Answer : int { refused, no_such_grid, grid };

/// Place of a grid and its blocks, as they pass through the pipe.
struct Head {
    Lattice lattice;
    Voxel low, high;
    std::uint64_t blocks;
};

/// Blocks that a grid may have, and its extent in blocks. A file of leaves has more than 64 bytes
/// for each, but a tile, a block of equal values, may claim any size.
constexpr std::uint64_t least_blocks = 10'240, most_extent = std::uint64_t{1} << 22;
std::uint64_t most_blocks(std::uint64_t file_size) { return least_blocks + file_size / 64; }

void send_text(Pipe& pipe, const std::string& text) {
    const std::uint64_t size = text.size();
    pipe.write(&size, sizeof size);
    pipe.write(text.data(), text.size());
}

void send(Pipe& pipe, Answer answer, const std::string& text) {
    pipe.write(&answer, sizeof answer);
    send_text(pipe, text);
}

std::string receive_text(LimitedChild& child) {
    std::uint64_t size = 0;
    child.read(&size, sizeof size);
    if (size > (1u << 20)) throw OutputError("its texts are too long");
    std::string text(size, ' ');
    child.read(text.data(), text.size());
    return text;
}

template <class Grid>
Lattice lattice_of(const Grid& grid, const std::string& where) {
    const auto& transform = grid.transform();
    require(transform.isLinear() && transform.hasUniformScale(),
            where + ": expected cubic voxels along the axes, found another transform");
    const openvdb::Vec3d origin = transform.indexToWorld(openvdb::Vec3d(0, 0, 0));
    const Lattice lattice{{origin.x(), origin.y(), origin.z()}, transform.voxelSize().x()};
    const openvdb::Vec3d x = transform.indexToWorld(openvdb::Vec3d(1, 0, 0)) - origin;
    require(std::abs(x.x() - lattice.size) <= 1e-9 * lattice.size && lattice.origin.allFinite(),
            where + ": expected cubic voxels along the axes, found rotated ones");
    return lattice;
}

/// First voxels of the blocks of a grid.
template <class Grid>
std::vector<Voxel> blocks_of(const Grid& grid, const openvdb::CoordBBox& box, std::uint64_t most,
                             const std::string& where) {
    const auto extent = [](int low, int high) { return (high >> 3) - double(low >> 3) + 1; };
    const openvdb::Coord low = box.min(), high = box.max();
    const double all =
        extent(low.x(), high.x()) * extent(low.y(), high.y()) * extent(low.z(), high.z());
    require(all <= static_cast<double>(most_extent),
            fmt::format("{}: expected an extent of at most {} blocks of 8 x 8 x 8 voxels, found "
                        "{:.3g}",
                        where, most_extent, all));
    std::vector<Voxel> first;
    // tiles of equal values are larger than blocks
    for (auto value = grid.cbeginValueOn(); value; ++value) {
        const openvdb::CoordBBox part = value.getBoundingBox();
        for (int i = part.min().x() >> 3; i <= part.max().x() >> 3; ++i)
            for (int j = part.min().y() >> 3; j <= part.max().y() >> 3; ++j)
                for (int k = part.min().z() >> 3; k <= part.max().z() >> 3; ++k)
                    if (const Voxel v{i * 8, j * 8, k * 8}; first.empty() || first.back() != v)
                        first.push_back(v);
        require(first.size() <= 8 * most,
                fmt::format("{}: expected at most {} blocks of 8 x 8 x 8 voxels, found more", where,
                            most));
    }
    return first;
}

template <class Grid>
void send_grid(Pipe& pipe, const Grid& grid, std::uint64_t most, const std::string& where) {
    const openvdb::CoordBBox box = grid.evalActiveVoxelBoundingBox();
    require(!box.empty(), where + ": expected values, found none");
    const VoxelBlocks blocks(lattice_of(grid, where), blocks_of(grid, box, most, where));
    require(blocks.count() <= most,
            fmt::format("{}: expected at most {} blocks of 8 x 8 x 8 voxels, found {}", where, most,
                        blocks.count()));
    const auto text = [&](const char* key) {
        const auto found = grid.template getMetadata<openvdb::StringMetadata>(key);
        return found ? found->value() : std::string();
    };
    const Head head{blocks.lattice(),
                    {box.min().x(), box.min().y(), box.min().z()},
                    {box.max().x(), box.max().y(), box.max().z()},
                    blocks.count()};
    send(pipe, Answer::grid, text("units"));
    send_text(pipe, text("quantity"));
    pipe.write(&head, sizeof head);
    pipe.write(blocks.first().data(), blocks.count() * sizeof(Voxel));
    const auto accessor = grid.getConstAccessor();
    for (std::uint32_t n = 0; n < blocks.voxels(); ++n) {
        const Voxel v = blocks.voxel(n);
        const auto number = static_cast<double>(accessor.getValue({v.x, v.y, v.z}));
        pipe.write(&number, sizeof number);
    }
}

/// All grids of a file: a truncated file is found out even if the grid wanted is complete.
openvdb::GridPtrVec grids_of(const std::filesystem::path& path) {
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

/// Sends the grid of a name, the names of all if there is none, or why it cannot be used.
void answer(Pipe& pipe, const std::filesystem::path& path, const std::string& name,
            std::uint64_t most) {
    try {
        // never freed: the library does so with threads, which this process does not have
        auto& grids = *new openvdb::GridPtrVec(grids_of(path));
        std::string names;
        for (const auto& grid : grids) {
            names += (names.empty() ? "" : ", ") + grid->getName();
            if (grid->getName() != name) continue;
            const std::string where = fmt::format("{}: grid {}", path.string(), name);
            if (const auto single = openvdb::gridPtrCast<openvdb::FloatGrid>(grid))
                return send_grid(pipe, *single, most, where);
            if (const auto exact = openvdb::gridPtrCast<openvdb::DoubleGrid>(grid))
                return send_grid(pipe, *exact, most, where);
            throw InputError(fmt::format("{}: expected numbers, found values of type {}", where,
                                         grid->valueType()));
        }
        send(pipe, Answer::no_such_grid, names.empty() ? "none" : names);
    } catch (const InputError& refusal) {
        send(pipe, Answer::refused, refusal.what());
    }
}

VdbField receive_field(LimitedChild& child, std::string units, std::uint64_t most) {
    VdbField field;
    field.units = std::move(units);
    field.quantity = receive_text(child);
    Head head{};
    child.read(&head, sizeof head);
    if (head.blocks > most) throw OutputError("it has too many blocks");
    std::vector<Voxel> first(head.blocks);
    child.read(first.data(), first.size() * sizeof(Voxel));
    field.blocks = VoxelBlocks(head.lattice, std::move(first));
    field.values = VoxelField(field.blocks);
    field.low = head.low;
    field.high = head.high;
    for (std::size_t b = 0; b < field.blocks.count(); ++b)
        child.read(field.values.block(b), VoxelBlocks::voxels_each * sizeof(double));
    return field;
}

/// The grid of a name, or the names of all grids.
struct Found {
    std::optional<VdbField> field;
    std::string names;
};

Found read_grid(const std::filesystem::path& path, const std::string& name) {
    if (!std::filesystem::is_regular_file(path))
        throw OutputError(fmt::format("cannot read '{}': no such file", path.string()));
    openvdb::initialize();
    const std::uint64_t size = std::filesystem::file_size(path), most = most_blocks(size);
    // the file is compressed
    LimitedChild child({.bytes = (std::uint64_t{64} << 20) + 1000 * size,
                        .seconds = 1 + static_cast<unsigned>(size / 2'000'000)},
                       [&](Pipe& pipe) { answer(pipe, path, name, most); });
    try {
        Answer answer{};
        child.read(&answer, sizeof answer);
        std::string text = receive_text(child);
        if (answer == Answer::refused) throw InputError(text);
        if (answer == Answer::no_such_grid) return {std::nullopt, text};
        return {receive_field(child, std::move(text), most), ""};
    } catch (const OutputError& problem) {
        throw OutputError(fmt::format("cannot read '{}': {}", path.string(), problem.what()));
    }
}

} // namespace

void write_vdb(const std::filesystem::path& name, const VoxelBlocks& blocks,
               const std::vector<FieldToWrite>& fields, double time,
               const std::vector<NamedValue>& meta) {
    if (!Ranks::writes()) return;
    const std::filesystem::path path = file_to_write(name);
    openvdb::initialize();
    openvdb::GridPtrVec grids;
    for (const FieldToWrite& field : fields) grids.push_back(to_vdb(field, blocks, time));
    openvdb::MetaMap all;
    all.insertMeta("creator", openvdb::StringMetadata("BRIS"));
    for (const NamedValue& entry : meta)
        all.insertMeta(entry.key,
                       openvdb::StringMetadata(std::visit(
                           [](const auto& v) { return fmt::format("{}", v); }, entry.value)));
    try {
        UnfinishedFile unfinished(path);
        openvdb::io::File file(unfinished.path().string());
        file.setCompression(openvdb::io::COMPRESS_ZIP | openvdb::io::COMPRESS_ACTIVE_MASK);
        file.write(grids, all);
        file.close();
        unfinished.put_in_place();
    } catch (const std::exception& why) {
        throw OutputError(fmt::format("cannot write '{}': {}", path.string(), why.what()));
    }
}

std::optional<VdbField> find_vdb(const std::filesystem::path& path, const std::string& name) {
    return read_grid(path, name).field;
}

VdbField read_vdb(const std::filesystem::path& path, const std::string& name) {
    Found found = read_grid(path, name);
    if (found.field) return std::move(*found.field);
    throw InputError(
        fmt::format("{}: expected a grid '{}', found {}", path.string(), name, found.names));
}

} // namespace bris
