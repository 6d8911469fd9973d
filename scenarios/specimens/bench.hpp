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
struct BenchSettings {
    double dt = 1e-5; ///< s
    LawName law = LawName::linear;
    unsigned threads = 1;
    ListSettings lists = {};
    ScheduleSettings schedule = {}; ///< several threads are used however small the scene is
    bool energy_budget = false;
    bool unlimited = false; ///< neither overlaps nor speeds are limited: what results is measured
};

/// Adds the neighbour lists and the steps to a complete scene. Unlike `start` it does not check the
/// scene.
Simulation begin(World world, const BenchSettings& settings);

/// Calls side(corner, u, v) for the six sides of a box: the parallelogram from the corner along u
/// and v, u x v inwards.
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

/// Six overlapping balls of a rock, about 1 m across.
Clump small_rock();

/// Factors of the units of a scene.
struct Units {
    double length = 1, mass = 1, time = 1;
};

/// Grains of radius about 1 cm on a lattice, thrown about, that fall into a corner of a box of
/// planes; friction and dashpots. Its step for linear_viscous: 2e-5 s.
struct Tumble {
    Grains grains = Grains::spheres;
    unsigned bodies = 60;
    std::uint64_t seed = 1;
    Units units = {};
    bool walls = true;
};
World tumbling(const Tumble& t);

/// Upper corner of that box, m; its lower one is the origin.
Vec3 box_of(const Tumble& t);

/// A bed like that at rest under its weight: an undamped law, local damping 0.7. At most `ratio` of
/// its forces are unbalanced.
Simulation bed_at_rest(const Tumble& t, double ratio, double ks_ratio = 0.3);

/// Message of the InputError or SimulationError that `work` throws; empty if it throws none.
std::string refusal_of(const std::function<void()>& work);

enum class Walls { planes, facets };

/// What a bed is made of.
struct BenchBed {
    Grains grains = Grains::spheres;
    Walls walls = Walls::planes;
    unsigned bodies = 100;
    std::uint64_t seed = 1;
};

/// Grains of radius about 1 cm on a lattice, thrown about, in a box that they settle in; friction
/// on.
World bed(const BenchBed& bed);

/// A specimen without platens' friction: a membrane of `rings` x `sectors` elements about z, driven
/// by a servo, closed by two planes.
struct TubeSettings {
    unsigned rings = 2, sectors = 8;
    double radius = 0.05, height = 0.1, pressure = 1e4;
    double contact_stiffness = 1e5; ///< N/m, of a grain on an element
};

void add_tube(World& world, const TubeSettings& s, std::uint32_t material);

/// All touching pairs of the last step, taken together.
struct Touch {
    std::size_t pairs = 0;
    double overlap = 0;        ///< m, the largest
    double normal_force = 0;   ///< N, sum
    Vec3 force = Vec3::Zero(); ///< N, on the owners
    SpringRow spring{};        ///< of the last pair
    double friction_ratio = 0; ///< tangential over normal force, the largest
};
Touch touch_of(const World& world);

/// Kinetic energy (J) of a body that has been free of forces since the last step.
double free_kinetic_energy(World& world, EntityId body);

} // namespace bris
