#include "scenarios/rocks/make_library.hpp"

#include "engine/errors.hpp"
#include "engine/io/csv.hpp"
#include "engine/random.hpp"
#include "scenarios/rocks/angularity.hpp"
#include "scenarios/rocks/clump_library.hpp"
#include "scenarios/rocks/dimensions.hpp"
#include "scenarios/rocks/read_mesh.hpp"
#include "scenarios/rocks/rock.hpp"
#include "scenarios/rocks/simplify.hpp"
#include "scenarios/rocks/surface_distance.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

namespace bris {
namespace {

/// Flat-and-elongated ratio of rank `rank` out of `count`: spread on both sides of the median, and
/// denser near it.
double spread(const LibrarySettings& settings, unsigned rank) {
    const double share = (rank + 0.5) / settings.count * 2 - 1;
    const double far = std::pow(std::abs(share), 1.3);
    const double end = share < 0 ? settings.least_flat_elongated : settings.greatest_flat_elongated;
    return settings.median_flat_elongated + far * (end - settings.median_flat_elongated);
}

RockSettings rock_settings(const LibrarySettings& settings, unsigned index) {
    // the number of faces must not be correlated with flatness: their ranks are shuffled
    std::vector<unsigned> ranks(settings.count);
    std::iota(ranks.begin(), ranks.end(), 0u);
    Random order(settings.seed, 101);
    for (std::size_t k = ranks.size(); k > 1; --k) std::swap(ranks[k - 1], ranks[order.bits() % k]);
    Random random(settings.seed, 200 + index);
    const double share = (ranks[index] + 0.5) / settings.count;
    const double span = settings.most_faces - settings.fewest_faces + 1.0;
    RockSettings rock;
    rock.flat_elongated = spread(settings, index);
    rock.flatness = random.uniform(0.3, 0.7);
    rock.faces = static_cast<int>(settings.fewest_faces) + static_cast<int>(share * span);
    rock.roughness = 0.4;
    return rock;
}

/// Computes the row of the report for one clump. `balls`: in the frame of the solid, sieve size 1.
LibraryRow compare(const std::string& name, const Polyhedron& solid, const std::vector<Ball>& balls,
                   const LibrarySettings& settings) {
    LibraryRow row;
    row.name = name;
    row.faces = solid.faces;
    const MassProperties wanted = mass_properties(solid), found = union_properties(balls);
    Vec3 wanted_moments = principal_axes(wanted.inertia).moments;
    Vec3 found_moments = principal_axes(found.inertia).moments;
    std::sort(wanted_moments.begin(), wanted_moments.end());
    std::sort(found_moments.begin(), found_moments.end());
    row.volume_error = found.volume / wanted.volume - 1;
    row.inertia_error =
        (found_moments.cwiseQuotient(wanted_moments) - Vec3::Ones()).cwiseAbs().maxCoeff();
    const SurfaceDistance to_clump = distance_to_union(solid, balls);
    const SurfaceDistance to_solid = distance_to_polyhedron(solid, balls);
    row.to_clump_mean = to_clump.mean, row.to_clump_max = to_clump.max;
    row.to_solid_mean = to_solid.mean, row.to_solid_max = to_solid.max;
    const Dimensions dimensions = compute_dimensions(vertex_balls(solid));
    row.flat_elongated_solid = dimensions.flat_elongated();
    row.flat_elongated_clump = compute_dimensions(balls).flat_elongated();
    row.angularity_solid = angularity(solid, dimensions.axes);
    row.angularity_clump = angularity(balls, dimensions.axes);
    row.hull_angularity_clump = hull_angularity(balls, dimensions.axes);
    row.sphericity_solid =
        std::cbrt(pi) * std::pow(6 * wanted.volume, 2.0 / 3) / surface_area(solid);
    const auto [least, greatest] =
        std::minmax_element(balls.begin(), balls.end(),
                            [](const Ball& a, const Ball& b) { return a.radius < b.radius; });
    row.least_radius = least->radius, row.greatest_radius = greatest->radius;
    FillSettings other = settings.fill;
    other.method = FillMethod::level_set;
    row.level_set_mean = distance_to_union(solid, fill_clump(solid, other, settings.seed)).mean;
    const Clump clump = make_clump(name, balls);
    row.clump = scaled(clump, 1 / clump.sieve);
    row.clump.sieve = 1;
    row.volume = row.clump.volume;
    return row;
}

Polyhedron normalised(Polyhedron solid) {
    const Vec3 centre = mass_properties(solid).centre;
    for (Vec3& vertex : solid.vertices) vertex -= centre;
    scale(solid, Vec3::Constant(1 / sieve_size(vertex_balls(solid))));
    return solid;
}

/// A scanned rock, with few enough triangles to fit spheres to it within two minutes.
struct ScannedRock {
    Polyhedron solid;
    std::string simplification;
};
ScannedRock read_rock(const std::filesystem::path& mesh) {
    constexpr std::size_t most_triangles = 5000, compared = 2000;
    const Polyhedron scanned = normalised(read_mesh(mesh));
    Polyhedron solid = simplified(scanned, most_triangles);
    if (solid.triangles.size() == scanned.triangles.size()) return {std::move(solid), {}};
    const Deviation deviation = deviation_of(solid, scanned, compared);
    const double volume = mass_properties(solid).volume / mass_properties(scanned).volume - 1;
    const std::string text = fmt::format("{} triangles of the scan were reduced to {}: its "
                                         "vertices are {:.2g} of the sieve size from "
                                         "them, at most {:.2g}; the volume differs by {:.2g}.",
                                         scanned.triangles.size(), solid.triangles.size(),
                                         deviation.mean, deviation.largest, volume);
    return {std::move(solid), text};
}

void write_report(const LibrarySettings& settings, const std::vector<LibraryRow>& rows,
                  const std::string& source) {
    std::vector<std::string> comments{
        source, "Lengths are in units of the sieve size of the solid. Errors are relative."};
    std::vector<std::vector<double>> values;
    for (std::size_t k = 0; k < rows.size(); ++k) {
        const LibraryRow& row = rows[k];
        comments.push_back(fmt::format("row {}: {}", k + 1, row.name));
        if (!row.simplification.empty()) comments.push_back(row.simplification);
        values.push_back({static_cast<double>(k + 1),
                          static_cast<double>(row.clump.balls.size()),
                          static_cast<double>(row.faces),
                          row.volume,
                          row.volume_error,
                          row.inertia_error,
                          row.to_clump_mean,
                          row.to_clump_max,
                          row.to_solid_mean,
                          row.to_solid_max,
                          row.flat_elongated_solid,
                          row.flat_elongated_clump,
                          row.flat_elongated_clump / row.flat_elongated_solid - 1,
                          row.angularity_solid,
                          row.angularity_clump,
                          row.angularity_clump / row.angularity_solid - 1,
                          row.hull_angularity_clump,
                          row.sphericity_solid,
                          row.least_radius,
                          row.greatest_radius,
                          row.level_set_mean});
    }
    write_csv(settings.out / "report.csv",
              {"row",
               "spheres",
               "faces",
               "volume",
               "volume_error",
               "inertia_error",
               "solid_to_clump_mean",
               "solid_to_clump_max",
               "clump_to_solid_mean",
               "clump_to_solid_max",
               "flat_elongated_solid",
               "flat_elongated_clump",
               "flat_elongated_error",
               "angularity_solid_deg",
               "angularity_clump_deg",
               "angularity_error",
               "hull_angularity_clump_deg",
               "sphericity_solid",
               "least_radius",
               "greatest_radius",
               "level_set_solid_to_clump_mean"},
              values, comments, 6);
}

void check(const LibrarySettings& settings) {
    require(settings.count >= 1, "clumps: expected at least one rock");
    require(1 <= settings.least_flat_elongated &&
                settings.least_flat_elongated <= settings.median_flat_elongated &&
                settings.median_flat_elongated <= settings.greatest_flat_elongated &&
                settings.greatest_flat_elongated <= 4,
            "clumps: flat-and-elongated ratios: expected 1 <= least <= median <= greatest <= 4");
    require(6 <= settings.fewest_faces && settings.fewest_faces <= settings.most_faces &&
                settings.most_faces <= 60,
            "clumps: faces: expected 6 <= fewest <= most <= 60");
}

} // namespace

std::vector<LibraryRow> make_library(const LibrarySettings& settings) {
    check(settings);
    std::error_code failure;
    std::filesystem::create_directories(settings.out, failure);
    if (failure) throw OutputError(settings.out.string() + ": cannot be created");
    std::vector<LibraryRow> rows;
    if (!settings.mesh.empty()) {
        const auto [solid, simplification] = read_rock(settings.mesh);
        rows.push_back(compare(settings.mesh.stem().string(), solid,
                               fill_clump(solid, settings.fill, settings.seed), settings));
        rows.back().simplification = simplification;
    }
    for (unsigned k = 0; settings.mesh.empty() && k < settings.count; ++k) {
        const Polyhedron solid = make_rock(rock_settings(settings, k), settings.seed, k);
        rows.push_back(compare(fmt::format("rock_{:02}", k + 1), solid,
                               fill_clump(solid, settings.fill, settings.seed), settings));
    }
    if (settings.mesh.empty() && settings.cube)
        rows.push_back(compare("cube", make_cube(1), fill_cube(settings.fill.fit), settings));
    const std::string source =
        settings.mesh.empty()
            ? fmt::format("SOURCE: scenario clumps, scenarios/rocks/make_library, seed {}",
                          settings.seed)
            : fmt::format("SOURCE: scenario clumps, from {}", settings.mesh.filename().string());
    for (const LibraryRow& row : rows)
        write_clump(settings.out / (row.name + ".csv"), row.clump, {source});
    write_report(settings, rows, source);
    return rows;
}

std::string sentence_of(const std::vector<LibraryRow>& rows) {
    std::string text = "name     spheres  volume error  inertia error  distance from rock mean, max"
                       "  flat and elongated of rock, clump";
    for (const LibraryRow& row : rows)
        text += fmt::format("\n{:8} {:7}  {:12.1e}  {:13.1e}  {:23.3f}, {:.3f}  {:26.2f}, {:.2f}",
                            row.name, row.clump.balls.size(), row.volume_error, row.inertia_error,
                            row.to_clump_mean, row.to_clump_max, row.flat_elongated_solid,
                            row.flat_elongated_clump);
    for (const LibraryRow& row : rows)
        if (!row.simplification.empty()) text += "\n" + row.simplification;
    return text;
}

} // namespace bris
