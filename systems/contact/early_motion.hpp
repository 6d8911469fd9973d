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
        : follower_(follower), is_late_(late.is_late), index_(index),
          bodies_(static_cast<Row>(bodies)) {}

    /// First group that belongs to no earlier chunk.
    static Row first_group(const NearChunk& chunk) {
        return (chunk.first_body + group - 1) / group;
    }
    /// Moves the bodies of a chunk from group `next` on, as far as their near rows lie before
    /// `row`, if there are enough of them. Returns the first group that has not been moved.
    Row move(const NearChunk& chunk, Row next, Row row) const {
        const auto all = index_.listed_first.begin() + 1;
        const auto done = static_cast<Row>(
            std::upper_bound(all + chunk.first_body, all + chunk.last_body, row) - all);
        const Row last = std::max(next, groups_before(done));
        constexpr Row enough = 16; // groups, since each call takes a fraction of a microsecond
        if (last < next + enough && row != chunk.last) return next;
        move_groups(next, last, false);
        return last;
    }
    /// Moves the others, once all contacts are computed.
    void move_late() const {
        for_chunks(index_.chunks.size(), 1, [&](std::size_t k, std::size_t, std::size_t) {
            const NearChunk& chunk = index_.chunks[k];
            move_groups(chunk.first_body / group, groups_before(chunk.last_body), true);
        });
    }

private:
    static constexpr Row group = LateBodies::group;

    /// Number of groups whose bodies all lie before `body`.
    Row groups_before(Row body) const {
        return body == bodies_ ? static_cast<Row>(is_late_.size()) : body / group;
    }
    /// Moves those of the groups that are late, or those that are not.
    void move_groups(Row first, Row last, bool late) const {
        const auto end_of = [&](Row g, bool found) {
            while (g < last && (is_late_[g] != 0) == found) ++g;
            return g;
        };
        for (Row begin = end_of(first, !late); begin < last;) {
            const Row end = end_of(begin, late);
            follower_.run({begin * group, std::min(end * group, bodies_)});
            begin = end_of(end, !late);
        }
    }

    const Follower& follower_;
    const std::vector<std::uint8_t>& is_late_;
    const NearIndex<SpherePairs>& index_;
    Row bodies_;
};

} // namespace bris::detail
