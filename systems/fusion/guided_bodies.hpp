#pragma once

#include "components/sensor.hpp"
#include "engine/rows.hpp"

namespace bris {

/// Calls visit(row) for each body that is corrected or nudged.
template <class BodyRows, class Visit>
void for_guided(const BodyRows& bodies, Visit&& visit) {
    const std::uint32_t* guided = bodies.template column<Guided>();
    for (Row b = bodies.first(); b < bodies.last(); ++b)
        if (guided[b] != 0) visit(b);
}

} // namespace bris
