#pragma once

#include "components/body.hpp"
#include "components/census.hpp"
#include "components/force_sums.hpp"
#include "components/kinds.hpp"
#include "engine/health.hpp"
#include "engine/lane_math.hpp"
#include "engine/prefetch.hpp"
#include "engine/quad_math.hpp"
#include "engine/rows.hpp"

#include <algorithm>
#include <cstring>

namespace bris::detail {

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

/// Sums beyond 2^63 wrap; ForceGrid::holds tells.
inline void add(SumRow& sum, const SumRow& more) {
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
    sum.size = wrapped(sum.size, more.size);
}

/// Three sums in N or N m.
inline Quad converted(double unit, const std::int64_t* sums) {
    using Integers [[gnu::vector_size(sizeof(Quad))]] = std::int64_t;
    Integers integers;
    std::memcpy(&integers, sums, sizeof integers);
    return unit * __builtin_convertvector(integers, Quad);
}

/// Force (N) and torque about the centre of mass (N m).
struct NetForce {
    Quad force, torque;
};
struct NetForceLanes {
    Vec3Lanes force, torque;
    LaneMask held; ///< lanes whose sums have not wrapped; the forces of the others are zero
};
/// The same from columns of integers, and zero where `held` is not set.
inline Vec3Lanes converted(double unit, const FourLanes& sums, const LaneMask& held) {
    const Lane factor = held ? lanes(unit) : Lane{};
    const auto number = [&](std::size_t k) {
        return __builtin_convertvector(reinterpret_cast<LaneMask>(sums[k]), Lane);
    };
    return factor * Vec3Lanes{number(0), number(1), number(2)};
}

/// Converts the sums of contact forces of one body after another from integers.
class BodySums {
public:
    BodySums(const Rows<Bodies, const SumsFromOthers, const SpheresOf>& bodies, const SumRows& sums,
             const ForceGrid& grid, const Census& census, const BoundarySums& boundaries)
        : list_(bodies.column<SumsFromOthers>()), spheres_(bodies.column<SpheresOf>()),
          sum_(sums.column<ContactSum>()), sums_(sums), grid_(grid), census_(census),
          boundaries_(boundaries) {}

    /// Prefetches the lists of bodies [first, last), which other threads have written.
    void prefetch_lists(Row first, Row last) const {
        for (Row b = first; b < last; ++b)
            if (list_[b] != no_row) {
                prefetch<true>(&sum_[list_[b]]);
                prefetch(&sums_.column<NextSum>()[list_[b]]);
            }
    }
    /// Sums by row of the body.
    const SumRow* rows() const { return sum_; }

    /// Converts the sums of body `b`, and clears them for the next step. Returns zero, and leaves
    /// the sums for the guard, if they may have wrapped.
    NetForce take(Row b, Alarm& alarm) const {
        if (spheres_[b].count == 0) return of_boundary(b);
        add_list(b);
        SumRow& sum = sum_[b];
        if (!ForceGrid::holds(sum)) {
            alarm.raise();
            return {Quad{}, Quad{}};
        }
        const NetForce net{converted(grid_.force, &sum.fx), converted(grid_.torque, &sum.tx)};
        sum = {};
        return net;
    }

    /// The same of lane_count bodies with spheres, from row `first` on; raises no alarm.
    NetForceLanes take_grains(Row first) const {
        for (Row b = first; b < first + lane_count; ++b) add_list(b);
        const auto rows_of = [&](const std::int64_t SumRow::*member) {
            return transpose(load_rows([&](int q) {
                return reinterpret_cast<const double*>(
                    &(sum_[first + static_cast<Row>(q)].*member));
            }));
        };
        const FourLanes torques = rows_of(&SumRow::tx);
        const LaneMask held = (reinterpret_cast<LaneMask>(torques[3]) & SumRow::size_bits) <=
                              ForceGrid::largest_sum_of_sizes;
        const NetForceLanes net{converted(grid_.force, rows_of(&SumRow::fx), held),
                                converted(grid_.torque, torques, held), held};
        const unsigned cleared = bits(held);
        if (cleared == all_lanes)
            std::fill_n(sum_ + first, lane_count, SumRow{});
        else
            for (Row q = 0; q < lane_count; ++q)
                if ((cleared >> q) & 1) sum_[first + q] = {};
        return net;
    }

private:
    void add_list(Row b) const {
        if (list_[b] != no_row)
            take_list(list_[b], sums_, [&](const SumRow& r) { add(sum_[b], r); });
    }
    NetForce of_boundary(Row b) const {
        const auto at_row = std::ranges::lower_bound(census_.boundaries, b);
        const auto& sum =
            boundaries_.of[static_cast<std::size_t>(at_row - census_.boundaries.begin())];
        const auto scaled = [&](double unit, std::size_t first) {
            const auto part = [&](std::size_t k) {
                return unit * static_cast<double>(sum[first + k]);
            };
            return Quad{part(0), part(1), part(2), 0};
        };
        return {scaled(grid_.force, 0), scaled(grid_.host_torque, 3)};
    }

    const Row* list_;
    const SphereRun* spheres_;
    SumRow* sum_;
    SumRows sums_;
    const ForceGrid& grid_;
    const Census& census_;
    const BoundarySums& boundaries_;
};

} // namespace bris::detail
