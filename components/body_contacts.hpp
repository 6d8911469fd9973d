#pragma once

#include "components/body.hpp"
#include "components/kinds.hpp"
#include "components/pair.hpp"
#include "components/sphere.hpp"

#include <algorithm>
#include <cstddef>
#include <vector>

namespace bris {

/// The touching pairs of every body, for functions that look at a World between steps: a step adds
/// forces without such lists.
template <class Pairs>
class BodyContacts {
public:
    template <class World>
    explicit BodyContacts(const World& world)
        : first_(world.template table<Bodies>().size() + 1, 0) {
        if (!world.template has<Pairs>()) return;
        const auto& index = world.template resource<NearIndex<Pairs>>();
        const auto near = world.template column<typename Pairs::Near, NearPair>();
        const auto rows = world.template column<Pairs, PairRows>();
        const auto names = world.template column<Pairs, PairKey>();
        const auto body = world.template column<Listed, ListedBody>();
        const auto for_bodies = [&](auto&& visit) {
            index.for_touching([&](Row k) { visit(rows[near[k].pair].partner_body, k, true); });
            index.for_touching([&](Row k) { visit(body[near[k].owner], k, false); });
        };
        for_bodies([&](Row b, Row, bool) { ++first_[b + 1]; });
        for (std::size_t b = 1; b < first_.size(); ++b) first_[b] += first_[b - 1];
        contacts_.resize(first_.back());
        std::vector<std::size_t> next(first_.begin(), first_.end() - 1);
        for_bodies([&](Row b, Row k, bool as_partner) {
            contacts_[next[b]++] = {k, as_partner, as_partner ? names[near[k].pair].owner : nobody};
        });
        for (std::size_t b = 0; b + 1 < first_.size(); ++b)
            std::stable_sort(contacts_.begin() + static_cast<std::ptrdiff_t>(first_[b]),
                             contacts_.begin() + static_cast<std::ptrdiff_t>(first_[b + 1]),
                             [](const Contact& x, const Contact& y) { return x.owner < y.owner; });
    }

    /// Calls visit(near row, whether the body is the partner) for the touching pairs of a body:
    /// first the pairs in which it is the partner, by ascending id of the owner, then those that it
    /// owns, in the order of their names. The order does not depend on rows.
    template <class Visit>
    void visit(Row body, Visit&& visit) const {
        for (std::size_t c = first_[body]; c < first_[body + 1]; ++c)
            visit(contacts_[c].near, contacts_[c].as_partner);
    }

private:
    struct Contact {
        Row near;
        bool as_partner;
        EntityId owner; ///< nobody for pairs that the body owns, so that these come last
    };
    std::vector<std::size_t> first_; ///< bodies + 1
    std::vector<Contact> contacts_;
};

} // namespace bris
