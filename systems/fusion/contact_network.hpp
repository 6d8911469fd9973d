#pragma once

#include "engine/world.hpp"
#include "systems/fusion/spring_network.hpp"

#include <vector>

namespace bris {

/// Treatment of bodies that touch a network without being part of it: they join it, or they stay
/// where they are.
enum class Others { join, stay };

/// The present contacts of `bodies` (rows) as springs: normal springs, and tangential springs of
/// contacts that stick. Bodies are numbered by their index in `bodies`. `join`: appends to `bodies`
/// all free bodies that can be reached from them contact by contact, the nearest first. Driven
/// bodies stay.
std::vector<Joint> joints_of(const World& world, std::vector<Row>& bodies, Others others);

} // namespace bris
