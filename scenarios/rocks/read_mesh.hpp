#pragma once

#include "scenarios/rocks/rock.hpp"

#include <filesystem>

namespace bris {

/// Reads a closed surface from an STL file, text or binary (recognised by the size that a binary
/// file declares). Vertices closer than 1e-6 of the extent are merged, and triangles that collapse
/// thereby are dropped. A surface that is inside out is reversed. Lengths stay as in the file.
/// Throws InputError, one line with file:line (binary: the triangle), if the file does not have
/// this format, or if the surface is open or not a manifold: every edge must belong to exactly two
/// triangles that traverse it in opposite directions, in one piece, and the surface must not pass
/// through itself (1 % of the volume is tolerated). Throws OutputError if the file cannot be read.
Polyhedron read_stl(const std::filesystem::path& path);

/// The same from the v and f lines of a Wavefront OBJ file. Polygons are divided into fans of
/// triangles; all other lines are ignored.
Polyhedron read_obj(const std::filesystem::path& path);

/// The same from a PLY file (Turk 1994), text or binary in either byte order: the properties x, y
/// and z of the element "vertex" and the list vertex_indices (or vertex_index) of the element
/// "face". Polygons are divided into fans of triangles; all other elements and properties are
/// skipped.
Polyhedron read_ply(const std::filesystem::path& path);

/// Reads an STL, OBJ or PLY file, recognised by its extension .stl, .obj or .ply in lower or upper
/// case.
Polyhedron read_mesh(const std::filesystem::path& path);

} // namespace bris
