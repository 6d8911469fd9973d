#pragma once

#include "engine/io/hdf5.hpp"
#include "engine/io/xdmf_file.hpp"
#include "engine/math.hpp"
#include "engine/named_value.hpp"

#include <cstdint>
#include <filesystem>
#include <map>
#include <span>
#include <string>
#include <vector>

namespace bris {

/// Appends x, y and z of a vector to the numbers of an array.
inline void append_vector(std::vector<float>& numbers, const Vec3& vector) {
    for (int axis = 0; axis < 3; ++axis) numbers.push_back(static_cast<float>(vector[axis]));
}

/// Frames of points and cells for ParaView, NAME.vtkhdf (temporal VTKHDF UnstructuredGrid 2.0),
/// with information on their origin under /meta. Cells are written once and hold as long as their
/// numbers do not change. Every frame is on disk when end_frame returns, so that an aborted run
/// leaves a readable file. Beside it, NAME.xdmf lists the same frames for programs that read only
/// the first frame of a VTKHDF file, as ParaView before 5.12; the frames of a resumed run are added
/// to the same list. Every member throws OutputError.
class VtkhdfFile {
public:
    enum class On { points, cells };
    /// An array with `components` (1 to 4) numbers per point or per cell. A fixed array is written
    /// once for each part, the others for each frame.
    struct Array {
        On on = On::points;
        std::string name;
        unsigned components = 1;
        std::string unit = "";
        bool fixed = false;
    };

    /// Creates the file, replacing an old one.
    explicit VtkhdfFile(const std::filesystem::path& path);

    /// Writes attributes of /meta: settings, versions and other information on the origin of the
    /// run.
    void add_meta(const std::vector<NamedValue>& entries);

    /// Begins a part: the cells of the following frames. `usual_points` and `usual_cells` say how
    /// many a part usually has; the arrays are stored in pieces of that many. `connectivity`: the
    /// points of each cell, for a single block; empty: every corner is a point of its own, in
    /// order.
    void begin_part(const std::vector<XdmfFile::Block>& blocks, std::size_t usual_points,
                    std::size_t usual_cells, std::span<const std::int64_t> connectivity = {});
    /// Writes an array of the part or frame. The names and types must be the same each time.
    void put(const Array& array, std::span<const float> values);
    void put(const Array& array, std::span<const std::int64_t> values);
    /// Writes the points of a frame: x, y, z (m) of each.
    void put_points(std::span<const float> coordinates);
    /// Ends a frame, whose points and arrays have been written. Times (s) increase.
    void end_frame(double time);

    std::size_t frames() const { return frames_; }
    std::size_t points() const { return part_points_; } ///< of the part
    std::size_t cells() const { return part_cells_; }
    bool has_part() const { return parts_ > 0; }
    void flush() { file_.flush(); }
    void close() { file_.close(); }
    /// The underlying file, for other content of the run.
    Hdf5File& file() { return file_; }

private:
    struct Written {
        Array array;
        bool integer = false;
        std::uint64_t start = 0, rows = 0; // of the block that the frame shows; altogether
        std::uint64_t frame = 0;           // number of frames when it was written last
    };
    template <class T>
    void put_values(const Array& array, std::span<const T> values);
    Written& written(const Array& array, bool integer);
    void append_step(double time);
    void list_frame(double time);

    Hdf5File file_;
    XdmfFile list_;
    std::map<std::string, Written> arrays_; // by their path below /VTKHDF
    std::vector<XdmfFile::Block> blocks_;
    std::size_t frames_ = 0, parts_ = 0, part_points_ = 0, part_cells_ = 0, part_corners_ = 0;
    std::size_t usual_points_ = 1, usual_cells_ = 1;
    std::uint64_t cells_before_ = 0, connectivity_before_ = 0; // of earlier parts
    std::uint64_t points_written_ = 0, point_start_ = 0;
};

} // namespace bris
