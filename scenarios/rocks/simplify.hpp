#pragma once

#include "scenarios/rocks/rock.hpp"

#include <cstddef>

namespace bris {

/// The surface with at most `most` triangles, if it has more: the vertices in each cell of a grid
/// become one, where the planes of their triangles meet as nearly as possible (out-of-core
/// simplification, Lindstrom 2000), so that edges stay sharp. The triangles still close the surface
/// and have its orientation; two sheets closer than a cell may touch. `most`: at least 100. The
/// result depends on the surface alone.
Polyhedron simplified(const Polyhedron& surface, std::size_t most);

/// Mean and largest distance (m) of vertices of `fine`, some `count` of them evenly through their
/// list, from the surface `coarse`.
struct Deviation {
    double mean = 0, largest = 0;
};
Deviation deviation_of(const Polyhedron& coarse, const Polyhedron& fine, std::size_t count);

} // namespace bris
