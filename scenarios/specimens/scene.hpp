#pragma once

#include "components/body.hpp"
#include "components/boundary.hpp"
#include "components/clump.hpp"
#include "components/kinds.hpp"
#include "components/material.hpp"
#include "components/membrane.hpp"
#include "components/settings.hpp"
#include "engine/simulation.hpp"
#include "engine/world.hpp"

namespace bris {

/// What the bodies of a scene are: single spheres need neither orientation nor an inertia tensor.
enum class Grains { spheres, clumps };

/// A world with the columns of its bodies, a clock, limits and an empty table of materials.
World make_world(Grains grains);

/// Adds a single sphere (m, kg/m3 from the material) and returns its id.
EntityId add_sphere(World& world, const Vec3& position, double radius, std::uint32_t material,
                    Motion motion = Motion::free);

/// Adds a rigid clump, already scaled to size; `shape` is its number in the library.
EntityId add_clump(World& world, const Clump& clump, std::uint32_t shape, const Vec3& position,
                   const Quat& orientation, std::uint32_t material, Motion motion = Motion::free);

/// Adds a body that carries boundary elements. `reach`: the farthest that they lie from its
/// position, m.
EntityId add_boundary(World& world, const Vec3& position, std::uint32_t material,
                      Motion motion = Motion::fixed, double reach = 0);

/// A plane through `point` (relative to the host's position); grains are where `normal` points.
EntityId add_plane(World& world, EntityId host, const Vec3& point, const Vec3& normal);

/// A facet; corners relative to the host's position, counter-clockwise seen from the grains.
EntityId add_facet(World& world, EntityId host, const FacetShape& shape);

/// A membrane of `rings` x `sectors` elements at `radius` (m) around the z axis; its body, outward
/// directions and pressures are filled in.
void add_membrane(World& world, Membrane membrane, double radius, std::uint32_t material);

/// Row of a body now.
Row row_of_body(const World& world, EntityId body);

/// The value of a component of a body, found by its id.
template <class C>
typename C::Value& value_of(World& world, EntityId body) {
    return world.column<Bodies, C>()[row_of_body(world, body)];
}
template <class C>
typename C::Value& value_of(Simulation& simulation, EntityId body) {
    return value_of<C>(simulation.world(), body);
}

/// Moment of inertia (kg m2, world frame) times spin.
Vec3 angular_momentum(const World& world, EntityId body, const Vec3& angular_velocity);

/// Spin of a body, rad/s, with the angular momentum that goes with it. A boundary that turns keeps
/// its shape.
void set_angular_velocity(World& world, EntityId body, const Vec3& angular_velocity);

/// A plane z = 0 on a fixed body, grains above.
EntityId add_floor(World& world, std::uint32_t material);

/// A box of six planes on one fixed body, grains inside.
EntityId add_box(World& world, const Vec3& low, const Vec3& high, std::uint32_t material);

/// A material of which two partners have a contact of stiffness `kn`, `ks` (N/m; they act in
/// series).
Material linear_material(double kn, double ks = 0, double friction = 0, double density = 2600);

/// One so stiff that a partner alone deforms.
Material rigid_material(double friction = 1e9);

} // namespace bris
