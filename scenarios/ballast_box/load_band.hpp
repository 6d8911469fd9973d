#pragma once

#include "scenarios/ballast_box/train.hpp"

namespace bris {

/// Hz, up to which vibration follows the load: below it lie 99 % of the power of the second
/// derivative of an axle's load on a tie, to which the acceleration of what only bends is
/// proportional. It depends on rails, supports and speed (m/s), and hardly on the axles.
double load_band(double speed, const RailOnTies& rails);

} // namespace bris
