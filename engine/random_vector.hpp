#pragma once

#include "engine/random.hpp"

namespace bris {

// Draws in an order that is written: that of a call's arguments is the compiler's choice, and beds
// and recordings would depend on it. The last component is drawn first.

/// Components that are standard normal.
inline Vec3 normal_vector(Random& random) {
    const double z = random.normal(), y = random.normal(), x = random.normal();
    return {x, y, z};
}

/// Uniform in the box from `low` to `high`.
inline Vec3 place_in_box(Random& random, const Vec3& low, const Vec3& high) {
    const double z = random.uniform(low.z(), high.z()), y = random.uniform(low.y(), high.y()),
                 x = random.uniform(low.x(), high.x());
    return {x, y, z};
}

} // namespace bris
