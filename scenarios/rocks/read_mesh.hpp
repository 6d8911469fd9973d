#pragma once

#include "scenarios/rocks/rock.hpp"

#include <filesystem>

namespace bris {

/// Reads a closed surface from an STL file, text or binary (told apart by the size that a binary
/// file announces). Corners nearer than 1e-6 of the extent become one; triangles that vanish by
/// this are dropped. A surface that is inside out is turned. Lengths as in the file. Throws
/// InputError, one line with file:line (binary: the triangle), if the file is not of the format, or
/// the surface is open or not a manifold: every edge must belong to exactly two triangles that run
/// along it in opposite directions. Throws OutputError if the file cannot be read.
Polyhedron read_stl(const std::filesystem::path& path);

/// The same from the v and f lines of a Wavefront OBJ file; polygons are cut into fans, all other
/// lines are passed over.
Polyhedron read_obj(const std::filesystem::path& path);

/// By the ending of the file: .stl or .obj, in small or capital letters.
Polyhedron read_mesh(const std::filesystem::path& path);

} // namespace bris
