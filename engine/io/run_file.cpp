#include "engine/io/run_file.hpp"

#include "engine/errors.hpp"
#include "engine/version.hpp"

#include <fmt/format.h>

#include <numeric>
#include <stdexcept>

namespace bris {

namespace {

constexpr std::uint8_t vtk_vertex = 1, vtk_quad = 9;
const std::string point_data = "/VTKHDF/PointData/";
const std::string data_offsets = "/VTKHDF/Steps/PointDataOffsets/";
constexpr std::size_t rows_kept = 256; // rows of a track that are kept before they are written

void append_one(Hdf5File& file, const std::string& dataset, std::int64_t value) {
    file.append(dataset, std::span<const std::int64_t>(&value, 1));
}

} // namespace

RunFile::RunFile(const std::filesystem::path& path) : file_(Hdf5File::create(path)), list_(path) {
    const std::vector<std::int64_t> version{2, 0};
    file_.make_group("/VTKHDF");
    file_.set_attribute("/VTKHDF", "Version", std::span<const std::int64_t>(version));
    file_.set_attribute("/VTKHDF", "Type", std::string("UnstructuredGrid"));
    for (const char* name : {"NumberOfPoints", "NumberOfCells", "NumberOfConnectivityIds"})
        file_.make_growing<std::int64_t>(std::string("/VTKHDF/") + name, {}, 16);
    for (const char* name : {"PartOffsets", "NumberOfParts", "PointOffsets"})
        file_.make_growing<std::int64_t>(std::string("/VTKHDF/Steps/") + name, {}, 256);
    for (const char* name : {"CellOffsets", "ConnectivityIdOffsets"}) // one column per topology
        file_.make_growing<std::int64_t>(std::string("/VTKHDF/Steps/") + name, {1}, 256);
    file_.make_growing<double>("/VTKHDF/Steps/Values", {}, 256);
    file_.set_attribute("/VTKHDF/Steps/Values", "unit", std::string("s"));
    file_.make_group(point_data);
    file_.make_group(data_offsets);
    file_.set_attribute<std::int64_t>("/VTKHDF/Steps", "NSteps", 0);
    file_.make_group("/meta");
    add_meta(version_entries());
    file_.make_group("/tracks");
}

RunFile::~RunFile() {
    try {
        if (file_.is_open()) close();
    } catch (const OutputError&) { // only close() can report it
    }
}

void RunFile::add_meta(const std::vector<NamedValue>& entries) {
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

void RunFile::begin_part(std::size_t rocks, std::size_t quads, const std::vector<Labels>& labels,
                         const std::vector<Field>& fields) {
    const auto points = static_cast<std::int64_t>(rocks + 4 * quads);
    if (parts_ == 0) { // one chunk per frame
        const auto frame = static_cast<std::uint64_t>(points);
        file_.make_growing<float>("/VTKHDF/Points", {3}, frame);
        file_.set_attribute("/VTKHDF/Points", "unit", std::string("m"));
        file_.make_growing<std::int64_t>("/VTKHDF/Connectivity", {}, frame);
        file_.make_growing<std::int64_t>("/VTKHDF/Offsets", {}, rocks + quads + 1);
        file_.make_growing<std::uint8_t>("/VTKHDF/Types", {}, rocks + quads);
    } else {
        cells_before_ += static_cast<std::int64_t>(rocks_ + quads_);
        connectivity_before_ += static_cast<std::int64_t>(rocks_ + 4 * quads_);
    }
    rocks_ = rocks;
    quads_ = quads;
    ++parts_;
    std::vector<std::int64_t> connectivity(rocks + 4 * quads), offsets(rocks + quads + 1);
    std::iota(connectivity.begin(), connectivity.end(), std::int64_t{0});
    for (std::size_t i = 0; i < offsets.size(); ++i)
        offsets[i] = static_cast<std::int64_t>(i <= rocks ? i : rocks + 4 * (i - rocks));
    std::vector<std::uint8_t> types(rocks, vtk_vertex);
    types.resize(rocks + quads, vtk_quad);
    file_.append("/VTKHDF/Connectivity", std::span<const std::int64_t>(connectivity));
    file_.append("/VTKHDF/Offsets", std::span<const std::int64_t>(offsets));
    file_.append("/VTKHDF/Types", std::span<const std::uint8_t>(types));
    append_one(file_, "/VTKHDF/NumberOfPoints", points);
    append_one(file_, "/VTKHDF/NumberOfCells", static_cast<std::int64_t>(rocks + quads));
    append_one(file_, "/VTKHDF/NumberOfConnectivityIds", points);
    for (const Labels& one : labels) append_labels(one);
    for (const Field& field : fields) append_field(field, true);
}

RunFile::Array& RunFile::array(const std::string& name, unsigned components, bool integer,
                               bool fixed) {
    const auto [found, is_new] = arrays_.try_emplace(name);
    Array& array = found->second;
    if (is_new) {
        if (frames_ > 0)
            throw std::logic_error("array '" + name + "' was added after the first frame");
        array = {.components = components, .integer = integer, .fixed = fixed};
        const Hdf5File::Shape row =
            components > 1 ? Hdf5File::Shape{components} : Hdf5File::Shape{};
        const std::uint64_t frame = rocks_ + 4 * quads_;
        if (integer)
            file_.make_growing<std::int64_t>(point_data + name, row, frame);
        else
            file_.make_growing<float>(point_data + name, row, frame);
        file_.make_growing<std::int64_t>(data_offsets + name, {}, 256);
    }
    if (array.components != components || array.integer != integer || array.fixed != fixed)
        throw std::logic_error("array '" + name + "' has changed its type");
    array.start = array.rows;
    array.rows += static_cast<std::int64_t>(rocks_ + 4 * quads_);
    return array;
}

void RunFile::append_field(const Field& field, bool fixed) {
    if (field.values.size() != rocks_ * field.components)
        throw std::logic_error(fmt::format("field '{}': {} values for {} rocks", field.name,
                                           field.values.size(), rocks_));
    const bool is_new = !arrays_.contains(field.name);
    array(field.name, field.components, false, fixed);
    if (is_new) file_.set_attribute(point_data + field.name, "unit", field.unit);
    std::vector<float> values(field.values.begin(), field.values.end());
    values.resize((rocks_ + 4 * quads_) * field.components, 0.0f);
    file_.append(point_data + field.name, std::span<const float>(values));
}

void RunFile::append_labels(const Labels& labels) {
    if (labels.values.size() != rocks_)
        throw std::logic_error(fmt::format("labels '{}': {} values for {} rocks", labels.name,
                                           labels.values.size(), rocks_));
    array(labels.name, 1, true, true);
    std::vector<std::int64_t> values(labels.values.begin(), labels.values.end());
    values.resize(rocks_ + 4 * quads_, -1);
    file_.append(point_data + labels.name, std::span<const std::int64_t>(values));
}

void RunFile::append_points(const Frame& frame) {
    std::vector<float> points;
    points.reserve(3 * (frame.centres.size() + frame.corners.size()));
    for (const auto list : {frame.centres, frame.corners})
        for (const Vec3& x : list)
            for (int axis = 0; axis < 3; ++axis) points.push_back(static_cast<float>(x[axis]));
    file_.append("/VTKHDF/Points", std::span<const float>(points));
    point_start_ = points_;
    points_ += static_cast<std::int64_t>(points.size() / 3);
}

void RunFile::append_step(double time) {
    // the part index counts sets of cells, not frames, because readers add it to the start of
    // Offsets
    file_.append("/VTKHDF/Steps/Values", std::span<const double>(&time, 1));
    append_one(file_, "/VTKHDF/Steps/PartOffsets", parts_ - 1);
    append_one(file_, "/VTKHDF/Steps/NumberOfParts", 1);
    append_one(file_, "/VTKHDF/Steps/PointOffsets", point_start_);
    append_one(file_, "/VTKHDF/Steps/CellOffsets", cells_before_);
    append_one(file_, "/VTKHDF/Steps/ConnectivityIdOffsets", connectivity_before_);
    for (const auto& [name, array] : arrays_) append_one(file_, data_offsets + name, array.start);
}

void RunFile::add_frame(const Frame& frame) {
    if (parts_ == 0 || frame.centres.size() != rocks_ || frame.corners.size() != 4 * quads_)
        throw std::logic_error("the frame has other cells than begin_part declared");
    std::size_t moving = 0;
    for (const auto& [name, array] : arrays_) moving += array.fixed ? 0 : 1;
    if (frames_ > 0 && frame.fields.size() != moving)
        throw std::logic_error("the frame has other fields than the first one");
    append_points(frame);
    for (const Field& field : frame.fields) append_field(field, false);
    append_step(frame.time);
    write_tracks();
    file_.flush();
    // the frame counts only from here on: a crash before this line leaves the file as it was
    ++frames_;
    file_.set_attribute("/VTKHDF/Steps", "NSteps", static_cast<std::int64_t>(frames_));
    file_.flush();
    list_frame(frame.time);
}

void RunFile::list_frame(double time) {
    const auto row = [](std::int64_t n) { return static_cast<std::uint64_t>(n); };
    std::vector<XdmfFile::Array> data;
    for (const auto& [name, array] : arrays_)
        data.push_back({point_data + name, name, array.components, array.integer, row(array.start),
                        row(array.rows)});
    list_.add({.time = time,
               .bodies = rocks_,
               .quads = quads_,
               .points = {"/VTKHDF/Points", "", 3, false, row(point_start_), row(points_)},
               .connectivity = {"/VTKHDF/Connectivity", "", 1, true, row(connectivity_before_),
                                row(connectivity_before_) + rocks_ + 4 * quads_},
               .data = data});
}

void RunFile::add_track(const std::string& name, const std::vector<Column>& columns) {
    Track track;
    for (const Column& column : columns) {
        const std::string dataset = "/tracks/" + name + "/" + column.name;
        file_.make_growing<double>(dataset, {}, rows_kept);
        file_.set_attribute(dataset, "unit", column.unit);
        track.columns.push_back(dataset);
    }
    track.pending.resize(columns.size());
    tracks_.emplace(name, std::move(track));
}

void RunFile::add_row(const std::string& name, std::span<const double> row) {
    Track& track = tracks_.at(name);
    if (row.size() != track.columns.size())
        throw std::logic_error(fmt::format("track '{}': {} values for {} columns", name, row.size(),
                                           track.columns.size()));
    for (std::size_t i = 0; i < row.size(); ++i) track.pending[i].push_back(row[i]);
    if (!row.empty() && track.pending.front().size() >= rows_kept) write_tracks();
}

void RunFile::write_tracks() {
    for (auto& [name, track] : tracks_)
        for (std::size_t i = 0; i < track.columns.size(); ++i) {
            file_.append(track.columns[i], std::span<const double>(track.pending[i]));
            track.pending[i].clear();
        }
}

void RunFile::flush() {
    write_tracks();
    file_.flush();
}

void RunFile::close() {
    write_tracks();
    file_.close();
}

} // namespace bris
