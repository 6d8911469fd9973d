#include "scenarios/rocks/clump_library.hpp"

#include "engine/errors.hpp"
#include "engine/io/csv.hpp"
#include "engine/io/whole_file.hpp"
#include "scenarios/rocks/mass_properties.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <map>
#include <sstream>

namespace bris {
namespace {

struct Stored {
    double value;
    int line;
};

/// Reads the comment lines of the form "# name = number".
std::map<std::string, Stored> read_stored(const std::filesystem::path& path) {
    std::istringstream file(read_text(path));
    std::map<std::string, Stored> stored;
    std::string text;
    for (int line = 1; std::getline(file, text); ++line) {
        const std::size_t equals = text.find(" = ");
        if (text.rfind("# ", 0) != 0 || equals == std::string::npos) continue;
        double value = 0;
        const char* end = text.data() + text.size();
        if (std::from_chars(text.data() + equals + 3, end, value).ec == std::errc())
            stored[text.substr(2, equals - 2)] = {value, line};
    }
    return stored;
}

void check(const std::filesystem::path& path, const std::string& what, const Stored& stored,
           double found, double scale) {
    if (std::abs(stored.value - found) <= 1e-3 * scale) return;
    throw InputError(fmt::format("{}:{}: {}: expected {:.6g} from the spheres, found {:.6g}",
                                 path.string(), stored.line, what, found, stored.value));
}

/// Compares the stored mass properties with those computed from the spheres.
void verify(const std::filesystem::path& path, const Clump& clump,
            const std::map<std::string, Stored>& stored) {
    const MassProperties found = union_properties(clump.balls, 128);
    check(path, "volume", stored.at("volume"), found.volume, found.volume);
    const char* names[] = {"inertia_x", "inertia_y", "inertia_z"};
    for (int k = 0; k < 3; ++k)
        check(path, names[k], stored.at(names[k]), found.inertia(k, k), found.inertia.trace() / 3);
    check(path, "sieve", stored.at("sieve"), sieve_size(clump.balls), clump.sieve);
    const Mat3 diagonal = found.inertia.diagonal().asDiagonal();
    require(found.centre.norm() < 1e-3 * clump.sieve,
            path.string() + ": expected the centre of mass at the origin");
    require((found.inertia - diagonal).norm() < 1e-3 * found.inertia.trace(),
            path.string() + ": expected axes along the principal axes");
}

} // namespace

Clump read_clump(const std::filesystem::path& path) {
    const CsvTable table = read_csv(path);
    const auto stored = read_stored(path);
    const auto need = [&](const std::string& name) {
        const auto found = stored.find(name);
        require(found != stored.end(),
                fmt::format("{}: expected a line \"# {} = ...\", found none", path.string(), name));
        require(found->second.value > 0 && std::isfinite(found->second.value),
                fmt::format("{}:{}: {}: expected a positive number, found {}", path.string(),
                            found->second.line, name, found->second.value));
        return found->second.value;
    };
    Clump clump;
    clump.name = path.stem().string();
    clump.volume = need("volume");
    clump.inertia = {need("inertia_x"), need("inertia_y"), need("inertia_z")};
    clump.sieve = need("sieve");
    const std::vector<double> x = table.column("x"), y = table.column("y"), z = table.column("z"),
                              radius = table.column("radius");
    constexpr std::size_t most = 10'000; // verify would take minutes, and a step seconds
    require(
        !radius.empty() && radius.size() <= most,
        fmt::format("{}: expected 1 to {} spheres, found {}", path.string(), most, radius.size()));
    std::map<std::array<double, 4>, int> first; // line of each sphere
    for (std::size_t k = 0; k < radius.size(); ++k) {
        const Vec3 centre(x[k], y[k], z[k]);
        constexpr double farthest = 100; // m
        require(centre.allFinite() && centre.cwiseAbs().maxCoeff() <= farthest && radius[k] > 0 &&
                    radius[k] <= farthest,
                fmt::format("{}:{}: expected three coordinates and a positive radius of at most "
                            "{:g} m, found {:.4g}, {:.4g}, {:.4g} and {:.4g}",
                            path.string(), table.lines[k], farthest, x[k], y[k], z[k], radius[k]));
        // two in one place would touch with twice the stiffness
        const auto [other, is_new] =
            first.try_emplace({x[k], y[k], z[k], radius[k]}, table.lines[k]);
        require(is_new, fmt::format("{}:{}: expected each sphere once, found that of line {} again",
                                    path.string(), table.lines[k], other->second));
        clump.balls.push_back({centre, radius[k]});
        clump.bounding_radius = std::max(clump.bounding_radius, centre.norm() + radius[k]);
    }
    verify(path, clump, stored);
    return clump;
}

std::vector<Clump> read_clumps(const std::filesystem::path& directory) {
    std::error_code failure;
    std::vector<std::filesystem::path> paths;
    for (const auto& entry : std::filesystem::directory_iterator(directory, failure))
        if (entry.path().extension() == ".csv" && entry.path().stem() != "report")
            paths.push_back(entry.path());
    require(!failure && !paths.empty(),
            directory.string() + ": expected a directory with clumps (*.csv), found none");
    std::sort(paths.begin(), paths.end());
    std::vector<Clump> clumps;
    for (const auto& path : paths) clumps.push_back(read_clump(path));
    return clumps;
}

void write_clump(const std::filesystem::path& path, const Clump& clump,
                 const std::vector<std::string>& comments) {
    std::vector<std::string> lines = comments;
    lines.emplace_back(
        "Unit of length: the sieve size. Axes: principal axes. Origin: centre of mass.");
    lines.push_back(fmt::format("volume = {:.17g}", clump.volume));
    lines.push_back(fmt::format("inertia_x = {:.17g}", clump.inertia.x()));
    lines.push_back(fmt::format("inertia_y = {:.17g}", clump.inertia.y()));
    lines.push_back(fmt::format("inertia_z = {:.17g}", clump.inertia.z()));
    lines.push_back(fmt::format("sieve = {:.17g}", clump.sieve));
    std::vector<std::vector<double>> rows;
    for (const Ball& ball : clump.balls)
        rows.push_back({ball.centre.x(), ball.centre.y(), ball.centre.z(), ball.radius});
    write_csv(path, {"x", "y", "z", "radius"}, rows, lines);
}

} // namespace bris
