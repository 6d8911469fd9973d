#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

namespace bris {

/// Cells by their numbers in VTK.
enum class CellKind : std::uint8_t { vertex = 1, line = 3, triangle = 5, quad = 9 };

constexpr std::uint64_t corners_of(CellKind kind) {
    return kind == CellKind::vertex     ? 1
           : kind == CellKind::line     ? 2
           : kind == CellKind::triangle ? 3
                                        : 4;
}

/// The name of a run file without its ending in two parts: the name that the run gave it, and what
/// was appended because the run was resumed (_from_N or _from_stage_N), or nothing.
std::pair<std::string, std::string> name_and_part(const std::filesystem::path& run_file);

/// A list of the frames of a run file in XDMF 2, NAME.xdmf beside NAME.vtkhdf: where each array of
/// each frame is in the HDF5 file. The list is valid after each frame. Every member throws
/// OutputError.
class XdmfFile {
public:
    /// An array of the run file of which a frame shows the rows from `start` on.
    struct Array {
        std::string dataset, name;
        unsigned components = 1;
        bool integer = false;              ///< of 64 bits; otherwise numbers of 32 bits
        std::uint64_t start = 0, rows = 0; ///< `rows`: those that the array has
        bool of_cells = false;             ///< a row per cell; otherwise per point
    };
    /// Cells of one kind, and points that belong to them only; blocks follow each other.
    struct Block {
        std::string name;
        CellKind kind;
        std::uint64_t cells, points;
    };
    struct Frame {
        double time; ///< s
        std::vector<Block> blocks;
        Array points;
        /// The rows from `start` on are the corners of each block's cells, counted from the first
        /// point of the block.
        Array connectivity;
        std::vector<Array> data;
    };

    /// `run_file`: NAME.vtkhdf begins a list. NAME_from_N.vtkhdf, the file of a run that was
    /// resumed, goes on with the list NAME.xdmf: its frames replace those of the same time and
    /// later.
    explicit XdmfFile(const std::filesystem::path& run_file);

    void add(const Frame& frame);
    const std::filesystem::path& path() const { return path_; }

private:
    void keep_frames_before(double time);

    std::filesystem::path path_;
    std::string run_file_; // as the list names it
    bool begun_ = false, goes_on_ = false;
    std::uint64_t end_ = 0; // bytes up to the end of the last frame
};

} // namespace bris
