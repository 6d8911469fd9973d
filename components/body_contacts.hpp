#pragma once

#include "components/body.hpp"
#include "components/kinds.hpp"
#include "components/pair.hpp"
#include "components/sphere.hpp"

#include <algorithm>
#include <compare>
#include <cstddef>
#include <numeric>
#include <vector>

namespace bris {

/// The touching pairs of every body, or of those of marked rows only, for functions that look at a
/// World between steps: a step adds forces without such lists.
template <class Pairs>
class BodyContacts {
public:
    template <class World>
    explicit BodyContacts(const World& world, const std::vector<char>* marked = nullptr)
        : first_(world.template table<Bodies>().size() + 1, 0) {
        if (!world.template has<Pairs>()) return;
        const auto& index = world.template resource<NearIndex<Pairs>>();
        const auto near = world.template column<typename Pairs::Near, NearPair>();
        const auto rows = world.template column<Pairs, PairRows>();
        const auto names = world.template column<Pairs, PairKey>();
        const auto body = world.template column<Listed, ListedBody>();
        const auto for_bodies = [&](auto&& visit) {
            const auto visit_marked = [&](Row b, Row k, EntityId owner) {
                if (marked == nullptr || (*marked)[b] != 0) visit(b, k, owner);
            };
            index.for_touching([&](Row k) { visit_marked(body[near[k].owner], k, nobody); });
            index.for_touching([&](Row k) {
                visit_marked(rows[near[k].pair].partner_body, k, names[near[k].pair].owner);
            });
        };
        for_bodies([&](Row b, Row, EntityId) { ++first_[b]; });
        std::partial_sum(first_.begin(), first_.end(), first_.begin());
        contacts_.resize(first_.back());
        // from the last contact of each body to its first
        for_bodies([&](Row b, Row k, EntityId owner) { contacts_[--first_[b]] = {owner, k}; });
        for (std::size_t b = 0; b + 1 < first_.size(); ++b)
            std::sort(contacts_.data() + first_[b], contacts_.data() + first_[b + 1]);
    }

    /// Calls visit(near row, whether the body is the partner) for the touching pairs of a body:
    /// first the pairs in which it is the partner, by ascending id of the owner, then those that it
    /// owns, in the order of their names. The order does not depend on rows.
    template <class Visit>
    void visit(Row body, Visit&& visit) const {
        for (Row c = first_[body]; c < first_[body + 1]; ++c)
            visit(contacts_[c].near, contacts_[c].owner != nobody);
    }

private:
    struct Contact {
        EntityId owner; ///< nobody for pairs that the body owns, so that these come last
        Row near;
        friend auto operator<=>(const Contact&, const Contact&) = default;
    };
    std::vector<Row> first_; ///< bodies + 1
    std::vector<Contact> contacts_;
};

} // namespace bris
