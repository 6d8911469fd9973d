// The Python module: functions that build, step and read a simulation. Files are read in
// bris/files.py.
#include "components/platen.hpp"
#include "engine/errors.hpp"
#include "engine/io/checkpoint.hpp"
#include "engine/version.hpp"
#include "scenarios/python/arrays.hpp"
#include "scenarios/python/fields.hpp"
#include "scenarios/python/initialised.hpp"
#include "scenarios/python/process.hpp"
#include "systems/contact/stable_step.hpp"
#include "systems/output/quantities.hpp"

#include <array>
#include <cmath>
#include <limits>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

namespace {

namespace py = pybind11;
using namespace bris;
using namespace py::literals;

using Triple = std::array<double, 3>;
using Quadruple = std::array<double, 4>;

Vec3 vector(const Triple& t) { return {t[0], t[1], t[2]}; }
Triple triple(const Vec3& v) { return {v.x(), v.y(), v.z()}; }

py::dict quantities_of(const World& world) {
    const Quantities q = compute_quantities(world);
    return py::dict(
        "kinetic_energy_J"_a = q.kinetic_energy, "elastic_energy_J"_a = q.elastic_energy,
        "coordination"_a = q.coordination, "contacts"_a = q.contacts,
        "mean_overlap_m"_a = q.mean_overlap, "largest_overlap_m"_a = q.largest_overlap,
        "mean_normal_force_N"_a = q.mean_normal_force, "unbalanced_ratio"_a = q.unbalanced_ratio,
        "boundary_force_N"_a = triple(q.boundary_force));
}

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr Triple nowhere{-infinity, -infinity, -infinity}, everywhere{infinity, infinity, infinity};

void define_scene(py::module_& m) {
    py::class_<SceneBuilder>(m, "Scene", "A scene that is being built; SI units.")
        .def(py::init([](const std::string& grains, double step, const Triple& gravity) {
                 return SceneBuilder(grains, step, vector(gravity));
             }),
             "grains"_a = "spheres", "step"_a, "gravity"_a = Triple{0, 0, -9.81},
             "grains: spheres or clumps; step: time step, s; gravity: m/s2.")
        .def("add_material", &SceneBuilder::add_material,
             "Adds a material by the properties density, normal_stiffness, ...; returns its index.")
        .def(
            "add_sphere",
            [](SceneBuilder& s, const Triple& x, double radius, std::uint32_t material,
               const std::string& motion) {
                return s.add_sphere(vector(x), radius, material, motion);
            },
            "position"_a, "radius"_a, "material"_a, "motion"_a = "free",
            "Adds a sphere (m) and returns the id of its body.")
        .def(
            "add_rock",
            [](SceneBuilder& s, const std::filesystem::path& clump, double size, const Triple& x,
               const Quadruple& q, std::uint32_t material, const std::string& motion) {
                return s.add_rock(clump, size, vector(x), Quat(q[3], q[0], q[1], q[2]), material,
                                  motion);
            },
            "clump"_a, "size"_a, "position"_a, "orientation"_a = Quadruple{0, 0, 0, 1},
            "material"_a, "motion"_a = "free",
            "Adds a rock in the shape of a clump file; size: sieve size, m; orientation: "
            "quaternion x, y, z, w.")
        .def(
            "add_plane",
            [](SceneBuilder& s, const Triple& point, const Triple& normal, std::uint32_t material,
               const std::string& motion) {
                return s.add_plane(vector(point), vector(normal), material, motion);
            },
            "point"_a, "normal"_a, "material"_a, "motion"_a = "fixed",
            "Adds a plane whose normal points to the grains; returns the id of its body.")
        .def(
            "add_facets",
            [](SceneBuilder& s, const std::vector<std::vector<Triple>>& facets,
               std::uint32_t material, const std::string& motion) {
                std::vector<std::vector<Vec3>> all;
                for (const auto& facet : facets) {
                    auto& corners = all.emplace_back();
                    for (const Triple& corner : facet) corners.push_back(vector(corner));
                }
                return s.add_facets(all, material, motion);
            },
            "facets"_a, "material"_a, "motion"_a = "fixed",
            "Adds triangles or quads (3 or 4 corners each, m, counter-clockwise as seen from the "
            "grains) on one body; returns its id.")
        .def("add_membrane", &SceneBuilder::add_membrane, "radius"_a, "height"_a, "rings"_a = 8,
             "sectors"_a = 12, "pressure"_a, "contact_stiffness"_a, "material"_a,
             "Adds a membrane around the z axis, from z = 0 upwards, with a platen at either end; "
             "its servo keeps the pressure (Pa) of each ring. contact_stiffness: of a grain on an "
             "element, N/m.")
        .def(
            "set_velocity",
            [](SceneBuilder& s, EntityId body, const Triple& v) {
                s.set_velocity(body, vector(v));
            },
            "body"_a, "velocity"_a, "Sets the velocity of a body, m/s.")
        .def(
            "add_sensor",
            [](SceneBuilder& s, EntityId body, const std::vector<double>& times,
               const std::vector<Triple>& positions, double deviation) {
                std::vector<Vec3> vectors;
                for (const Triple& x : positions) vectors.push_back(vector(x));
                s.add_sensor(body, times, vectors, deviation);
            },
            "body"_a, "times"_a, "positions"_a, "deviation"_a = 1e-4,
            "Makes a body a sensor rock, whose recorded positions (m, at times in s) correct its "
            "motion; deviation: their standard deviation, m.")
        .def("set_filter", &SceneBuilder::set_filter,
             "Settings of the filters of all sensors: standard deviations position, velocity, "
             "attitude, angular_velocity; model errors acceleration_density, "
             "angular_acceleration_density, drift, turning; gate.")
        .def("add_recorder", &SceneBuilder::add_recorder, "body"_a, "device"_a = "smartrock-like",
             "rate"_a = 500.0, "seed"_a = 1,
             "Puts an inertial sensor into a rock: ideal, lab-grade, smartrock-like or cheap; "
             "rate: Hz.")
        .def(
            "add_fines",
            [](SceneBuilder& s, double p4, double p200, double saturation, double voxel,
               const Triple& low, const Triple& high) {
                s.add_fines(p4, p200, saturation, voxel, vector(low), vector(high));
            },
            "p4"_a, "p200"_a = 0.0, "saturation"_a = 0.0, "voxel"_a = 5e-3, "low"_a = nowhere,
            "high"_a = everywhere,
            "Fills the voids, between planes, membrane and the corners low and high (m), with "
            "fines (% of the mass below 4.75 mm and 0.075 mm) and water (fraction of the rest), "
            "which weaken the contacts. No body may be added after that.");
}

void define_simulation(py::module_& m) {
    using Self = SteeredSimulation;
    py::class_<Self>(m, "Simulation", "A simulation of a scene, which it takes over.")
        .def(py::init<SceneBuilder&, const std::string&, unsigned>(), "scene"_a,
             "law"_a = "linear_viscous", "threads"_a = 1, "threads: 0: all cores.")
        .def("advance", &Self::advance, "steps"_a = 1,
             "Runs time steps. Raises SimulationError if a guard stops the run.")
        .def_property_readonly("time", [](Self& s) { return s.world().resource<Clock>().time(); })
        .def_property_readonly("step", [](Self& s) { return s.world().resource<Clock>().step; })
        .def_property_readonly("fingerprint", &Self::fingerprint,
                               "Hash of all State: the same bits give the same number.")
        .def(
            "view",
            [](const py::object& self, const std::string& table, const std::string& column,
               bool write) { return self.cast<Self&>().view(self, table, column, write); },
            "table"_a, "column"_a, "write"_a = false,
            "Array that shows a column's own memory, by row. Delete it before the next step.")
        .def("state", &Self::state,
             "Copies of all State, by names as bodies/position, in the order of the ids.")
        .def("contacts", &Self::contacts,
             "Touching pairs: kind, owner, partner (ids of bodies), point (m), force on the owner "
             "(N), normal_force (N), overlap (m).")
        .def(
            "quantities", [](Self& s) { return quantities_of(s.world()); },
            "Energies, coordination number, overlaps, unbalanced force ratio.")
        .def(
            "stable_step", [](Self& s) { return stable_step(s.world()); },
            "Largest stable time step (s) of the contacts of the last step.")
        .def(
            "force", [](Self& s, EntityId b) { return triple(value_of<Force>(s.world(), b)); },
            "body"_a, "Resultant force on a body in the last step, N.")
        .def(
            "position",
            [](Self& s, EntityId b) { return triple(value_of<Position>(s.world(), b)); }, "body"_a,
            "Position of a body, m.")
        .def(
            "drive",
            [](Self& s, EntityId b, const Triple& v) {
                require(value_of<MotionOf>(s.world(), b) ==
                            static_cast<std::uint32_t>(Motion::prescribed),
                        "drive: expected a body whose motion is prescribed, found id " +
                            std::to_string(b));
                require(vector(v).allFinite(), "drive: expected a finite velocity (m/s)");
                value_of<DriveVelocity>(s.world(), b) = vector(v);
            },
            "body"_a, "velocity"_a, "Sets the velocity (m/s) of a body of prescribed motion.")
        .def(
            "move_platen",
            [](Self& s, double speed) {
                require(s.world().has_resource<Platen>(),
                        "move_platen: expected a scene with a membrane, found none");
                require(std::isfinite(speed), "move_platen: expected a finite speed (m/s)");
                s.world().resource<Platen>().speed = speed;
            },
            "speed"_a, "Sets the speed (m/s, downwards) of the upper platen of a membrane.")
        .def(
            "membrane_pressure",
            [](Self& s) {
                require(s.world().has_resource<Membrane>(),
                        "membrane_pressure: expected a scene with a membrane, found none");
                return s.world().resource<Membrane>().pressure;
            },
            "Pressure (Pa) on each ring of the membrane in the last step.")
        .def("recordings", &Self::recordings, "exact"_a = false,
             "Recordings of the inertial sensors, a dictionary for each: body, time (s), force "
             "(m/s2) and rate (rad/s) in its axes, saturated. exact: by devices without errors.")
        .def(
            "field",
            [](Self& s, const std::string& name, double voxel) {
                return field_of(s.world(), name, voxel);
            },
            "name"_a, "voxel"_a = 5e-3,
            "A field of voxels, as porosity, velocity, mean_stress or fouling: values (by x, y, z; "
            "NaN outside the ballast), origin (m, centre of the first voxel), voxel (m), units.")
        .def(
            "fouling", [](Self& s) { return fouling_of(s.world()); },
            "Masses, volumes and indices of the fines of a scene.")
        .def("save", &Self::save, "path"_a, "Writes a checkpoint.")
        .def("load", &Self::load, "path"_a, "Restores a checkpoint of the same scene.");
}

} // namespace

PYBIND11_MODULE(_bris, m) {
    py::register_exception<InputError>(m, "InputError", PyExc_ValueError);
    py::register_exception<SimulationError>(m, "SimulationError", PyExc_RuntimeError);
    py::register_exception<OutputError>(m, "OutputError", PyExc_OSError);
    py::register_exception<BusyError>(m, "BusyError", PyExc_RuntimeError);
    m.attr("version") = bris::detail::build_facts.version;
    m.def(
        "laws", [] { return texts_of(LawName{}); }, "Names of the contact laws.");
    m.def(
        "read_checkpoint",
        [](const std::filesystem::path& path) {
            const Checkpoint checkpoint = read_checkpoint(path);
            py::dict settings;
            for (const NamedValue& s : checkpoint.settings)
                settings[py::str(s.key)] = py::cast(s.value);
            return py::dict("scenario"_a = checkpoint.scenario, "step"_a = checkpoint.step,
                            "settings"_a = settings, "state"_a = arrays_of(checkpoint.state));
        },
        "path"_a,
        "Scenario, step, settings and State of a checkpoint, whose seal is checked first.");
    define_scene(m);
    define_simulation(m);
    watch_process();
}
