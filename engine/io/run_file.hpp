#pragma once

#include "engine/io/hdf5.hpp"
#include "engine/math.hpp"
#include "engine/named_value.hpp"

#include <cstdint>
#include <filesystem>
#include <map>
#include <span>
#include <string>
#include <vector>

namespace bris {

/// The story of a run in one file, NAME.vtkhdf: frames that ParaView opens (temporal VTKHDF
/// UnstructuredGrid 2.0), the settings under /meta, time series under /tracks. A rock is a vertex
/// at its centre, to be drawn as a glyph; a membrane element is a quad with four corner points of
/// its own. The grid of cells is written once and holds as long as their numbers do. Every frame
/// is on disk when add_frame returns: a run that ends in mid-air leaves a readable file.
class RunFile {
public:
    /// A named array with `components` (1 to 4) numbers per rock.
    struct Field {
        std::string name;
        unsigned components = 1;
        std::span<const float> values = {};
    };
    /// A named integer per rock.
    struct Labels {
        std::string name;
        std::span<const std::int64_t> values = {};
    };
    struct Frame {
        double time = 0;                    ///< s, growing from frame to frame
        std::span<const Vec3> centres = {}; ///< m, n rocks
        std::span<const Vec3> corners = {}; ///< m, 4 per quad, in order around it
        std::vector<Field> fields = {};     ///< the same names in every frame
    };
    struct Column {
        std::string name;
        std::string unit = "";
    };

    /// A new file in place of an old one. Throws OutputError, as every member does.
    explicit RunFile(const std::filesystem::path& path);
    ~RunFile();
    RunFile(RunFile&&) = default;
    RunFile& operator=(RunFile&&) = delete;

    /// Attributes of /meta: settings, versions, whatever made the run.
    void add_meta(const std::vector<NamedValue>& entries);

    /// Announces the cells of the following frames and what never changes on them. To be called
    /// before the first frame, and again when rocks or quads come or go. Names are the same each
    /// time. Corner points have 0 in every field and -1 in every label.
    void begin_part(std::size_t rocks, std::size_t quads, const std::vector<Labels>& labels,
                    const std::vector<Field>& fields = {});
    void add_frame(const Frame& frame);
    std::size_t frames() const { return frames_; }

    /// A new table /tracks/NAME, one dataset per column with its unit as an attribute.
    void add_track(const std::string& name, const std::vector<Column>& columns);
    /// Appends a row, in the order of the columns; on disk with the next frame or flush().
    void add_row(const std::string& track, std::span<const double> row);
    void flush();
    void close();

    /// For what else belongs to the run: /sensors, /checkpoint, /monitor.
    Hdf5File& file() { return file_; }

private:
    struct Array { // one of PointData
        unsigned components = 1;
        bool integer = false;
        bool fixed = false;
        std::int64_t rows = 0;  // written so far
        std::int64_t start = 0; // of the block that the current frame shows
    };
    struct Track {
        std::vector<std::string> columns;
        std::vector<std::vector<double>> pending; // per column
    };
    void append_field(const Field& field, bool fixed);
    void append_labels(const Labels& labels);
    Array& array(const std::string& name, unsigned components, bool integer, bool fixed);
    void append_points(const Frame& frame);
    void append_step(double time);
    void write_tracks();

    Hdf5File file_;
    std::map<std::string, Array> arrays_;
    std::map<std::string, Track> tracks_;
    std::size_t rocks_ = 0, quads_ = 0, frames_ = 0;
    std::int64_t parts_ = 0, cells_before_ = 0, connectivity_before_ = 0, points_ = 0;
    std::int64_t point_start_ = 0;
};

} // namespace bris
