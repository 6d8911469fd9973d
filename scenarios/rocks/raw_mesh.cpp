#include "scenarios/rocks/raw_mesh.hpp"

#include "engine/errors.hpp"
#include "scenarios/rocks/triangulate.hpp"
#include "scenarios/rocks/winding.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <utility>

namespace bris {
namespace {

using Edge = std::array<std::size_t, 2>;

/// The edges of the triangles in the direction in which they are traversed, in ascending order.
std::vector<Edge> directed_edges(const RawMesh& mesh) {
    std::vector<Edge> edges;
    edges.reserve(3 * mesh.triangles.size());
    for (const auto& triangle : mesh.triangles)
        for (std::size_t side = 0; side < 3; ++side)
            edges.push_back({triangle[side], triangle[(side + 1) % 3]});
    std::ranges::sort(edges);
    return edges;
}

/// Edges that are not traversed once in each direction.
std::vector<Edge> open_edges(const RawMesh& mesh) {
    const std::vector<Edge> edges = directed_edges(mesh);
    std::vector<Edge> open;
    for (std::size_t k = 0; k < edges.size(); ++k)
        if ((k > 0 && edges[k] == edges[k - 1]) ||
            !std::ranges::binary_search(edges, Edge{edges[k][1], edges[k][0]}))
            open.push_back(edges[k]);
    return open;
}

/// Replaces each corner by to[corner], then drops triangles that have lost a side and corners that
/// no triangle uses. The others keep their order.
void renumber(RawMesh& mesh, const std::vector<std::size_t>& to) {
    constexpr std::size_t unused = std::numeric_limits<std::size_t>::max();
    std::vector<std::size_t> number(mesh.corners.size(), unused);
    std::size_t kept = 0;
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
        auto [i, j, k] = mesh.triangles[t];
        i = to[i], j = to[j], k = to[k];
        if (i == j || j == k || k == i) continue;
        for (const std::size_t corner : {i, j, k}) number[corner] = 0;
        mesh.triangles[kept] = {i, j, k};
        mesh.lines[kept++] = mesh.lines[t];
    }
    mesh.triangles.resize(kept);
    mesh.lines.resize(kept);
    std::size_t next = 0;
    for (std::size_t corner = 0; corner < number.size(); ++corner)
        if (number[corner] != unused) {
            mesh.corners[next] = mesh.corners[corner];
            number[corner] = next++;
        }
    mesh.corners.resize(next);
    for (auto& triangle : mesh.triangles)
        for (std::size_t& corner : triangle) corner = number[corner];
}

std::vector<std::size_t> each_its_own(const RawMesh& mesh) {
    std::vector<std::size_t> to(mesh.corners.size());
    std::iota(to.begin(), to.end(), std::size_t{0});
    return to;
}

/// Corners in the same place become one.
void join_equal_corners(RawMesh& mesh) {
    std::vector<std::size_t> order = each_its_own(mesh), to = order;
    const auto place = [&](std::size_t corner) {
        const Vec3& x = mesh.corners[corner];
        return std::array{x.x(), x.y(), x.z()};
    };
    std::ranges::stable_sort(order, {}, place);
    for (std::size_t k = 1; k < order.size(); ++k)
        if (place(order[k]) == place(order[k - 1])) to[order[k]] = to[order[k - 1]];
    renumber(mesh, to);
}

/// Ends of open edges become one where they are closer than a hundredth of the shortest open edge
/// at either: the two sides of a crack, as rounding leaves them.
void join_cracks(RawMesh& mesh, const std::vector<Edge>& open) {
    std::map<std::size_t, double> near; // by corner
    for (const auto& [a, b] : open) {
        const double length = 0.01 * (mesh.corners[a] - mesh.corners[b]).norm();
        for (const std::size_t end : {a, b}) {
            const auto [at, is_new] = near.try_emplace(end, length);
            at->second = std::min(at->second, length);
        }
    }
    // sorted along a direction in which corners of regular meshes do not coincide
    const Vec3 direction = Vec3(1, 0.7, 0.4).normalized();
    const auto along = [&](std::size_t corner) { return mesh.corners[corner].dot(direction); };
    std::vector<std::size_t> ends;
    for (const auto& [corner, length] : near) ends.push_back(corner);
    std::ranges::stable_sort(ends, {}, along);
    std::vector<std::size_t> to = each_its_own(mesh);
    for (std::size_t k = 0; k < ends.size(); ++k) {
        const double here = near[ends[k]];
        for (std::size_t j = k; j-- > 0 && along(ends[k]) - along(ends[j]) <= here;) {
            const double apart = (mesh.corners[ends[k]] - mesh.corners[ends[j]]).norm();
            if (apart <= std::min(here, near[ends[j]])) to[ends[k]] = to[ends[j]];
        }
    }
    renumber(mesh, to);
}

/// Joins triangles along their edges. Corners that the file itself joins are left as they are.
void join_triangles(RawMesh& mesh) {
    renumber(mesh, each_its_own(mesh));
    if (open_edges(mesh).empty()) return;
    join_equal_corners(mesh);
    const std::vector<Edge> open = open_edges(mesh);
    if (!open.empty()) join_cracks(mesh, open);
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
/// twice, and two bodies apart, or that touch in a point, are no rock.
void check_one_piece(const RawMesh& mesh) {
    std::vector<std::size_t> to(mesh.triangles.size()); // a triangle of the same piece, or itself
    std::iota(to.begin(), to.end(), std::size_t{0});
    const auto piece = [&](std::size_t triangle) {
        while (to[triangle] != triangle) triangle = to[triangle] = to[to[triangle]];
        return triangle;
    };
    std::vector<std::pair<Edge, std::size_t>> sides; // and the triangle of each
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
        for (std::size_t side = 0; side < 3; ++side) {
            const std::size_t a = mesh.triangles[t][side], b = mesh.triangles[t][(side + 1) % 3];
            sides.push_back({{std::min(a, b), std::max(a, b)}, t});
        }
    std::ranges::sort(sides);
    for (std::size_t k = 1; k < sides.size(); ++k)
        if (sides[k].first == sides[k - 1].first)
            to[piece(sides[k].second)] = piece(sides[k - 1].second);
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
        if (piece(t) != piece(0))
            throw InputError(mesh.where(t) +
                             ": mesh: expected one closed surface, found another one that is not "
                             "connected with that of the first triangle along an edge");
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

void RawMesh::add_face(std::span<const std::size_t> polygon, std::size_t line) {
    constexpr std::size_t most = 1000; // corners; the time grows with their square and more
    const auto expect = [&](bool is_met, const std::string& what) {
        if (!is_met) throw InputError(where_line(line) + ": mesh: " + what);
    };
    if (polygon.size() > 3) {
        expect(polygon.size() <= most, fmt::format("expected at most {} corners of a polygon, "
                                                   "found {}",
                                                   most, polygon.size()));
        for (const std::size_t corner : polygon)
            expect(corners[corner].allFinite(), "expected finite coordinates");
    }
    const auto divided = triangulated(corners, polygon);
    expect(!divided.empty(), fmt::format("expected a polygon with an area that does not cross "
                                         "itself, found one of {} corners that cannot be divided "
                                         "into triangles",
                                         polygon.size()));
    triangles.insert(triangles.end(), divided.begin(), divided.end());
    lines.resize(triangles.size(), line);
}

Polyhedron closed_surface(RawMesh mesh) {
    require(!mesh.triangles.empty(),
            mesh.path.string() + ":1: mesh: expected triangles, found none");
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
        for (std::size_t corner : mesh.triangles[t])
            require(mesh.corners[corner].allFinite(),
                    mesh.where(t) + ": mesh: expected finite coordinates");
    join_triangles(mesh);
    require(!mesh.triangles.empty(),
            mesh.path.string() + ":1: mesh: expected triangles with an area, found none");
    check_closed(mesh);
    check_one_piece(mesh);
    Polyhedron solid{
        .vertices = std::move(mesh.corners), .triangles = std::move(mesh.triangles), .faces = 0};
    solid.faces = static_cast<int>(solid.triangles.size());
    const double volume = mass_properties(solid).volume;
    require(std::abs(volume) > 0, mesh.path.string() + ":1: mesh: expected a body with a volume");
    if (volume < 0)
        for (auto& triangle : solid.triangles) std::swap(triangle[1], triangle[2]);
    check_passes(mesh.path, solid);
    return solid;
}

} // namespace bris
