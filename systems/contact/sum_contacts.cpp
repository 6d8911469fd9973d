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

/// Force (N) of the dashpot of the fastest pair that `overlap` (m) can stop. The pair has the speed
/// overlap * sqrt(stiffness / mass) if the spring stops it and overlap * damping / mass if the
/// dashpot does, and no body is faster than the guard's limit. `mass`: kg, largest reduced mass, on
/// which the force depends only for damping rates.
double largest_dashpot(const LawRow& row, double stiffness, double overlap, double mass,
                       double limit_of_speed) {
    if (!(mass > 0 && std::isfinite(mass))) return 0;
    const double critical = std::sqrt(stiffness * mass),
                 damping = std::max(row.normal_rate, row.shear_rate) * mass +
                           std::max(row.normal_ratio, row.shear_ratio) * critical,
                 speed = std::max(critical, damping) * overlap / mass;
    return damping * std::min(speed, 2 * limit_of_speed);
}

} // namespace

void choose_force_grid(const Materials& materials, const ContactLaw& law, const Limits& limits,
                       const Census& bodies, ForceGrid& grid) {
    constexpr double longer_arms = 0x1p12; // of boundaries, relative to the radii of grains
    constexpr double deepest = 0.5; // where overlaps are not limited: twice as deep is allowed
    // The size of a contact adds magnitudes of force and torques and is up to five times the force,
    // so that dashpots of eight times the force of the spring are within ForceGrid::largest.
    constexpr double room_for_dashpots = 8;
    // A body may touch some 4 ratio^2 smaller ones, each with an overlap in proportion to its own
    // radius: sums grow with the ratio of the radii.
    constexpr double room_for_ratio = 32;
    const LawTraits& of = traits(law.law);
    const double radius = bodies.largest_radius,
                 overlap = std::min(limits.overlap, deepest) * radius;
    double force = 0, dashpot = 0;
    for (std::uint32_t a = 0; a < bodies.grains.size(); ++a)
        for (std::uint32_t b = 0; b < bodies.grains.size(); ++b)
            if (may_touch(bodies, a, b)) {
                const LawRow& row = of.rows(materials)[materials.pair(a, b)];
                const double stiffness =
                    elasticity_of(of, materials, materials.pair(a, b), overlap, radius, 0).normal;
                force = std::max(force, stiffness * overlap);
                if (of.dashpots)
                    dashpot =
                        std::max(dashpot, largest_dashpot(row, stiffness, overlap,
                                                          bodies.largest_grain_mass, limits.speed));
            }
    grid.at_limit = force;
    grid.dashpot = dashpot;
    const double largest = std::max(force, dashpot / room_for_dashpots) *
                           std::max(1.0, radius / bodies.smallest_free_radius / room_for_ratio);
    grid.force = power_of_two(largest > 0 && std::isfinite(largest) ? largest : 1) /
                 ForceGrid::units_at_limit;
    grid.torque = grid.force * power_of_two(radius > 0 ? radius : 1);
    grid.host_torque = grid.torque * longer_arms;
}

void sum_boundaries(Rows<Bodies, const BodyId, const SumsFromOthers> bodies,
                    Rows<ForceSums, const NextSum, ContactSum> sums, const ForceGrid& grid,
                    const Census& census, BoundarySums& boundaries, Overload& overload) {
    const Row* list = bodies.column<SumsFromOthers>();
    const EntityId* id = bodies.column<BodyId>();
    boundaries.of.assign(census.boundaries.size(), {});
    for (std::size_t k = 0; k < boundaries.of.size(); ++k)
        detail::take_list(list[census.boundaries[k]], sums, [&](const SumRow& r) {
            if (!ForceGrid::holds(r)) {
                overload.note(id[census.boundaries[k]], grid.size_of(r), true);
                return;
            }
            const std::array<std::int64_t, 6> more{r.fx, r.fy, r.fz, r.tx, r.ty, r.tz};
            for (std::size_t i = 0; i < more.size(); ++i) boundaries.of[k][i] += more[i];
        });
}

void sum_contacts(Rows<Bodies, const SumsFromOthers, const SpheresOf, Force, Torque> bodies,
                  Rows<ForceSums, const NextSum, ContactSum> sums, const ForceGrid& grid,
                  const Census& census, const BoundarySums& boundaries, Alarm& alarm) {
    const detail::BodySums body_sums(bodies, sums, grid, census, boundaries);
    Vec3 *force = bodies.column<Force>(), *torque = bodies.column<Torque>();
    body_sums.prefetch_lists(bodies.first(), bodies.last());
    for (Row b = bodies.first(); b < bodies.last(); ++b) {
        const detail::NetForce net = body_sums.take(b, alarm);
        store(force[b], net.force);
        store(torque[b], net.torque);
    }
}

void guard_sums(Rows<Bodies, const BodyId> bodies, Rows<ForceSums, ContactSum> sums,
                const ForceGrid& grid, const Alarm& alarm, Overload& overload) {
    if (!alarm.raised) return;
    SumRow* sum = sums.column<ContactSum>();
    for (Row b = 0; b < bodies.size(); ++b)
        if (!ForceGrid::holds(sum[b])) {
            overload.note(bodies.column<BodyId>()[b], grid.size_of(sum[b]), false);
            sum[b] = {};
        }
}

} // namespace bris
