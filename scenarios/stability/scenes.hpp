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

/// Adds the lists and the steps to a scene that is complete.
Simulation begin(World world, const Setup& setup);

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

/// A box of facets, each side two triangles, grains inside.
EntityId add_facet_box(World& world, const Vec3& low, const Vec3& high, std::uint32_t material);

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

/// Mean bounding radius (m) of the free bodies.
double mean_radius(const World& world);

} // namespace bris::stress
