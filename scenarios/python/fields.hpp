#pragma once

#include "engine/world.hpp"

#include <pybind11/pybind11.h>
#include <string>

namespace bris {

/// A field of a scene (FieldSet) as a dictionary: `values`, an array by voxel along x, y and z, and
/// for vectors by component, NaN outside the ballast; `origin`, centre of its first voxel (m);
/// `voxel`, their edge (m); `units`. Throws InputError that lists the fields if there is none of
/// this name. `voxel`: m; a scene with fines has that of its fields.
pybind11::dict field_of(const World& world, const std::string& name, double voxel);

/// Measures of the fouling of all rocks, by names with units. Throws InputError without fines.
pybind11::dict fouling_of(const World& world);

} // namespace bris
