#pragma once

#include "scenarios/rocks/rock.hpp"

#include <fmt/format.h>

#include <array>
#include <filesystem>
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

    /// The location of a triangle: file:line, or its number in a binary file.
    std::string where(std::size_t triangle) const {
        return fmt::format("{}:{}{}", path.string(), binary ? " triangle " : "", lines[triangle]);
    }
};

/// Merges the corners and checks the surface as read_mesh states. Throws InputError.
Polyhedron closed_surface(RawMesh mesh);

} // namespace bris
