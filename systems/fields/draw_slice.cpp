#include "engine/io/gnuplot.hpp"
#include "systems/fields/field_set.hpp"
#include "systems/fields/image_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

namespace bris {

namespace {

/// Value of a field in a voxel; the length of a vector.
double value_of(const FieldSet::Field& field, std::uint32_t n) {
    if (field.components.size() == 1) return field.components[0][n];
    double square = 0;
    for (const VoxelField& c : field.components) square += c[n] * c[n];
    return std::sqrt(square);
}

/// A vertical plane of voxels through the middle of a range, along its longer horizontal side.
struct Plane {
    explicit Plane(const VoxelRange& r)
        : range(r), along_y(r.size(1) > r.size(0)),
          across(along_y ? (r.low.x + r.high.x) / 2 : (r.low.y + r.high.y) / 2) {}
    int first() const { return along_y ? range.low.y : range.low.x; }
    int last() const { return along_y ? range.high.y : range.high.x; }
    Voxel at(int along, int z) const {
        return along_y ? Voxel{across, along, z} : Voxel{along, across, z};
    }
    VoxelRange range;
    bool along_y;
    int across;
};

/// The voxels of a plane as a block of data for gnuplot; NaN where nothing is shown.
std::string data_of(const FieldSet& set, const FieldSet::Field& field, const Plane& plane,
                    double& low, double& high) {
    std::string text;
    for (int z = plane.range.low.z; z <= plane.range.high.z; ++z) {
        for (int along = plane.first(); along <= plane.last(); ++along) {
            const std::uint32_t n = set.blocks.number(plane.at(along, z));
            if (n == VoxelBlocks::none || set.shown[n] == 0) {
                text += "NaN ";
                continue;
            }
            const double value = value_of(field, n);
            low = std::min(low, value);
            high = std::max(high, value);
            text += fmt::format("{:.6g} ", value);
        }
        text += "\n";
    }
    return text;
}

} // namespace

bool draw_slice(const FieldSet& set, const std::vector<std::string>& names,
                const std::filesystem::path& png) {
    const Plane plane(shown_range(set.blocks, set.shown));
    const Vec3 corner = set.blocks.lattice().centre(plane.at(plane.first(), plane.range.low.z));
    const double from = plane.along_y ? corner.y() : corner.x();
    const double size = set.blocks.lattice().size;
    std::vector<const FieldSet::Field*> fields;
    for (const std::string& name : names)
        if (const auto* field = set.find(name)) fields.push_back(field);
    std::string blocks, plots;
    for (std::size_t k = 0; k < fields.size(); ++k) {
        const FieldSet::Field& field = *fields[k];
        double low = std::numeric_limits<double>::infinity(), high = -low;
        blocks += fmt::format("$slice{} << end\n{}end\n", k, data_of(set, field, plane, low, high));
        if (!(low < high)) high = low + std::max(1e-12, std::abs(low));
        plots += fmt::format(
            "set title {}\nset cbrange [{}:{}]\nset cbtics {}, {}\n"
            "plot $slice{} matrix using ({}+{}*$1):({}+{}*$2):3 with image\n",
            gnuplot_quoted(field.name +
                           (field.units == "1" ? std::string() : " (" + field.units + ")")),
            low, high, low, (high - low) / 4, k, 1e3 * from, 1e3 * size, 1e3 * corner.z(),
            1e3 * size);
    }
    const double wide = static_cast<double>(plane.last() - plane.first() + 1),
                 tall = static_cast<double>(plane.range.size(2));
    const bool flat = wide > 2 * tall; // panels two by two
    const auto columns = static_cast<unsigned>(std::min<std::size_t>(fields.size(), flat ? 2 : 4));
    const auto lines = static_cast<unsigned>((fields.size() + columns - 1) / columns);
    const unsigned width = flat ? 640 : 320,
                   height = static_cast<unsigned>(
                       std::clamp(110 + (flat ? 530.0 : 210.0) * tall / wide, 200.0, 800.0));
    const std::string commands = fmt::format(
        "{}set multiplot layout {},{}\nset size ratio -1\nunset key\nset autoscale noextend\n"
        "set format cb '%.3g'\nset rmargin 9\n"
        "set palette defined (0 '#2c3e70', 0.35 '#3a8f8f', 0.7 '#e0c050', 1 '#b03020')\n"
        "set xlabel '{} (mm)'\nset ylabel 'z (mm)'\nset xtics {}\nset ytics {}\n{}unset "
        "multiplot\n",
        blocks, lines, columns, plane.along_y ? "y" : "x",
        std::max(10.0, std::floor(wide * size * 1e3 / 30) * 10),
        std::max(10.0, std::floor(tall * size * 1e3 / 30) * 10), plots);
    return draw_with_gnuplot(png, width * columns, height * lines, commands);
}

} // namespace bris
