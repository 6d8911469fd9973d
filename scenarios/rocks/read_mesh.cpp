#include "scenarios/rocks/read_mesh.hpp"

#include "engine/errors.hpp"
#include "engine/io/whole_file.hpp"
#include "scenarios/rocks/raw_mesh.hpp"

#include <fmt/format.h>

#include <array>
#include <cstdint>
#include <cstring>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

namespace bris {
namespace {

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

RawMesh read_text_stl(const std::filesystem::path& path, std::string_view bytes) {
    RawMesh mesh{.path = path, .corners = {}, .triangles = {}, .lines = {}};
    std::istringstream text{std::string(without_mark(bytes))};
    std::string line, word;
    std::size_t since = 0; // corners of the current loop
    for (std::size_t number = 1; std::getline(text, line); ++number) {
        const auto refuse = [&](const std::string& what) {
            throw InputError(fmt::format("{}:{}: STL: {}", path.string(), number, what));
        };
        std::istringstream words(line);
        if (!(words >> word)) continue;
        if (number == 1 && word != "solid")
            refuse(fmt::format("expected \"solid\", or a binary file of 84 + 50 N bytes with the "
                               "number N of its triangles in the bytes 81 to 84, found {} bytes",
                               bytes.size()));
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
    std::istringstream text(read_text(path));
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
            mesh.add_face(polygon, number);
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
    if (ending == ".ply") return read_ply(path);
    throw InputError(path.string() + ": mesh: expected a file *.stl, *.obj or *.ply");
}

} // namespace bris
