#pragma once

#include "components/kinds.hpp"
#include "components/late_bodies.hpp"
#include "components/pair.hpp"
#include "engine/follower.hpp"
#include "engine/parallel.hpp"

#include <algorithm>

namespace bris::detail {

/// Lets the pass over bodies follow the contacts of spheres: a body moves while its rows are still
/// in the cache. To be used with NearIndex::lets_bodies_move.
class EarlyMotion {
public:
    EarlyMotion(const Follower& follower, const LateBodies& late,
                const NearIndex<SpherePairs>& index, std::size_t bodies)
        : follower_(follower), late_(late), first_(index.listed_first),
          bodies_(static_cast<Row>(bodies)) {}

    /// First group that belongs to no earlier chunk.
    static Row first_group(const NearChunk& chunk) {
        return (chunk.first_body + LateBodies::group - 1) / LateBodies::group;
    }
    /// Moves the bodies of a chunk from group `group` on, as far as their near rows lie before
    /// `row`, if there are enough of them. Returns the first group that has not been moved.
    Row move(const NearChunk& chunk, Row group, Row row) const {
        const auto begin = first_.begin() + 1 + chunk.first_body,
                   end = first_.begin() + 1 + chunk.last_body;
        const auto done = static_cast<Row>(std::upper_bound(begin, end, row) - first_.begin()) - 1;
        const Row last = done == bodies_ ? static_cast<Row>(late_.is_late.size())
                                         : std::max(group, done / LateBodies::group);
        constexpr Row enough = 16; // groups, since each call takes a fraction of a microsecond
        if (last < group + enough && row != chunk.last) return group;
        for (Row g = group; g < last;) {
            const Row from = g;
            while (g < last && late_.is_late[g] == 0) ++g;
            if (g > from)
                follower_.run({from * LateBodies::group, std::min(g * LateBodies::group, bodies_)});
            while (g < last && late_.is_late[g] != 0) ++g;
        }
        return last;
    }
    /// Moves the others, once all contacts are computed.
    void move_late() const {
        if (late_.runs.empty()) return;
        const auto& first = late_.first_run;
        for_chunks(first.size() - 1, 1, [&](std::size_t chunk, std::size_t, std::size_t) {
            for (std::size_t k = first[chunk]; k < first[chunk + 1]; ++k)
                follower_.run({late_.runs[k].first, late_.runs[k].last});
        });
    }

private:
    const Follower& follower_;
    const LateBodies& late_;
    const std::vector<Row>& first_;
    Row bodies_;
};

} // namespace bris::detail
