#pragma once

#include "components/boundary.hpp"
#include "engine/signal/imu.hpp"
#include "engine/world.hpp"
#include "systems/loads/load.hpp"
#include "systems/loads/spring_patch.hpp"

#include <span>
#include <vector>

namespace bris {

// Free rigid bodies of facets, such as ties and plates, on which loads and spring-dashpot patches
// act, and recorders of motion. All need a scene of clumps.

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

/// Adds an inertial sensor on a body of a scene of clumps. It records once start_recording has been
/// called. Throws InputError.
void add_recorder(World& world, EntityId body, const ImuModel& model, const Vec3& gravity,
                  std::uint64_t seed);
/// Force (N) of the contacts on a body in the last step: what remains without its weight and the
/// forces of elements.
Vec3 contact_force(const World& world, EntityId body);
/// Begins the recordings of all inertial sensors at the present time and discards earlier samples.
/// Throws InputError if a sensor samples more often than once a step.
void start_recording(World& world);

} // namespace bris
