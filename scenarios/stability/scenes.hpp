#pragma once

#include "components/body.hpp"
#include "components/kinds.hpp"
#include "components/material.hpp"
#include "components/settings.hpp"
#include "components/sphere.hpp"
#include "engine/simulation.hpp"
#include "scenarios/rocks/mass_properties.hpp"
#include "scenarios/specimens/scene.hpp"

#include <cstdint>
#include <functional>
#include <string>

namespace bris::stress {

struct Setup {
    double dt = 1e-5; ///< s
    LawName law = LawName::linear;
    unsigned threads = 1;
    ListSettings lists = {};
    ScheduleSettings schedule = {};
    bool energy_budget = false;
};

/// Makes a simulation of a complete scene by adding its neighbour lists and steps.
Simulation begin(World world, const Setup& setup);

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

/// Adds a box of facets for grains inside. Each side has two triangles.
EntityId add_facet_box(World& world, const Vec3& low, const Vec3& high, std::uint32_t material);

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

/// Mean bounding radius (m) of the free bodies.
double mean_radius(const World& world);

} // namespace bris::stress
