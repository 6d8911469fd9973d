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

/// Kind of the bodies of a scene: single spheres need neither orientation nor an inertia tensor.
enum class Grains { spheres, clumps };

/// Makes a world with the columns of its bodies, a clock, limits and an empty table of materials.
World make_world(Grains grains);

/// Adds a single sphere (position and radius in m; density from the material) and returns its id.
/// Throws InputError unless the radius and, for a free body, the density are above 0.
EntityId add_sphere(World& world, const Vec3& position, double radius, std::uint32_t material,
                    Motion motion = Motion::free);

/// Adds a rigid clump that is already scaled to size and returns its id; `shape` is its index in
/// the library.
EntityId add_clump(World& world, const Clump& clump, std::uint32_t shape, const Vec3& position,
                   const Quat& orientation, std::uint32_t material, Motion motion = Motion::free);

/// Adds a body that carries boundary elements and returns its id. `reach`: greatest distance of the
/// elements from the position of the body, m.
EntityId add_boundary(World& world, const Vec3& position, std::uint32_t material,
                      Motion motion = Motion::fixed, double reach = 0);

/// Adds a plane through `point` (m, relative to the position of the host body); `normal` points to
/// the grains.
EntityId add_plane(World& world, EntityId host, const Vec3& point, const Vec3& normal);

/// Adds a facet; its corners are relative to the position of the host body (m) and
/// counter-clockwise seen from the grains.
EntityId add_facet(World& world, EntityId host, const FacetShape& shape);

/// Adds a membrane of `rings` x `sectors` elements at `radius` (m) around the z axis; sets its
/// body, outward directions and pressures.
void add_membrane(World& world, Membrane membrane, double radius, std::uint32_t material);

/// Current row of a body. Throws InputError if no body has this id.
Row row_of_body(const World& world, EntityId body);

/// Value of a component of the body with this id.
template <class C>
typename C::Value& value_of(World& world, EntityId body) {
    return world.column<Bodies, C>()[row_of_body(world, body)];
}
template <class C>
typename C::Value& value_of(Simulation& simulation, EntityId body) {
    return value_of<C>(simulation.world(), body);
}

/// Angular momentum (kg m2/s, world frame) of a body for a given angular velocity (rad/s).
Vec3 angular_momentum(const World& world, EntityId body, const Vec3& angular_velocity);

/// Sets the angular velocity of a body, rad/s, and the corresponding angular momentum. The elements
/// of a rotating boundary do not move; only their surface velocity changes.
void set_angular_velocity(World& world, EntityId body, const Vec3& angular_velocity);

/// Adds a plane z = 0 on a fixed body, with the grains above, and returns the body.
EntityId add_floor(World& world, std::uint32_t material);

/// Adds a box of six planes on one fixed body, with the grains inside, and returns the body.
EntityId add_box(World& world, const Vec3& low, const Vec3& high, std::uint32_t material);

/// Makes a linear material such that a contact between two partners of it has the stiffness `kn`,
/// `ks` (N/m). The stiffnesses of the two partners act in series.
Material linear_material(double kn, double ks = 0, double friction = 0, double density = 2600);

/// Makes a material so stiff that only the other partner deforms.
Material rigid_material(double friction = 1e9);

} // namespace bris
