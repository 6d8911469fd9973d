#pragma once

#include "components/body.hpp"
#include "components/kinds.hpp"
#include "components/material.hpp"
#include "engine/simulation.hpp"
#include "systems/build/scene.hpp"
#include "systems/output/contacts.hpp"

namespace bris {

// What small experiments share: a scene is built, run step by step, and read.

/// The value of a component of a body, found by its id.
template <class C> typename C::Value& value_of(World& world, EntityId body) {
    return world.column<Bodies, C>()[row_of_body(world, body)];
}
template <class C> typename C::Value& value_of(Simulation& simulation, EntityId body) {
    return value_of<C>(simulation.world(), body);
}

/// Moment of inertia (kg m2, world frame) times spin.
Vec3 angular_momentum(World& world, EntityId body, const Vec3& spin);

/// A complete scene with lists and steps, on one thread. Overlaps are not limited: what is asked for is measured.
Simulation begin(World world, LawName law, double dt, bool ledger = false, unsigned threads = 1);

/// A plane z = 0 on a fixed body, grains above.
EntityId add_floor(World& world, std::uint32_t material);

/// A material of which two partners have a contact of stiffness `kn`, `ks` (N/m; they act in series).
Material linear_material(double kn, double ks = 0, double friction = 0, double density = 2600);

/// The same elastic constants, so stiff that a partner alone deforms.
Material rigid_material(double friction = 1e9);

/// All touching pairs of the last step, taken together.
struct Touch {
    std::size_t pairs = 0;
    double overlap = 0;            ///< m, the largest
    double normal_force = 0;       ///< N, sum
    Vec3 force = Vec3::Zero();     ///< N, on the owners
    SpringRow spring{};            ///< of the last pair
    double friction_ratio = 0;     ///< tangential over normal force, the largest
};
Touch touch_of(const World& world);

/// Kinetic energy (J) of a body that has been free of forces since the last step.
double free_kinetic_energy(World& world, EntityId body);

} // namespace bris
