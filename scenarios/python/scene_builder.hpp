#pragma once

#include "scenarios/specimens/scene.hpp"
#include "systems/fusion/fuse.hpp"

#include <filesystem>
#include <pybind11/pybind11.h>
#include <string>
#include <utility>
#include <vector>

namespace bris {

/// A scene that is being built from Python. A Simulation that accepts it takes it over.
class SceneBuilder {
public:
    /// `grains`: "spheres" or "clumps"; `step`: time step, s, above 0; `gravity`: m/s2.
    SceneBuilder(const std::string& grains, double step, const Vec3& gravity);

    /// Adds a material with the properties of Material, given by their names, and returns its
    /// index. Throws InputError for an unknown name.
    std::uint32_t add_material(const pybind11::kwargs& properties);
    EntityId add_sphere(const Vec3& position, double radius, std::uint32_t material,
                        const std::string& motion);
    /// Adds a rock in the shape of a clump file, at a sieve size (m), turned by the orientation.
    EntityId add_rock(const std::filesystem::path& clump, double size, const Vec3& position,
                      const Quat& orientation, std::uint32_t material, const std::string& motion);
    /// Adds a plane on a body of its own; the normal points to the grains.
    EntityId add_plane(const Vec3& point, const Vec3& normal, std::uint32_t material,
                       const std::string& motion);
    /// Adds facets of three or four corners each (m, counter-clockwise as seen from the grains) on
    /// one body, whose position is the mean of all corners.
    EntityId add_facets(const std::vector<std::vector<Vec3>>& facets, std::uint32_t material,
                        const std::string& motion);
    /// Adds a membrane around the z axis, from z = 0 to `height` (m), whose servo keeps the
    /// pressure (Pa) of each ring, and a platen at either end; the upper one moves (move_platen).
    /// `contact_stiffness`: N/m, of a grain on an element.
    void add_membrane(double radius, double height, unsigned rings, unsigned sectors,
                      double pressure, double contact_stiffness, std::uint32_t material);
    void set_velocity(EntityId body, const Vec3& velocity);

    /// Makes a body a sensor rock whose recorded positions correct its motion. `times`: s on the
    /// clock of the simulation, ascending, above 0; `positions`: m, one for each time; `deviation`:
    /// m, standard deviation of an axis.
    void add_sensor(EntityId body, const std::vector<double>& times,
                    const std::vector<Vec3>& positions, double deviation);
    /// Settings of the filters of all sensors, by their names in FilterSettings. Throws InputError
    /// for an unknown name.
    void set_filter(const pybind11::kwargs& settings);
    /// Puts an inertial sensor of a class of devices (imu_preset) into a rock; it records from the
    /// start at `rate` (Hz).
    void add_recorder(EntityId body, const std::string& device, double rate, std::uint64_t seed);
    /// Fills the voids of the scene with fines and water (InitialFouling: %, %, fraction) on voxels
    /// (m), between planes, membrane and the corners `low` and `high` (m). No body comes after
    /// that.
    void add_fines(double p4, double p200, double saturation, double voxel, const Vec3& low,
                   const Vec3& high);

    /// A copy of the complete scene. Throws InputError if a simulation has taken it over.
    World complete() const;
    /// A simulation has taken it over: every other member throws InputError from now on.
    void close();

private:
    const World& world() const;
    World& world() { return const_cast<World&>(std::as_const(*this).world()); }
    void check(std::uint32_t material) const;
    World world_;
    bool taken_ = false;
    std::vector<EntityId> hosts_; // of sensors
    std::vector<std::vector<TimedMeasurement>> samples_;
    FilterSettings filter_;
};

} // namespace bris
