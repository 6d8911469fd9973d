#pragma once

#include "scenarios/rocks/rock.hpp"

namespace bris {

/// Share of the volume of a solid in which its surface, passing through itself, counts it several
/// times or as a hole of negative volume: the length with a winding number other than 0 and 1 over
/// that with one other than 0, along some 2000 parallel lines. Lines that touch an edge are left
/// out. Shares below a thousandth may remain undetected.
double miscounted_share(const Polyhedron& polyhedron);

} // namespace bris
