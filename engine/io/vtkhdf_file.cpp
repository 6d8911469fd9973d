#include "engine/io/vtkhdf_file.hpp"

#include "engine/version.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <concepts>
#include <numeric>
#include <stdexcept>
#include <variant>

namespace bris {

namespace {

const std::string root = "/VTKHDF/", steps = root + "Steps/";
constexpr std::uint64_t numbers_per_chunk = 256; // of arrays with a number for each frame

void append_one(Hdf5File& file, const std::string& dataset, std::uint64_t value) {
    const auto number = static_cast<std::int64_t>(value);
    file.append(dataset, std::span<const std::int64_t>(&number, 1));
}

std::string path_of(const VtkhdfFile::Array& array) {
    return (array.on == VtkhdfFile::On::points ? "PointData/" : "CellData/") + array.name;
}

/// Dataset with the rows at which the frames begin in an array.
std::string offsets_of(const VtkhdfFile::Array& array) {
    return steps + (array.on == VtkhdfFile::On::points ? "PointDataOffsets/" : "CellDataOffsets/") +
           array.name;
}

} // namespace

VtkhdfFile::VtkhdfFile(const std::filesystem::path& path)
    : file_(Hdf5File::create(path)), list_(path) {
    const std::vector<std::int64_t> version{2, 0};
    file_.make_group("/VTKHDF");
    file_.set_attribute("/VTKHDF", "Version", std::span<const std::int64_t>(version));
    file_.set_attribute("/VTKHDF", "Type", std::string("UnstructuredGrid"));
    for (const char* name : {"NumberOfPoints", "NumberOfCells", "NumberOfConnectivityIds"})
        file_.make_growing<std::int64_t>(root + name, {}, 16);
    for (const char* name : {"PartOffsets", "NumberOfParts", "PointOffsets"})
        file_.make_growing<std::int64_t>(steps + name, {}, numbers_per_chunk);
    for (const char* name : {"CellOffsets", "ConnectivityIdOffsets"}) // one column per topology
        file_.make_growing<std::int64_t>(steps + name, {1}, numbers_per_chunk);
    file_.make_growing<double>(steps + "Values", {}, numbers_per_chunk);
    file_.set_attribute(steps + "Values", "unit", std::string("s"));
    file_.make_group(root + "PointData");
    file_.make_group(steps + "PointDataOffsets");
    file_.set_attribute<std::int64_t>("/VTKHDF/Steps", "NSteps", 0);
    file_.make_group("/meta");
    add_meta(version_entries());
}

void VtkhdfFile::add_meta(const std::vector<NamedValue>& entries) {
    for (const NamedValue& entry : entries)
        std::visit(
            [&]<class T>(const T& value) {
                if constexpr (std::same_as<T, bool>)
                    file_.set_attribute<std::uint8_t>("/meta", entry.key, value ? 1 : 0);
                else
                    file_.set_attribute("/meta", entry.key, value);
            },
            entry.value);
}

void VtkhdfFile::begin_part(const std::vector<XdmfFile::Block>& blocks, std::size_t usual_points,
                            std::size_t usual_cells, std::span<const std::int64_t> connectivity) {
    if (!connectivity.empty() && blocks.size() != 1)
        throw std::logic_error("only a single block has points that cells share");
    if (parts_ == 0) {
        usual_points_ = usual_points;
        usual_cells_ = usual_cells;
        file_.make_growing<float>(root + "Points", {3}, usual_points);
        file_.set_attribute(root + "Points", "unit", std::string("m"));
        file_.make_growing<std::int64_t>(root + "Connectivity", {},
                                         std::max(usual_points, connectivity.size()));
        file_.make_growing<std::int64_t>(root + "Offsets", {}, usual_cells + 1);
        file_.make_growing<std::uint8_t>(root + "Types", {}, usual_cells);
    }
    cells_before_ += part_cells_;
    connectivity_before_ += part_corners_;
    ++parts_;
    blocks_ = blocks;
    part_points_ = 0;
    std::vector<std::int64_t> offsets{0};
    std::vector<std::uint8_t> types;
    for (const XdmfFile::Block& block : blocks) {
        part_points_ += block.points;
        for (std::uint64_t cell = 0; cell < block.cells; ++cell) {
            offsets.push_back(offsets.back() + static_cast<std::int64_t>(corners_of(block.kind)));
            types.push_back(static_cast<std::uint8_t>(block.kind));
        }
    }
    part_cells_ = types.size();
    part_corners_ = static_cast<std::size_t>(offsets.back());
    std::vector<std::int64_t> in_order(connectivity.empty() ? part_corners_ : 0);
    std::iota(in_order.begin(), in_order.end(), std::int64_t{0});
    file_.append(root + "Connectivity",
                 connectivity.empty() ? std::span<const std::int64_t>(in_order) : connectivity);
    file_.append(root + "Offsets", std::span<const std::int64_t>(offsets));
    file_.append(root + "Types", std::span<const std::uint8_t>(types));
    append_one(file_, root + "NumberOfPoints", part_points_);
    append_one(file_, root + "NumberOfCells", part_cells_);
    append_one(file_, root + "NumberOfConnectivityIds", part_corners_);
}

VtkhdfFile::Written& VtkhdfFile::written(const Array& array, bool integer) {
    const auto [found, is_new] = arrays_.try_emplace(path_of(array));
    Written& w = found->second;
    if (is_new) {
        if (frames_ > 0)
            throw std::logic_error("array '" + array.name + "' was added after the first frame");
        w = {array, integer};
        const std::string path = root + path_of(array);
        const Hdf5File::Shape row =
            array.components > 1 ? Hdf5File::Shape{array.components} : Hdf5File::Shape{};
        const std::size_t chunk = array.on == On::points ? usual_points_ : usual_cells_;
        if (integer)
            file_.make_growing<std::int64_t>(path, row, chunk);
        else
            file_.make_growing<float>(path, row, chunk);
        file_.set_attribute(path, "unit", array.unit);
        file_.make_growing<std::int64_t>(offsets_of(array), {}, numbers_per_chunk);
    }
    if (w.array.components != array.components || w.integer != integer ||
        w.array.fixed != array.fixed)
        throw std::logic_error("array '" + array.name + "' has changed its type");
    w.start = w.rows;
    w.rows += array.on == On::points ? part_points_ : part_cells_;
    w.frame = frames_;
    return w;
}

template <class T>
void VtkhdfFile::put_values(const Array& array, std::span<const T> values) {
    const std::size_t rows = array.on == On::points ? part_points_ : part_cells_;
    if (parts_ == 0 || values.size() != rows * array.components)
        throw std::logic_error(
            fmt::format("array '{}': {} values for {} rows", array.name, values.size(), rows));
    written(array, std::same_as<T, std::int64_t>);
    file_.append(root + path_of(array), values);
}

void VtkhdfFile::put(const Array& array, std::span<const float> values) {
    put_values(array, values);
}
void VtkhdfFile::put(const Array& array, std::span<const std::int64_t> values) {
    put_values(array, values);
}

void VtkhdfFile::put_points(std::span<const float> coordinates) {
    if (parts_ == 0 || coordinates.size() != 3 * part_points_)
        throw std::logic_error("the frame has other points than begin_part declared");
    file_.append(root + "Points", coordinates);
    point_start_ = points_written_;
    points_written_ += part_points_;
}

void VtkhdfFile::append_step(double time) {
    // the part index counts sets of cells, not frames, because readers add it to the start of
    // Offsets
    file_.append(steps + "Values", std::span<const double>(&time, 1));
    append_one(file_, steps + "PartOffsets", parts_ - 1);
    append_one(file_, steps + "NumberOfParts", 1);
    append_one(file_, steps + "PointOffsets", point_start_);
    append_one(file_, steps + "CellOffsets", cells_before_);
    append_one(file_, steps + "ConnectivityIdOffsets", connectivity_before_);
    for (const auto& [path, w] : arrays_) append_one(file_, offsets_of(w.array), w.start);
}

void VtkhdfFile::end_frame(double time) {
    for (const auto& [path, w] : arrays_)
        if (!w.array.fixed && w.frame != frames_)
            throw std::logic_error("the frame has no array '" + w.array.name + "'");
    append_step(time);
    file_.flush();
    // the frame counts only from here on: a crash before this line leaves the file as it was
    ++frames_;
    file_.set_attribute("/VTKHDF/Steps", "NSteps", static_cast<std::int64_t>(frames_));
    file_.flush();
    list_frame(time);
}

void VtkhdfFile::list_frame(double time) {
    std::vector<XdmfFile::Array> data;
    for (const auto& [path, w] : arrays_)
        data.push_back({root + path, w.array.name, w.array.components, w.integer, w.start, w.rows,
                        w.array.on == On::cells});
    list_.add({.time = time,
               .blocks = blocks_,
               .points = {root + "Points", "", 3, false, point_start_, points_written_},
               .connectivity = {root + "Connectivity", "", 1, true, connectivity_before_,
                                connectivity_before_ + part_corners_},
               .data = data});
}

} // namespace bris
