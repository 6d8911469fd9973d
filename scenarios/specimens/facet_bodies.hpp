#pragma once

#include "components/boundary.hpp"
#include "components/load.hpp"
#include "engine/signal/imu.hpp"
#include "engine/world.hpp"

#include <span>
#include <vector>

namespace bris {

// Free rigid bodies of facets, such as ties and plates, and what acts on bodies besides contacts
// and weight. All need a scene of clumps.

/// Adds a free body that facets enclose, in a scene of clumps, and returns its id. Its axes are the
/// principal axes and its position is the centre of mass. `mass`: kg; `inertia`: kg m2, principal
/// moments; corners of the facets: m, in the body's axes, counter-clockwise seen from outside. It
/// touches spheres only: facets do not touch planes or other facets. Throws InputError.
EntityId add_facet_body(World& world, const Vec3& position, const Quat& orientation, double mass,
                        const Vec3& inertia, std::uint32_t material,
                        std::span<const FacetShape> facets);

/// The six sides of a box about the origin, with normals outwards; `size`: m.
std::vector<FacetShape> block_facets(const Vec3& size);
/// Principal moments of inertia (kg m2) of a homogeneous box.
Vec3 block_inertia(const Vec3& size, double mass);
/// Adds a free homogeneous box of facets.
EntityId add_block(World& world, const Vec3& position, const Quat& orientation, const Vec3& size,
                   double mass, std::uint32_t material);

/// Adds a load on a free body in a scene of clumps. Throws InputError.
void add_load(World& world, EntityId body, const Load& load);
/// Adds a spring and a dashpot between a free body in a scene of clumps and the ground. Throws
/// InputError.
void add_patch(World& world, EntityId body, const SpringPatch& patch);
/// Adds a patch that holds a point of a body (m, in its axes, which must be those of the world)
/// where it is now, along an axis.
void add_guide(World& world, EntityId body, const Vec3& point, const Vec3& axis, double stiffness,
               double damping);
/// Adds an inertial sensor on a body of a scene of clumps. It records once start_recording has been
/// called. Throws InputError.
void add_recorder(World& world, EntityId body, const ImuModel& model, const Vec3& gravity,
                  std::uint64_t seed);
/// Force (N) of the contacts on a body that has loads and patches, from the last step: what remains
/// without these and its weight.
Vec3 contact_force(const World& world, EntityId body);
/// Begins the recordings of all inertial sensors at the present time and discards earlier samples.
/// Throws InputError if a sensor samples more often than once a step.
void start_recording(World& world);

} // namespace bris
