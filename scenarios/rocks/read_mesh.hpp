#pragma once

#include "scenarios/rocks/rock.hpp"

#include <filesystem>

namespace bris {

/// Reads a closed surface from an STL file, text or binary (recognised by the size that a binary
/// file declares). Triangles are joined along their edges: by the indices of the file where these
/// close the surface, else corners in the same place become one, and then, along edges that are
/// still open, corners closer than a hundredth of the shortest open edge there. Corners that no
/// triangle uses and triangles that collapse are dropped. A surface that is inside out is reversed.
/// Lengths stay as in the file. Throws InputError, one line with file:line (binary: the triangle),
/// if the file does not have this format, or if the surface is open or not a manifold: every edge
/// must belong to exactly two triangles that traverse it in opposite directions, in one piece, and
/// the surface must not pass through itself (1 % of the volume is tolerated). Throws OutputError if
/// the file cannot be read.
Polyhedron read_stl(const std::filesystem::path& path);

/// The same from the v and f lines of a Wavefront OBJ file. Polygons, also concave ones, are
/// divided into triangles; one that cannot be divided (see triangulated) or has more than 1 000
/// corners is refused. All other lines are ignored.
Polyhedron read_obj(const std::filesystem::path& path);

/// The same from a PLY file (Turk 1994), text or binary in either byte order: the properties x, y
/// and z of the element "vertex" and the list vertex_indices (or vertex_index) of the element
/// "face". Polygons as in an OBJ file; all other elements and properties are skipped.
Polyhedron read_ply(const std::filesystem::path& path);

/// Reads an STL, OBJ or PLY file, recognised by its extension .stl, .obj or .ply in lower or upper
/// case.
Polyhedron read_mesh(const std::filesystem::path& path);

} // namespace bris
