#pragma once

#include "components/body.hpp"
#include "components/force_sums.hpp"
#include "components/kinds.hpp"
#include "components/slab.hpp"
#include "engine/exact_sum.hpp"
#include "engine/ranks.hpp"

#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <span>
#include <vector>

namespace bris {

/// Makes each of these the sum of what all ranks have in its place.
inline void add_over_ranks(std::span<WideInteger> values) {
    // three numbers for each of 128 bits, whose sums over ranks cannot overflow
    constexpr WideInteger base = WideInteger{1} << 32;
    std::vector<std::int64_t> limbs;
    for (WideInteger value : values)
        for (int k = 0; k < 3; ++k) {
            const auto low = static_cast<std::int64_t>(value & (base - 1));
            limbs.push_back(k < 2 ? low : static_cast<std::int64_t>(value));
            value = (value - low) / base;
        }
    Ranks::sum(limbs);
    const std::int64_t* next = limbs.data();
    for (WideInteger& value : values) {
        value = next[0] + base * (next[1] + base * WideInteger{next[2]});
        next += 3;
    }
}

/// What one rank counts of a world, and the sum of what all ranks have counted. Each body and each
/// contact counts on one rank: in a world that is not divided on this one, and nothing is added
/// then. Of a divided one (Simulation::observed) all ranks must ask for the same sums.
class OverRanks {
public:
    template <class World>
    explicit OverRanks(const World& world)
        : ghosts_(world.template table<Bodies>()),
          is_divided_(world.template has_resource<Slab>()) {
        if (is_divided_ && !Ranks::is_first())
            spheres_ = world.template column<Bodies, SpheresOf>().data();
    }

    /// Whether a body counts here with the contacts that it owns. Bodies without spheres, which all
    /// ranks have, count on the first one.
    bool counts(Row b) const {
        return !ghosts_[b] && (spheres_ == nullptr || spheres_[b].count > 0);
    }

    void add(std::initializer_list<ExactSum*> sums) const {
        if (is_divided_) ExactSum::add_over_ranks({sums.begin(), sums.size()});
    }
    void add(std::initializer_list<std::size_t*> counts) const {
        if (!is_divided_) return;
        std::vector<std::int64_t> all;
        for (const std::size_t* count : counts) all.push_back(static_cast<std::int64_t>(*count));
        Ranks::sum(all);
        const std::int64_t* next = all.data();
        for (std::size_t* count : counts) *count = static_cast<std::size_t>(*next++);
    }
    double largest(double here) const { return is_divided_ ? Ranks::largest(here) : here; }
    double smallest(double here) const { return -largest(-here); }
    bool is_divided() const { return is_divided_; }

private:
    Ghosts ghosts_;
    bool is_divided_;
    const SphereRun* spheres_ = nullptr; ///< by row; null: all bodies count
};

} // namespace bris
