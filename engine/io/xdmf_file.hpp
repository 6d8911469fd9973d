#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace bris {

/// A list of the frames of a run file in XDMF 2, NAME.xdmf beside NAME.vtkhdf: where each array of
/// each frame is in the HDF5 file. A frame has bodies (points) and quads as two blocks. The list is
/// valid after each frame. Every member throws OutputError.
class XdmfFile {
public:
    /// An array of the run file of which a frame shows the rows from `start` on.
    struct Array {
        std::string dataset, name;
        unsigned components = 1;
        bool integer = false;              ///< of 64 bits; otherwise numbers of 32 bits
        std::uint64_t start = 0, rows = 0; ///< `rows`: those that the array has
    };
    struct Frame {
        double time;                 ///< s
        std::uint64_t bodies, quads; ///< points: first one for each body, then four for each quad
        Array points, connectivity;
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
