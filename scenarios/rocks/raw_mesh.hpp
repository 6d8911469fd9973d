#pragma once

#include "scenarios/rocks/rock.hpp"

#include <fmt/format.h>

#include <array>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace bris {

/// Triangles as read, each with its location in the file for messages.
struct RawMesh {
    std::filesystem::path path;
    std::vector<Vec3> corners;
    std::vector<std::array<std::size_t, 3>> triangles;
    std::vector<std::size_t> lines;
    bool binary = false;

    /// Adds a polygon, divided into triangles. `line`: where it is in the file. Throws InputError
    /// if it cannot be divided.
    void add_face(std::span<const std::size_t> polygon, std::size_t line);

    /// The location of a triangle: file:line, or its number in a binary file.
    std::string where(std::size_t triangle) const { return where_line(lines[triangle]); }

private:
    std::string where_line(std::size_t line) const {
        return fmt::format("{}:{}{}", path.string(), binary ? " triangle " : "", line);
    }
};

/// Joins the triangles and checks the surface as read_mesh states. Throws InputError.
Polyhedron closed_surface(RawMesh mesh);

} // namespace bris
