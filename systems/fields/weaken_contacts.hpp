#pragma once

#include "systems/fields/fouling.hpp"

namespace bris {

/// What the contacts were weakened for last. Derived.
struct Weakening {
    static constexpr auto name = "weakening";
    std::uint64_t revision = 0, rebuilds = 0; ///< of Fouling and of the lists
    bool done = false;
};

/// Whether the fouling that contacts see has changed since they were weakened, or new candidates
/// were made. False without fouling.
bool weakening_is_due(const World& world);

/// Gives the contacts of every pair of bodies whose fouling weakens them (FoulingLaw) coefficients
/// of their own, a row behind those of the pairs of materials. Two rocks have the mean of what
/// surrounds them; at a boundary only the rock counts. Contacts without fines keep the row of their
/// materials.
void weaken_contacts(World& world, const Fouling& fouling, const FoulingLaw& law,
                     Weakening& weakening);

} // namespace bris
