#include "components/over_ranks.hpp"
#include "engine/ranks.hpp"
#include "systems/slabs/slabs.hpp"

#include <algorithm>
#include <array>
#include <cstring>
#include <numeric>

namespace bris {

void share_census(const Slab&, const ListState& lists, const Clock& clock, Census& census) {
    if (lists.last_rebuild != clock.step) return;
    census.largest_radius = Ranks::largest(census.largest_radius);
    census.largest_grain_mass = Ranks::largest(census.largest_grain_mass);
    census.smallest_free_radius = -Ranks::largest(-census.smallest_free_radius);
    std::vector<std::int64_t> grains(census.grains.begin(), census.grains.end());
    Ranks::sum(grains); // the boundaries are on all ranks
    std::ranges::transform(grains, census.grains.begin(),
                           [](std::int64_t n) { return static_cast<std::uint32_t>(n); });
}

void forget_sums_of_ghosts(Rows<Bodies, const Ghost> bodies, Rows<ForceSums, ContactSum> sums,
                           const Alarm& alarm) {
    if (!alarm.raised) return;
    for (Row b = 0; b < bodies.size(); ++b)
        if (bodies.column<Ghost>()[b] != 0) sums.column<ContactSum>()[b] = {};
}

void share_boundary_forces(Rows<Bodies, const MotionOf, const AngularVelocity, const BodyId> bodies,
                           const Census& census, const Slab&, BoundarySums& sums) {
    const auto* motion = bodies.column<MotionOf>();
    const auto* spin = bodies.column<AngularVelocity>(); // of a drum, whose centre is fixed
    if (std::ranges::all_of(census.boundaries, [&](Row b) {
            return motion[b] == static_cast<std::uint32_t>(Motion::fixed) && spin[b].isZero(0);
        }))
        return; // nobody reads them within a step
    // by id, since each rank sorts its rows as it likes
    std::vector<std::size_t> order(sums.of.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::ranges::sort(order, {},
                      [&](std::size_t k) { return bodies.column<BodyId>()[census.boundaries[k]]; });
    std::vector<WideInteger> total;
    for (const std::size_t k : order)
        total.insert(total.end(), sums.of[k].begin(), sums.of[k].end());
    add_over_ranks(total);
    const WideInteger* next = total.data();
    for (const std::size_t k : order) {
        std::copy_n(next, sums.of[k].size(), sums.of[k].begin());
        next += sums.of[k].size();
    }
}

void share_platen_contacts(const Slab&, Platen& platen) {
    if (platen.controlled) Ranks::sum({&platen.contacts, 1});
}

void share_motion(Rows<Bodies, const RecorderOf, const SpheresOf, const Ghost> bodies,
                  const Slab& slab, NotedMotions& motions) {
    // one rank gives the bits of a motion and the others give zeros, so that their sum is exact
    using Bits = std::array<std::int64_t, sizeof(TrueMotion) / sizeof(std::int64_t)>;
    static_assert(sizeof(Bits) == sizeof(TrueMotion));
    std::vector<Bits> sum(motions.of.size(), Bits{});
    for (Row b = bodies.first(); b < bodies.last(); ++b) {
        const std::uint32_t number = bodies.column<RecorderOf>()[b];
        const bool everywhere = bodies.column<SpheresOf>()[b].count == 0;
        if (number == 0 || bodies.column<Ghost>()[b] != 0 || (everywhere && slab.rank != 0))
            continue;
        std::memcpy(&sum[number - 1], &motions.of[number - 1], sizeof(Bits));
    }
    Ranks::sum({sum.front().data(), sum.size() * sum.front().size()});
    for (std::size_t k = 0; k < sum.size(); ++k)
        std::memcpy(static_cast<void*>(&motions.of[k]), &sum[k], sizeof(Bits));
}

namespace {

template <std::size_t Count>
void add_rows_over_ranks(std::vector<std::array<WideInteger, Count>>& rows) {
    std::vector<WideInteger> total;
    for (const auto& row : rows) total.insert(total.end(), row.begin(), row.end());
    add_over_ranks(total);
    const WideInteger* next = total.data();
    for (auto& row : rows) {
        std::copy_n(next, Count, row.begin());
        next += Count;
    }
}

} // namespace

void share_membrane_forces(const Slab&, MembraneSums& sums) { add_rows_over_ranks(sums.of); }
void share_sleeve_forces(const Slab&, SleeveSums& sums) { add_rows_over_ranks(sums.of); }

} // namespace bris
