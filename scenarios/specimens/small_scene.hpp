#pragma once

#include "components/body.hpp"
#include "components/kinds.hpp"
#include "components/material.hpp"
#include "components/settings.hpp"
#include "components/sphere.hpp"
#include "engine/simulation.hpp"
#include "scenarios/rocks/mass_properties.hpp"
#include "scenarios/specimens/scene.hpp"
#include "systems/output/contacts.hpp"

#include <cstdint>
#include <functional>
#include <string>

namespace bris {

// The small scenes that the verification, the stability suite and the tests start from.

/// How a small scene is simulated.
struct SmallSceneSettings {
    double dt = 1e-5; ///< s
    LawName law = LawName::linear;
    unsigned threads = 1;
    ListSettings lists = {};
    ScheduleSettings schedule = {}; ///< threads are used however few rows the scene has
    bool energy_budget = false;
    bool unlimited = false; ///< overlap and speed have no practical limit
};

/// Adds the neighbour lists and the steps to a complete scene. Unlike `start` it does not check the
/// scene.
Simulation begin(World world, const SmallSceneSettings& settings);

/// Calls side(corner, u, v) for the six sides of a box. A side is the parallelogram from the corner
/// along u and v, with u x v inwards.
template <class Side>
void for_sides_of_box(const Vec3& low, const Vec3& high, Side&& side) {
    const Vec3 d = high - low, x = d.x() * Vec3::UnitX(), y = d.y() * Vec3::UnitY(),
               z = d.z() * Vec3::UnitZ();
    side(low, x, y);
    side(low, y, z);
    side(low, z, x);
    side(high, -y, -x);
    side(high, -z, -y);
    side(high, -x, -z);
}

/// A box of facets with the grains inside; each side is two triangles.
EntityId add_facet_box(World& world, const Vec3& low, const Vec3& high, std::uint32_t material);
/// The same with each side cut into n x n rectangles.
EntityId add_facet_box(World& world, const Vec3& low, const Vec3& high, int n,
                       std::uint32_t material);

/// The square [low, high]^2 at z = 0 as n x n facets of one fixed body, normals up.
EntityId add_facet_floor(World& world, double low, double high, int n, std::uint32_t material);

/// The same square as two triangles, cut along the diagonal from the low corner.
EntityId add_triangle_floor(World& world, double low, double high, std::uint32_t material);

/// A clump of six overlapping spheres, about 1 m across.
Clump small_rock();

/// Factors by which the units of a scene are scaled.
struct Units {
    double length = 1, mass = 1, time = 1;
};

/// Grains with a radius of about 1 cm, friction and dashpots, which start on a lattice with random
/// velocities and fall into a corner of a box of planes. Time step for linear_viscous: 2e-5 s.
struct Tumble {
    Grains grains = Grains::spheres;
    unsigned bodies = 60;
    std::uint64_t seed = 1;
    Units units = {};
    bool walls = true;
};
World tumbling(const Tumble& t);

/// Upper corner of that box, m. The lower corner is the origin.
Vec3 box_of(const Tumble& t);

/// The same grains at rest under their weight, with a law without dashpots and local damping 0.7.
/// The unbalanced force ratio is at most `ratio`.
Simulation bed_at_rest(const Tumble& t, double ratio, double ks_ratio = 0.3);

/// Message of the InputError or SimulationError that `work` throws. Empty if it throws none.
std::string refusal_of(const std::function<void()>& work);

enum class Walls { planes, facets };

/// What a bed is made of.
struct SmallBed {
    Grains grains = Grains::spheres;
    Walls walls = Walls::planes;
    unsigned bodies = 100;
    std::uint64_t seed = 1;
};

/// Grains with a radius of about 1 cm and friction, which start on a lattice with random velocities
/// and settle in a box of planes or of facets.
World bed(const SmallBed& bed);

/// A cylindrical membrane of `rings` x `sectors` elements about the z axis, driven by a servo and
/// closed by two planes; the upper one is a platen. Of latex, it is a sleeve with three columns of
/// nodes for each sector and four levels for each ring.
struct TubeSettings {
    unsigned rings = 2, sectors = 8;
    double radius = 0.05, height = 0.1, pressure = 1e4;
    double contact_stiffness = 1e5; ///< N/m, of a grain on an element
    bool latex = false;
};

void add_tube(World& world, const TubeSettings& s, std::uint32_t material);

/// Summary of all touching pairs of the last step.
struct Touch {
    std::size_t pairs = 0;
    double overlap = 0;        ///< m, largest of all pairs
    double normal_force = 0;   ///< N, sum over all pairs
    Vec3 force = Vec3::Zero(); ///< N, sum of the forces on the owners of the pairs
    SpringRow spring{};        ///< of the last pair
    double friction_ratio = 0; ///< largest ratio of tangential to normal force
};
Touch touch_of(const World& world);

/// Kinetic energy (J) of a body on which no force has acted since the last step.
double free_kinetic_energy(World& world, EntityId body);

} // namespace bris
