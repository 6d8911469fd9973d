#include "engine/io/xdmf_file.hpp"

#include "engine/errors.hpp"
#include "engine/io/whole_file.hpp"
#include "engine/ranks.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <fcntl.h>
#include <iterator>
#include <unistd.h>

namespace bris {

namespace {

constexpr std::string_view head =
    "<?xml version=\"1.0\"?>\n<Xdmf Version=\"2.0\">\n<Domain>\n"
    "<Grid Name=\"run\" GridType=\"Collection\" CollectionType=\"Temporal\">\n";
constexpr std::string_view tail = "</Grid>\n</Domain>\n</Xdmf>\n";
constexpr std::string_view frame_begin = "<Grid Name=\"frame\" GridType=\"Collection\" "
                                         "CollectionType=\"Spatial\">\n<Time Value=\"";

std::string escaped(const std::string& text) {
    std::string out;
    for (const char c : text)
        out += c == '&' ? "&amp;" : c == '<' ? "&lt;" : c == '"' ? "&quot;" : std::string(1, c);
    return out;
}

/// The rows of an array from `first` (counted from the frame's start) on, as a DataItem.
std::string item(const std::string& file, const XdmfFile::Array& array, std::uint64_t first,
                 std::uint64_t count) {
    const std::string columns = array.components > 1 ? fmt::format(" {}", array.components) : "";
    const char* const number = array.integer ? "NumberType=\"Int\" Precision=\"8\""
                                             : "NumberType=\"Float\" Precision=\"4\"";
    const bool wide = array.components > 1;
    return fmt::format(
        "<DataItem ItemType=\"HyperSlab\" Dimensions=\"{0}{1}\">"
        "<DataItem Dimensions=\"3 {2}\" Format=\"XML\">{3}{4} 1{5} {0}{1}</DataItem>"
        "<DataItem Dimensions=\"{6}{1}\" {7} Format=\"HDF\">{8}:{9}</DataItem></DataItem>\n",
        count, columns, wide ? 2 : 1, array.start + first, wide ? " 0" : "", wide ? " 1" : "",
        array.rows, number, escaped(file), escaped(array.dataset));
}

std::string topology(CellKind kind, std::uint64_t cells) {
    const bool any_number = kind == CellKind::vertex || kind == CellKind::line; // of corners
    return fmt::format("<Topology TopologyType=\"{}\" NumberOfElements=\"{}\"{}>\n",
                       kind == CellKind::vertex     ? "Polyvertex"
                       : kind == CellKind::line     ? "Polyline"
                       : kind == CellKind::triangle ? "Triangle"
                                                    : "Quadrilateral",
                       cells,
                       any_number ? fmt::format(" NodesPerElement=\"{}\"", corners_of(kind)) : "");
}

/// A block of cells, whose first point and cell are those of these numbers in the frame.
std::string block_text(const std::string& file, const XdmfFile::Frame& frame,
                       const XdmfFile::Block& block, std::uint64_t first_point,
                       std::uint64_t first_cell) {
    if (block.cells == 0) return {};
    std::string text = fmt::format("<Grid Name=\"{}\" GridType=\"Uniform\">\n", block.name);
    text += topology(block.kind, block.cells);
    text += item(file, frame.connectivity, 0, block.cells * corners_of(block.kind));
    text += "</Topology>\n<Geometry GeometryType=\"XYZ\">\n";
    text += item(file, frame.points, first_point, block.points) + "</Geometry>\n";
    for (const XdmfFile::Array& array : frame.data)
        text += fmt::format("<Attribute Name=\"{}\" AttributeType=\"{}\" Center=\"{}\">\n{}"
                            "</Attribute>\n",
                            escaped(array.name),
                            array.components == 1   ? "Scalar"
                            : array.components == 3 ? "Vector"
                                                    : "Matrix",
                            array.of_cells ? "Cell" : "Node",
                            array.of_cells ? item(file, array, first_cell, block.cells)
                                           : item(file, array, first_point, block.points));
    return text + "</Grid>\n";
}

/// Writes at a place of a file, in one call where the system can.
void write_at(const std::filesystem::path& path, std::uint64_t at, std::string_view text) {
    const int file = open(path.c_str(), O_WRONLY | O_CLOEXEC);
    bool good = file >= 0;
    for (std::size_t done = 0; good && done < text.size();) {
        const ssize_t written =
            pwrite(file, text.data() + done, text.size() - done, static_cast<off_t>(at + done));
        if (written < 0 && errno == EINTR) continue;
        good = written > 0;
        if (good) done += static_cast<std::size_t>(written);
    }
    const int why = good ? 0 : errno;
    if (file >= 0) close(file);
    if (!good)
        throw OutputError(fmt::format("cannot write '{}': {}", path.string(), std::strerror(why)));
}

} // namespace

std::pair<std::string, std::string> name_and_part(const std::filesystem::path& run_file) {
    const std::string name = run_file.stem().string();
    const auto end = name.find_last_not_of("0123456789");
    if (end == std::string::npos || end + 1 == name.size()) return {name, ""};
    for (const std::string_view from : {"_from_", "_from_stage_"})
        if (const std::string_view before(name.data(), end + 1); before.ends_with(from))
            return {name.substr(0, end + 1 - from.size()), name.substr(end + 1 - from.size())};
    return {name, ""};
}

XdmfFile::XdmfFile(const std::filesystem::path& run_file)
    : path_(run_file), run_file_(run_file.filename().string()) {
    const auto [name, part] = name_and_part(run_file);
    goes_on_ = !part.empty();
    path_.replace_filename(name + ".xdmf");
}

void XdmfFile::keep_frames_before(double time) {
    std::string text(head);
    std::error_code error;
    if (goes_on_ && std::filesystem::exists(path_, error)) {
        const std::string old = read_whole(path_);
        if (old.starts_with(head)) {
            std::size_t end = head.size();
            while (old.compare(end, frame_begin.size(), frame_begin) == 0) {
                const char* const number = old.c_str() + end + frame_begin.size();
                const auto next = std::min(old.find(frame_begin, end + 1), old.rfind(tail));
                // a list that ends within a frame was being written when the run was killed
                if (next == std::string::npos || next < end ||
                    !(std::strtod(number, nullptr) < time))
                    break;
                end = next;
            }
            text = old.substr(0, end);
        }
    }
    end_ = text.size();
    write_whole(path_, text + std::string(tail));
}

void XdmfFile::add(const Frame& frame) {
    if (!Ranks::writes()) return;
    if (!begun_) keep_frames_before(frame.time);
    begun_ = true;
    std::string text = fmt::format("{}{:.17g}\"/>\n", frame_begin, frame.time);
    std::uint64_t first_point = 0, first_cell = 0;
    for (const Block& block : frame.blocks) {
        text += block_text(run_file_, frame, block, first_point, first_cell);
        first_point += block.points;
        first_cell += block.cells;
    }
    text += "</Grid>\n";
    write_at(path_, end_, text + std::string(tail));
    end_ += text.size();
}

} // namespace bris
