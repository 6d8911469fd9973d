#pragma once

#include "components/body.hpp"
#include "components/boundary.hpp"
#include "components/kinds.hpp"
#include "components/membrane.hpp"
#include "components/platen.hpp"
#include "engine/random.hpp"
#include "engine/simulation.hpp"
#include "scenarios/rocks/mass_properties.hpp"
#include "scenarios/specimens/scene.hpp"
#include "scenarios/specimens/small_scene.hpp"
#include "systems/broadphase/lists.hpp"
#include "systems/output/contacts.hpp"
#include "systems/steps.hpp"

#include <cmath>
#include <utility>

// Helpers that several tests use; small scenes are in scenarios/specimens/small_scene.hpp.

namespace bris::testing {

inline std::uint32_t add_material(World& world, const Material& material) {
    return world.resource<Materials>().add(material);
}

/// Observed order of convergence: log2 of the ratio of the errors at a step and at half of it.
inline double order_of(double coarse_error, double fine_error) {
    return std::log2(coarse_error / fine_error);
}

} // namespace bris::testing
