#pragma once

#include "engine/io/vtkhdf_file.hpp"
#include "engine/math.hpp"
#include "engine/named_value.hpp"

#include <cstdint>
#include <filesystem>
#include <map>
#include <span>
#include <string>
#include <vector>

namespace bris {

/// All results of a run in one file, NAME.vtkhdf: frames for ParaView (see VtkhdfFile), the
/// settings under /meta, time series under /tracks. A rock is a vertex at its centre, to be drawn
/// as a glyph; a membrane element is a quad with four corner points of its own.
class RunFile {
public:
    /// A named array with `components` (1 to 4) numbers per rock.
    struct Field {
        std::string name;
        unsigned components = 1;
        std::span<const float> values = {};
        std::string unit = ""; ///< an attribute of the array
    };
    /// A named integer per rock.
    struct Labels {
        std::string name;
        std::span<const std::int64_t> values = {};
    };
    struct Column {
        std::string name;
        std::string unit = "";
    };

    /// Creates the file, replacing an old one. Throws OutputError, as every member does.
    explicit RunFile(const std::filesystem::path& path);
    ~RunFile();
    RunFile(RunFile&&) = default;
    RunFile& operator=(RunFile&&) = delete;

    /// Writes attributes of /meta: settings, versions and other information on the origin of the
    /// run.
    void add_meta(const std::vector<NamedValue>& entries) { grid_.add_meta(entries); }

    /// Declares the cells of the following frames and the data that stay constant on them. Called
    /// before the first frame, and again whenever rocks or quads are added or removed. The names
    /// must be the same each time. Corner points have 0 in every field and -1 in every label.
    void begin_part(std::size_t rocks, std::size_t quads, const std::vector<Labels>& labels,
                    const std::vector<Field>& fields = {});
    /// Begins a frame. `centres`: x, y, z (m) of each rock; `corners`: m, 4 per quad, in cyclic
    /// order.
    void begin_frame(std::span<const float> centres, std::span<const Vec3> corners);
    /// The same names in every frame.
    void put_field(const Field& field) { put_field(field, false); }
    /// `time`: s, increasing from frame to frame.
    void end_frame(double time);
    std::size_t frames() const { return grid_.frames(); }

    /// Creates a table /tracks/NAME, one dataset per column with its unit as an attribute.
    void add_track(const std::string& name, const std::vector<Column>& columns);
    /// Appends a row, in the order of the columns; on disk with the next frame or flush().
    void add_row(const std::string& track, std::span<const double> row);
    void flush();
    void close();

    /// The underlying file, for other content of the run: /sensors, /checkpoint, /monitor.
    Hdf5File& file() { return grid_.file(); }

private:
    struct Track {
        std::vector<std::string> columns;
        std::vector<std::vector<double>> pending; // per column
    };
    void put_field(const Field& field, bool fixed);
    void put_labels(const Labels& labels);
    void write_tracks();

    VtkhdfFile grid_;
    std::map<std::string, Track> tracks_;
    std::size_t rocks_ = 0, quads_ = 0;
    bool has_begun_ = false; // a frame
};

} // namespace bris
