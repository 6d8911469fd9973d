#include "systems/output/contact_list.hpp"

#include "systems/output/contacts.hpp"

#include <algorithm>
#include <cmath>

namespace bris {

double Contact::shear_force() const {
    return std::sqrt(std::max(0.0, force.squaredNorm() - normal_force * normal_force));
}

std::vector<Contact> contacts_of(const World& world) {
    std::vector<Contact> list;
    std::size_t kind = 0; // for_each_kind_of_pair has the order of contact_kinds
    for_each_kind_of_pair([&]<class Pairs>() {
        for_touching_pairs<Pairs>(world, [&](const TouchingPair& pair) {
            const ForceRow& f = pair.force;
            list.push_back({kind,
                            pair.names.owner,
                            pair.names.partner,
                            {f.px, f.py, f.pz},
                            {f.fx, f.fy, f.fz},
                            f.normal_force,
                            f.overlap});
        });
        ++kind;
    });
    return list;
}

} // namespace bris
