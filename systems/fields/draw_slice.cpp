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

/// The slice at voxel row y as a block of data for gnuplot; NaN where nothing is shown.
std::string data_of(const FieldSet& set, const FieldSet::Field& field, const VoxelRange& range,
                    int y, double& low, double& high) {
    std::string text;
    for (int z = range.low.z; z <= range.high.z; ++z) {
        for (int x = range.low.x; x <= range.high.x; ++x) {
            const std::uint32_t n = set.blocks.number({x, y, z});
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
    const VoxelRange range = shown_range(set.blocks, set.shown);
    const int y = (range.low.y + range.high.y) / 2;
    const Vec3 from = set.blocks.lattice().centre({range.low.x, y, range.low.z});
    const double size = set.blocks.lattice().size;
    std::vector<const FieldSet::Field*> fields;
    for (const std::string& name : names)
        if (const auto* field = set.find(name)) fields.push_back(field);
    std::string blocks, plots;
    for (std::size_t k = 0; k < fields.size(); ++k) {
        const FieldSet::Field& field = *fields[k];
        double low = std::numeric_limits<double>::infinity(), high = -low;
        blocks +=
            fmt::format("$slice{} << end\n{}end\n", k, data_of(set, field, range, y, low, high));
        if (!(low < high)) high = low + std::max(1e-12, std::abs(low));
        plots += fmt::format(
            "set title {}\nset cbrange [{}:{}]\n"
            "plot $slice{} matrix using ({}+{}*$1):({}+{}*$2):3 with image\n",
            gnuplot_quoted(field.name +
                           (field.units == "1" ? std::string() : " (" + field.units + ")")),
            low, high, k, 1e3 * from.x(), 1e3 * size, 1e3 * from.z(), 1e3 * size);
    }
    const double wide = static_cast<double>(range.size(0)),
                 tall = static_cast<double>(range.size(2));
    const auto columns = static_cast<unsigned>(std::min<std::size_t>(fields.size(), 4));
    const auto lines = static_cast<unsigned>((fields.size() + columns - 1) / columns);
    const unsigned width = 320,
                   height =
                       static_cast<unsigned>(std::clamp(110 + 210 * tall / wide, 200.0, 800.0));
    const std::string commands = fmt::format(
        "{}set multiplot layout {},{}\nset size ratio -1\nunset key\nset autoscale noextend\n"
        "set format cb '%.3g'\nset rmargin 9\n"
        "set palette defined (0 '#2c3e70', 0.35 '#3a8f8f', 0.7 '#e0c050', 1 '#b03020')\n"
        "set xlabel 'x (mm)'\nset ylabel 'z (mm)'\nset xtics {} \nset cbtics autofreq\n{}unset "
        "multiplot\n",
        blocks, lines, columns, std::max(10.0, std::floor(wide * size * 1e3 / 30) * 10), plots);
    return draw_with_gnuplot(png, width * columns, height * lines, commands);
}

} // namespace bris
