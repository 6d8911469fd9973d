#include "systems/contact/sum_contacts.hpp"

#include "components/elasticity.hpp"
#include "engine/quad_math.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>

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

/// Sums beyond 2^63, of forces that will stop the run, wrap.
void add(SumRow& sum, const SumRow& more) {
    const auto wrapped = [](std::int64_t a, std::int64_t b) {
        return static_cast<std::int64_t>(static_cast<std::uint64_t>(a) +
                                         static_cast<std::uint64_t>(b));
    };
    sum.fx = wrapped(sum.fx, more.fx);
    sum.fy = wrapped(sum.fy, more.fy);
    sum.fz = wrapped(sum.fz, more.fz);
    sum.tx = wrapped(sum.tx, more.tx);
    sum.ty = wrapped(sum.ty, more.ty);
    sum.tz = wrapped(sum.tz, more.tz);
}

using SumRows = Rows<ForceSums, const NextSum, ContactSum>;

/// Calls take(row) for the rows of a body's list, and clears them.
template <class Take>
void take_list(Row first, const SumRows& sums, Take&& take) {
    SumRow* row = sums.column<ContactSum>();
    const Row* next = sums.column<NextSum>();
    for (Row k = first; k != no_row; k = next[k]) {
        take(row[k]);
        row[k] = {};
    }
}

/// Force and torque on a boundary.
void place(const std::array<WideInteger, 6>& sum, const ForceGrid& grid, Vec3& force,
           Vec3& torque) {
    for (int i = 0; i < 3; ++i) {
        const auto k = static_cast<std::size_t>(i);
        force[i] = grid.force * static_cast<double>(sum[k]);
        torque[i] = grid.host_torque * static_cast<double>(sum[k + 3]);
    }
}

/// Three sums in N or N m; NaN where a sum is beyond the grid.
Quad scaled_or_nan(double unit, const std::int64_t* sums) {
    using Integers [[gnu::vector_size(sizeof(Quad))]] = std::int64_t;
    Integers integers;
    std::memcpy(&integers, sums, sizeof integers);
    const Quad sum = __builtin_convertvector(integers, Quad);
    const bool fits =
        std::abs(sum[0]) + std::abs(sum[1]) + std::abs(sum[2]) <= ForceGrid::largest_sum;
    return (fits ? unit : std::numeric_limits<double>::quiet_NaN()) * sum;
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
        take_list(list[census.boundaries[k]], sums, [&](const SumRow& r) {
            const std::array<std::int64_t, 6> more{r.fx, r.fy, r.fz, r.tx, r.ty, r.tz};
            for (std::size_t i = 0; i < more.size(); ++i) boundaries.of[k][i] += more[i];
        });
}

void sum_contacts(Rows<Bodies, const SumsFromOthers, const SpheresOf, Force, Torque> bodies,
                  Rows<ForceSums, const NextSum, ContactSum> sums, const ForceGrid& grid,
                  const Census& census, const BoundarySums& boundaries) {
    const Row* list = bodies.column<SumsFromOthers>();
    const SphereRun* spheres = bodies.column<SpheresOf>();
    SumRow* sum = sums.column<ContactSum>();
    Vec3 *force = bodies.column<Force>(), *torque = bodies.column<Torque>();
    for (Row b = bodies.first(); b < bodies.last(); ++b) {
        if (spheres[b].count == 0) {
            sum[b] = {};
            const auto at_row = std::ranges::lower_bound(census.boundaries, b);
            place(boundaries.of[static_cast<std::size_t>(at_row - census.boundaries.begin())], grid,
                  force[b], torque[b]);
            continue;
        }
        if (list[b] != no_row) take_list(list[b], sums, [&](const SumRow& r) { add(sum[b], r); });
        store(force[b], scaled_or_nan(grid.force, &sum[b].fx));
        store(torque[b], scaled_or_nan(grid.torque, &sum[b].tx));
        sum[b] = {};
    }
}

} // namespace bris
