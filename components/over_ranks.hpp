#pragma once

#include "components/kinds.hpp"
#include "components/slab.hpp"
#include "engine/exact_sum.hpp"
#include "engine/ranks.hpp"

#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <vector>

namespace bris {

/// What one rank counts of a world, and the sum of what all ranks have counted. Each body and each
/// contact counts on one rank: in a world that is not divided on this one, and nothing is added
/// then. Of a divided one (Simulation::observed) all ranks must ask for the same sums.
class OverRanks {
public:
    template <class World>
    explicit OverRanks(const World& world)
        : ghosts_(world.template table<Bodies>()),
          is_divided_(world.template has_resource<Slab>()) {}

    /// Whether a body counts here with the contacts that it owns. Boundaries, which count on all
    /// ranks, are not free in a world that is observed in parts.
    bool counts(Row b) const { return !ghosts_[b]; }

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
};

} // namespace bris
