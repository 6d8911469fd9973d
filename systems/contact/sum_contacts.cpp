#include "systems/contact/sum_contacts.hpp"

#include "components/elasticity.hpp"
#include "systems/contact/body_sums.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace bris {

namespace {

/// The power of two at or above a positive number.
double power_of_two(double least) {
    int exponent = 0;
    const double fraction = std::frexp(least, &exponent); // in [0.5, 1)
    return std::ldexp(1, fraction == 0.5 ? exponent - 1 : exponent);
}

/// Whether two bodies of these materials may touch, at least one of them a grain.
bool may_touch(const Census& bodies, std::uint32_t a, std::uint32_t b) {
    if (a == b) return bodies.grains[a] > 0 && bodies.grains[a] + bodies.hosts[a] > 1;
    return (bodies.grains[a] > 0 && bodies.grains[b] + bodies.hosts[b] > 0) ||
           (bodies.grains[b] > 0 && bodies.hosts[a] > 0);
}

} // namespace

void choose_force_grid(const Materials& materials, const ContactLaw& law, const Limits& limits,
                       const Census& bodies, ForceGrid& grid) {
    constexpr double units_at_limit = ForceGrid::largest / 16;
    constexpr double longer_arms = 0x1p12; // of boundaries, relative to the radii of grains
    constexpr double deepest = 0.5; // where overlaps are not limited: four times as deep is allowed
    const LawTraits& of = traits(law.law);
    const double radius = bodies.largest_radius,
                 overlap = std::min(limits.overlap, deepest) * radius;
    double force = 0;
    for (std::uint32_t a = 0; a < bodies.grains.size(); ++a)
        for (std::uint32_t b = 0; b < bodies.grains.size(); ++b)
            if (may_touch(bodies, a, b)) {
                const LawRow& row = of.rows(materials)[materials.pair(a, b)];
                force = std::max(force, of.elasticity(row, overlap, radius).normal * overlap);
            }
    grid.force = power_of_two(force > 0 ? force : 1) / units_at_limit;
    grid.torque = grid.force * power_of_two(radius > 0 ? radius : 1);
    grid.host_torque = grid.torque * longer_arms;
}

void sum_boundaries(Rows<Bodies, const SumsFromOthers> bodies,
                    Rows<ForceSums, const NextSum, ContactSum> sums, const Census& census,
                    BoundarySums& boundaries) {
    const Row* list = bodies.column<SumsFromOthers>();
    boundaries.of.assign(census.boundaries.size(), {});
    for (std::size_t k = 0; k < boundaries.of.size(); ++k)
        detail::take_list(list[census.boundaries[k]], sums, [&](const SumRow& r) {
            const std::array<std::int64_t, 6> more{r.fx, r.fy, r.fz, r.tx, r.ty, r.tz};
            for (std::size_t i = 0; i < more.size(); ++i) boundaries.of[k][i] += more[i];
        });
}

void sum_contacts(Rows<Bodies, const SumsFromOthers, const SpheresOf, Force, Torque> bodies,
                  Rows<ForceSums, const NextSum, ContactSum> sums, const ForceGrid& grid,
                  const Census& census, const BoundarySums& boundaries) {
    const detail::BodySums body_sums(bodies, sums, grid, census, boundaries);
    Vec3 *force = bodies.column<Force>(), *torque = bodies.column<Torque>();
    for (Row b = bodies.first(); b < bodies.last(); ++b) {
        const detail::NetForce net = body_sums.take(b);
        store(force[b], net.force);
        store(torque[b], net.torque);
    }
}

} // namespace bris
