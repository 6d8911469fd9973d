#include "scenarios/rocks/read_mesh.hpp"

#include "engine/errors.hpp"
#include "engine/io/whole_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <map>
#include <sstream>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace bris {
namespace {

/// Triangles as read, each with its location in the file for messages.
struct RawMesh {
    std::filesystem::path path;
    std::vector<Vec3> corners;
    std::vector<std::array<std::size_t, 3>> triangles;
    std::vector<std::size_t> lines;
    bool binary = false;

    std::string where(std::size_t triangle) const {
        return fmt::format("{}:{}{}", path.string(), binary ? " triangle " : "", lines[triangle]);
    }
};

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
    Polyhedron solid{.vertices = clean.corners,
                     .triangles = clean.triangles,
                     .faces = static_cast<int>(clean.triangles.size())};
    const double volume = mass_properties(solid).volume;
    require(std::abs(volume) > 0, mesh.path.string() + ":1: mesh: expected a body with a volume");
    if (volume < 0)
        for (auto& triangle : solid.triangles) std::swap(triangle[1], triangle[2]);
    return solid;
}

RawMesh read_binary_stl(const std::filesystem::path& path, std::string_view bytes) {
    RawMesh mesh{.path = path, .corners = {}, .triangles = {}, .lines = {}, .binary = true};
    const std::size_t count = (bytes.size() - 84) / 50;
    for (std::size_t t = 0; t < count; ++t) {
        std::array<float, 9> numbers; // after the normal, which is recomputed from the corners
        std::memcpy(numbers.data(), bytes.data() + 84 + 50 * t + 12, sizeof numbers);
        const std::size_t base = mesh.corners.size();
        for (std::size_t k = 0; k < 9; k += 3)
            mesh.corners.emplace_back(static_cast<double>(numbers[k]),
                                      static_cast<double>(numbers[k + 1]),
                                      static_cast<double>(numbers[k + 2]));
        mesh.triangles.push_back({base, base + 1, base + 2});
        mesh.lines.push_back(t + 1);
    }
    return mesh;
}

RawMesh read_text_stl(const std::filesystem::path& path, const std::string& bytes) {
    RawMesh mesh{.path = path, .corners = {}, .triangles = {}, .lines = {}};
    std::istringstream text(bytes);
    std::string line, word;
    std::size_t since = 0; // corners of the current loop
    for (std::size_t number = 1; std::getline(text, line); ++number) {
        const auto refuse = [&](const std::string& what) {
            throw InputError(fmt::format("{}:{}: STL: {}", path.string(), number, what));
        };
        std::istringstream words(line);
        if (!(words >> word)) continue;
        if (number == 1 && word != "solid") refuse("expected \"solid\", found \"" + word + "\"");
        if (word == "vertex") {
            Vec3 corner;
            if (!(words >> corner.x() >> corner.y() >> corner.z()))
                refuse("vertex: expected three numbers");
            mesh.corners.push_back(corner);
            ++since;
        } else if (word == "endloop") {
            if (since != 3) refuse(fmt::format("facet: expected 3 vertices, found {}", since));
            const std::size_t base = mesh.corners.size() - 3;
            mesh.triangles.push_back({base, base + 1, base + 2});
            mesh.lines.push_back(number);
            since = 0;
        }
    }
    require(since == 0, path.string() + ": STL: the file ends inside a facet");
    return mesh;
}

} // namespace

Polyhedron read_stl(const std::filesystem::path& path) {
    const std::string bytes = read_whole(path);
    std::uint32_t announced = 0;
    if (bytes.size() >= 84) std::memcpy(&announced, bytes.data() + 80, sizeof announced);
    const bool binary = bytes.size() >= 84 && bytes.size() == 84 + 50 * std::size_t{announced};
    return closed_surface(binary ? read_binary_stl(path, bytes) : read_text_stl(path, bytes));
}

Polyhedron read_obj(const std::filesystem::path& path) {
    RawMesh mesh{.path = path, .corners = {}, .triangles = {}, .lines = {}};
    std::istringstream text(read_whole(path));
    std::string line, word;
    for (std::size_t number = 1; std::getline(text, line); ++number) {
        const auto refuse = [&](const std::string& what) {
            throw InputError(fmt::format("{}:{}: OBJ: {}", path.string(), number, what));
        };
        std::istringstream words(line);
        if (!(words >> word)) continue;
        if (word == "v") {
            Vec3 corner;
            if (!(words >> corner.x() >> corner.y() >> corner.z()))
                refuse("v: expected three numbers");
            mesh.corners.push_back(corner);
        } else if (word == "f") {
            std::vector<std::size_t> polygon;
            const auto known = static_cast<long>(mesh.corners.size());
            while (words >> word) {
                long index = 0; // "7", "7/1", "7//3"; counted from 1, or backwards if negative
                if (!(std::istringstream(word) >> index))
                    refuse("f: expected indices, found " + word);
                if (index < 0) index += known + 1;
                if (index < 1 || index > known)
                    refuse(fmt::format("f: expected an index in 1..{}, found {}", known, word));
                polygon.push_back(static_cast<std::size_t>(index - 1));
            }
            if (polygon.size() < 3) refuse("f: expected at least three indices");
            for (std::size_t k = 2; k < polygon.size(); ++k) {
                mesh.triangles.push_back({polygon[0], polygon[k - 1], polygon[k]});
                mesh.lines.push_back(number);
            }
        }
    }
    return closed_surface(std::move(mesh));
}

Polyhedron read_mesh(const std::filesystem::path& path) {
    std::string ending = path.extension().string();
    for (char& letter : ending)
        if (letter >= 'A' && letter <= 'Z') letter = static_cast<char>(letter - 'A' + 'a');
    if (ending == ".stl") return read_stl(path);
    if (ending == ".obj") return read_obj(path);
    throw InputError(path.string() + ": mesh: expected a file *.stl or *.obj");
}

} // namespace bris
