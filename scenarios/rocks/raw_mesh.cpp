#include "scenarios/rocks/raw_mesh.hpp"

#include "engine/errors.hpp"
#include "scenarios/rocks/winding.hpp"

#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <numeric>
#include <utility>

namespace bris {
namespace {

/// Merges corners that are closer than 1e-6 of the extent and returns the index of each corner in
/// the remaining list. Each corner is compared with those in the 27 grid cells around it.
std::vector<std::size_t> weld(std::vector<Vec3>& corners) {
    Vec3 low = Vec3::Constant(std::numeric_limits<double>::infinity()), high = -low;
    for (const Vec3& corner : corners) {
        low = low.cwiseMin(corner);
        high = high.cwiseMax(corner);
    }
    const double near = 1e-6 * (high - low).maxCoeff();
    std::map<std::array<std::int64_t, 3>, std::size_t> cells;
    std::vector<Vec3> kept;
    std::vector<std::size_t> index;
    for (const Vec3& corner : corners) {
        const Vec3 cell = (corner - low) / (near > 0 ? near : 1.0);
        const auto key = [&](int dx, int dy, int dz) {
            return std::array<std::int64_t, 3>{std::llround(cell.x()) + dx,
                                               std::llround(cell.y()) + dy,
                                               std::llround(cell.z()) + dz};
        };
        std::size_t found = kept.size();
        for (int k = 0; k < 27 && found == kept.size(); ++k)
            if (const auto at = cells.find(key(k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1));
                at != cells.end() && (kept[at->second] - corner).norm() <= near)
                found = at->second;
        if (found == kept.size()) {
            kept.push_back(corner);
            cells.emplace(key(0, 0, 0), found);
        }
        index.push_back(found);
    }
    corners = std::move(kept);
    return index;
}

/// Refuses a surface with holes, with edges of three triangles, or with inconsistent orientation.
void check_closed(const RawMesh& mesh) {
    std::map<std::array<std::size_t, 2>, std::size_t> directed;
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
        for (std::size_t side = 0; side < 3; ++side) {
            const auto& triangle = mesh.triangles[t];
            const bool first =
                directed.try_emplace({triangle[side], triangle[(side + 1) % 3]}, t).second;
            require(first, mesh.where(t) +
                               ": mesh: expected each edge once in each direction, found a "
                               "second triangle along one (not a manifold, or flipped)");
        }
    for (const auto& [edge, t] : directed)
        require(directed.contains({edge[1], edge[0]}),
                mesh.where(t) +
                    ": mesh: expected a closed surface, found an edge with one triangle only");
}

/// Refuses a surface in several pieces: of bodies within or through each other, volumes would count
/// twice, and two bodies apart are no rock.
void check_one_piece(const RawMesh& mesh) {
    std::vector<std::size_t> to(mesh.corners.size()); // a corner of the same piece, or itself
    std::iota(to.begin(), to.end(), std::size_t{0});
    const auto piece = [&](std::size_t corner) {
        while (to[corner] != corner) corner = to[corner] = to[to[corner]];
        return corner;
    };
    for (const auto& triangle : mesh.triangles)
        for (const std::size_t corner : triangle) to[piece(corner)] = piece(triangle[0]);
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
        if (piece(mesh.triangles[t][0]) != piece(mesh.triangles[0][0]))
            throw InputError(mesh.where(t) +
                             ": mesh: expected one closed surface, found another one that is not "
                             "connected with that of the first triangle");
}

/// Refuses a surface that passes through itself in more than the small folds that scans have.
void check_passes(const std::filesystem::path& path, const Polyhedron& solid) {
    constexpr double most = 0.01;
    const double share = miscounted_share(solid);
    require(share <= most,
            fmt::format("{}:1: mesh: expected a surface that does not pass through itself, found "
                        "{:.1f} % of its volume counted several times or as a hole",
                        path.string(), 100 * share));
}

} // namespace

Polyhedron closed_surface(RawMesh mesh) {
    require(!mesh.triangles.empty(),
            mesh.path.string() + ":1: mesh: expected triangles, found none");
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
        for (std::size_t corner : mesh.triangles[t])
            require(mesh.corners[corner].allFinite(),
                    mesh.where(t) + ": mesh: expected finite coordinates");
    const std::vector<std::size_t> index = weld(mesh.corners);
    RawMesh clean{.path = mesh.path, .corners = mesh.corners, .triangles = {}, .lines = {}};
    clean.binary = mesh.binary;
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
        const auto& [i, j, k] = mesh.triangles[t];
        const std::array<std::size_t, 3> welded{index[i], index[j], index[k]};
        if (welded[0] == welded[1] || welded[1] == welded[2] || welded[2] == welded[0]) continue;
        clean.triangles.push_back(welded);
        clean.lines.push_back(mesh.lines[t]);
    }
    require(!clean.triangles.empty(),
            mesh.path.string() + ":1: mesh: expected triangles with an area, found none");
    check_closed(clean);
    check_one_piece(clean);
    Polyhedron solid{.vertices = clean.corners,
                     .triangles = clean.triangles,
                     .faces = static_cast<int>(clean.triangles.size())};
    const double volume = mass_properties(solid).volume;
    require(std::abs(volume) > 0, mesh.path.string() + ":1: mesh: expected a body with a volume");
    if (volume < 0)
        for (auto& triangle : solid.triangles) std::swap(triangle[1], triangle[2]);
    check_passes(mesh.path, solid);
    return solid;
}

} // namespace bris
