#include "scenarios/python/fields.hpp"

#include "engine/errors.hpp"
#include "systems/fields/field_set.hpp"
#include "systems/fields/image_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <pybind11/numpy.h>
#include <pybind11/stl.h>

namespace bris {

namespace py = pybind11;
using namespace py::literals;

namespace {

const FieldSet::Field& field_named(const FieldSet& set, const std::string& name) {
    if (const FieldSet::Field* found = set.find(name)) return *found;
    std::string names;
    for (const auto& field : set.fields) names += (names.empty() ? "" : ", ") + field.name;
    throw InputError(fmt::format("field: expected one of {}, found {}", names, name));
}

} // namespace

py::dict field_of(const World& world, const std::string& name, double voxel) {
    const FieldSet set = fields_of(world, {.voxel = voxel});
    const FieldSet::Field& field = field_named(set, name);
    const VoxelRange range = shown_range(set.blocks, set.shown);
    require(!range.empty(), "field: expected rocks in the scene, found none");
    const Voxel& low = range.low;
    std::vector<py::ssize_t> shape;
    for (int axis = 0; axis < 3; ++axis)
        shape.push_back(static_cast<py::ssize_t>(range.size(axis)));
    const std::size_t components = field.components.size();
    if (components > 1) shape.push_back(static_cast<py::ssize_t>(components));
    py::array_t<double> values(shape);
    double* to = values.mutable_data();
    std::fill_n(to, values.size(), std::numeric_limits<double>::quiet_NaN());
    for (std::uint32_t n = 0; n < set.blocks.voxels(); ++n) {
        if (set.shown[n] == 0) continue;
        const Voxel v = set.blocks.voxel(n);
        const py::ssize_t at =
            ((v.x - low.x) * shape[1] + (v.y - low.y)) * shape[2] + (v.z - low.z);
        for (std::size_t c = 0; c < components; ++c)
            to[static_cast<std::size_t>(at) * components + c] = field.components[c][n];
    }
    const Vec3 origin = set.blocks.lattice().centre(low);
    return py::dict("values"_a = values,
                    "origin"_a = std::array{origin.x(), origin.y(), origin.z()},
                    "voxel"_a = set.blocks.lattice().size, "units"_a = field.units);
}

py::dict fouling_of(const World& world) {
    require(world.has_resource<Fouling>(), "fouling: expected a scene with fines, found none");
    const FoulingMeasures m = measure_fouling(world, present_fouling(world));
    return py::dict("ballast_mass_kg"_a = m.ballast_mass, "fines_mass_kg"_a = m.fines_mass,
                    "void_volume_m3"_a = m.void_volume, "water_volume_m3"_a = m.water_volume,
                    "p4_percent"_a = m.p4, "p200_percent"_a = m.p200,
                    "fouling_index"_a = m.fouling_index,
                    "void_contaminant_index_percent"_a = m.contaminant_index,
                    "void_contamination_percent"_a = m.void_contamination,
                    "saturation_percent"_a = m.saturation);
}

} // namespace bris
