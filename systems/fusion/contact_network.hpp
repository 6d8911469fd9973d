#pragma once

#include "engine/world.hpp"
#include "systems/fusion/spring_network.hpp"

#include <vector>

namespace bris {

/// What bodies do that touch those of a network and are not of it.
enum class Others { join, stay };

/// The present contacts of `bodies` (rows) as springs, numbered as they stand there: normal ones,
/// and tangential ones of contacts that stick. `join`: adds to `bodies` all free ones that can be
/// reached from them, contact by contact; the first are the nearest. What is driven stays.
std::vector<Joint> joints_of(const World& world, std::vector<Row>& bodies, Others others);

} // namespace bris
