#pragma once

#include "components/body.hpp"
#include "components/kinds.hpp"
#include "components/pair.hpp"
#include "components/sphere.hpp"
#include "engine/parallel.hpp"
#include "engine/rows.hpp"

#include <algorithm>

namespace bris {

namespace detail {

/// Lists the touching near rows of one body: as partner first, then as owner.
template <class Pairs>
void list_contacts_of(Row body, NearIndex<Pairs>& index) {
    // advanced without a branch on whether a pair touches, which would be mispredicted
    Row at = index.first_contact(body);
    for (Row k = index.incident_first[body]; k < index.incident_first[body + 1]; ++k) {
        index.contact[at] = index.incident[k] | index.as_partner;
        at += index.touches(index.incident[k]) ? 1u : 0u;
    }
    for (Row k = index.owned_first[body]; k < index.owned_first[body + 1]; ++k) {
        index.contact[at] = k;
        at += index.touches(k) ? 1u : 0u;
    }
    index.contact_end[body] = at;
}

} // namespace detail

/// Updates the lists of touching pairs of every body. Most near rows do not touch, so the force
/// sums should not read them in every step; and contacts begin and end rarely, so only the lists of
/// the bodies concerned are rebuilt, unless many have changed.
template <class Pairs>
void list_contacts(Rows<typename Pairs::Near, const NearPair> near,
                   Rows<Pairs, const PairRows> pairs, Rows<Listed, const ListedBody> listed,
                   NearIndex<Pairs>& index) {
    const NearEntry* entry = near.template column<NearPair>();
    const std::size_t groups = index.touching.size();
    std::size_t changed = 0;
    for (std::size_t g = 0; g < groups; ++g)
        changed += index.touching[g] != index.listed[g] ? 1u : 0u;
    if (changed == 0) return;
    if (changed > groups / 32 + 1) {
        for_chunks(index.contact_end.size(), 256,
                   [&](std::size_t, std::size_t first, std::size_t last) {
                       for (auto b = static_cast<Row>(first); b < last; ++b)
                           detail::list_contacts_of(b, index);
                   });
    } else {
        for (std::size_t g = 0; g < groups; ++g)
            for (unsigned remaining = index.touching[g] ^ index.listed[g]; remaining != 0;
                 remaining &= remaining - 1) {
                const NearEntry& e =
                    entry[g * index.group + static_cast<unsigned>(__builtin_ctz(remaining))];
                detail::list_contacts_of(listed.template column<ListedBody>()[e.owner], index);
                detail::list_contacts_of(pairs.template column<PairRows>()[e.pair].partner_body,
                                         index);
            }
    }
    index.listed = index.touching;
}

} // namespace bris
