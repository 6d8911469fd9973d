#include "engine/io/run_file.hpp"

#include "engine/errors.hpp"

#include <fmt/format.h>

#include <stdexcept>
#include <utility>

namespace bris {

namespace {

constexpr std::size_t rows_kept = 256; // rows of a track that are kept before they are written

void require_one_for_each_rock(const std::string& name, std::size_t rows, std::size_t rocks) {
    if (rows != rocks)
        throw std::logic_error(fmt::format("'{}': {} values for {} rocks", name, rows, rocks));
}

} // namespace

RunFile::RunFile(const std::filesystem::path& path) : grid_(path) { file().make_group("/tracks"); }

RunFile::~RunFile() {
    try {
        if (file().is_open()) close();
    } catch (const OutputError&) { // only close() can report it
    }
}

void RunFile::begin_part(std::size_t rocks, std::size_t quads, const std::vector<Labels>& labels,
                         const std::vector<Field>& fields) {
    rocks_ = rocks;
    quads_ = quads;
    grid_.begin_part(
        {{"bodies", CellKind::vertex, rocks, rocks}, {"facets", CellKind::quad, quads, 4 * quads}},
        rocks + 4 * quads, rocks + quads);
    for (const Labels& one : labels) put_labels(one);
    for (const Field& field : fields) put_field(field, true);
}

void RunFile::put_field(const Field& field, bool fixed) {
    require_one_for_each_rock(field.name, field.values.size(), rocks_ * field.components);
    std::vector<float> values(field.values.begin(), field.values.end());
    values.resize(grid_.points() * field.components, 0.0f);
    grid_.put({VtkhdfFile::On::points, field.name, field.components, field.unit, fixed},
              std::span<const float>(values));
}

void RunFile::put_labels(const Labels& labels) {
    require_one_for_each_rock(labels.name, labels.values.size(), rocks_);
    std::vector<std::int64_t> values(labels.values.begin(), labels.values.end());
    values.resize(grid_.points(), -1);
    grid_.put({.name = labels.name, .fixed = true}, std::span<const std::int64_t>(values));
}

void RunFile::begin_frame(std::span<const float> centres, std::span<const Vec3> corners) {
    if (centres.size() != 3 * rocks_ || corners.size() != 4 * quads_)
        throw std::logic_error("the frame has other cells than begin_part declared");
    if (std::exchange(has_begun_, true)) throw std::logic_error("a frame within a frame");
    std::vector<float> points;
    points.reserve(3 * grid_.points());
    points.assign(centres.begin(), centres.end());
    for (const Vec3& x : corners) append_vector(points, x);
    grid_.put_points(points);
}

void RunFile::end_frame(double time) {
    if (!std::exchange(has_begun_, false)) throw std::logic_error("the end of no frame");
    write_tracks();
    grid_.end_frame(time);
}

void RunFile::add_track(const std::string& name, const std::vector<Column>& columns) {
    Track track;
    for (const Column& column : columns) {
        const std::string dataset = "/tracks/" + name + "/" + column.name;
        file().make_growing<double>(dataset, {}, rows_kept);
        file().set_attribute(dataset, "unit", column.unit);
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
            file().append(track.columns[i], std::span<const double>(track.pending[i]));
            track.pending[i].clear();
        }
}

void RunFile::flush() {
    write_tracks();
    grid_.flush();
}

void RunFile::close() {
    write_tracks();
    grid_.close();
}

} // namespace bris
