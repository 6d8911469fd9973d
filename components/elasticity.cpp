#include "components/elasticity.hpp"

#include "components/laws/edges.hpp"

#include <algorithm>

namespace bris {

Elasticity elasticity_of(const LawTraits& law, const Materials& materials, Row row, double overlap,
                         double radius, double worn) {
    const LawRow& coefficients = law.rows(materials)[row];
    const double touching = std::max(overlap, 0.0);
    if (!law.wears || worn == Worn::never) return law.elasticity(coefficients, touching, radius);
    const Blunted<double> edge = blunt(materials.edge_pairs[row], touching, radius, worn);
    return law.elasticity(coefficients, std::max(edge.overlap, 0.0), edge.radius);
}

} // namespace bris
