#pragma once

#include "components/body.hpp"
#include "components/kinds.hpp"
#include "components/pair.hpp"
#include "engine/rows.hpp"
#include "engine/world.hpp"

namespace bris {

/// Adds the columns of the energy ledger to a scene that has its lists (add_lists).
void add_ledger(World& world);

/// Adds the work that friction took in this step to the owners of the pairs, in their order.
template <class Pairs>
void book_friction(Rows<Bodies, FrictionWork> bodies, Rows<typename Pairs::Near, const SlipWork> near,
                   const NearIndex<Pairs>& index) {
    if (index.size() == 0) return;
    double* work = bodies.template column<FrictionWork>();
    const double* slip = near.template column<SlipWork>();
    for (Row b = bodies.first(); b < bodies.last(); ++b) {
        double sum = work[b]; // a local: the columns might overlap for all the compiler knows
        for (Row k = index.owned_first[b], last = index.owned_first[b + 1]; k < last; ++k) sum += slip[k];
        work[b] = sum;
    }
}

} // namespace bris
