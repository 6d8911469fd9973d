#include "scenarios/rocks/simplify.hpp"

#include "scenarios/rocks/surface_distance.hpp"

#include <Eigen/Cholesky>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <unordered_map>

namespace bris {

namespace {

/// What the vertices of a cell become.
struct Cell {
    Vec3 sum = Vec3::Zero(); ///< of its vertices
    double vertices = 0;
    Mat3 normals = Mat3::Zero(); ///< of the planes through its vertices, weighted by area
    Vec3 offsets = Vec3::Zero();

    /// The point with the least weighted squared distance from all planes, held at the mean of the
    /// vertices where the planes leave a direction free, and within the cell.
    Vec3 point(double size) const {
        constexpr double hold = 1e-3; // of the weight of the planes
        const Vec3 mean = sum / vertices;
        const double weight = hold * normals.trace();
        if (!(weight > 0)) return mean;
        const Vec3 best =
            (normals + weight * Mat3::Identity()).ldlt().solve(offsets + weight * mean);
        return (best - mean).cwiseAbs().maxCoeff() < size ? best : mean;
    }
};

/// The cell of each vertex, numbered in the order of the vertices.
std::vector<std::size_t> cells_of_vertices(const Polyhedron& surface, double size) {
    Vec3 low = surface.vertices.front();
    for (const Vec3& x : surface.vertices) low = low.cwiseMin(x);
    std::unordered_map<std::uint64_t, std::size_t> number;
    std::vector<std::size_t> cell;
    cell.reserve(surface.vertices.size());
    for (const Vec3& x : surface.vertices) {
        const Eigen::Array3d at = ((x - low) / size).array().floor();
        const auto key = (static_cast<std::uint64_t>(at.x()) << 42) |
                         (static_cast<std::uint64_t>(at.y()) << 21) |
                         static_cast<std::uint64_t>(at.z());
        cell.push_back(number.try_emplace(key, number.size()).first->second);
    }
    return cell;
}

Polyhedron clustered(const Polyhedron& surface, double size) {
    const std::vector<std::size_t> cell = cells_of_vertices(surface, size);
    std::vector<Cell> cells(*std::ranges::max_element(cell) + 1);
    for (std::size_t v = 0; v < cell.size(); ++v) {
        cells[cell[v]].sum += surface.vertices[v];
        ++cells[cell[v]].vertices;
    }
    Polyhedron coarse;
    coarse.faces = surface.faces;
    for (const auto& [a, b, c] : surface.triangles) {
        const Vec3& corner = surface.vertices[a];
        const Vec3 normal = // twice the area long
            (surface.vertices[b] - corner).cross(surface.vertices[c] - corner);
        if (const double area = normal.norm(); area > 0)
            for (const std::size_t v : {a, b, c}) {
                Cell& of = cells[cell[v]];
                of.normals += normal * normal.transpose() / area;
                of.offsets += normal * normal.dot(corner) / area;
            }
        if (cell[a] != cell[b] && cell[b] != cell[c] && cell[a] != cell[c])
            coarse.triangles.push_back({cell[a], cell[b], cell[c]});
    }
    for (const Cell& of : cells) coarse.vertices.push_back(of.point(size));
    return coarse;
}

} // namespace

Polyhedron simplified(const Polyhedron& surface, std::size_t most) {
    if (surface.triangles.size() <= most) return surface;
    // a cell on the surface gives two triangles
    double size = std::sqrt(2 * surface_area(surface) / static_cast<double>(most));
    for (;; size *= 1.1)
        if (Polyhedron coarse = clustered(surface, size); coarse.triangles.size() <= most)
            return coarse;
}

Deviation deviation_of(const Polyhedron& coarse, const Polyhedron& fine, std::size_t count) {
    const std::size_t step = std::max<std::size_t>(1, fine.vertices.size() / count);
    Deviation deviation;
    double points = 0;
    for (std::size_t v = 0; v < fine.vertices.size(); v += step, ++points) {
        const double distance = std::abs(signed_distance(coarse, fine.vertices[v]));
        deviation.mean += distance;
        deviation.largest = std::max(deviation.largest, distance);
    }
    deviation.mean /= points;
    return deviation;
}

} // namespace bris
