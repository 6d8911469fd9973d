#pragma once

#include "components/pair.hpp"
#include "engine/math.hpp"
#include "engine/world.hpp"

#include <array>
#include <cstdint>
#include <vector>

namespace bris {

/// A contact of the last step: of two rocks, or of a rock with a facet, plane or membrane.
struct Contact {
    std::size_t kind;        ///< index in contact_kinds
    EntityId owner, partner; ///< ids of the bodies; a boundary is the partner
    Vec3 point;              ///< m
    Vec3 force;              ///< N, on the owner
    double normal_force;     ///< N, positive in compression
    double overlap;          ///< m

    /// Magnitude of the force in the plane of contact, N.
    double shear_force() const;
};

/// What the partner is.
inline constexpr std::array contact_kinds{"sphere", "facet", "plane", "membrane"};

/// All contacts by kind, and by the names of their pairs within each kind: the same order for any
/// number of threads. Valid after steps in which Observation was due.
std::vector<Contact> contacts_of(const World& world);

} // namespace bris
