#include "systems/output/stress.hpp"

#include "components/body.hpp"
#include "components/kinds.hpp"
#include "components/over_ranks.hpp"
#include "engine/exact_sum.hpp"
#include "systems/output/contacts.hpp"
#include "systems/output/outer_force.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace bris {

namespace {

struct StressSum {
    ExactSum axial, radial;
    void add(const Vec3& force, const Vec3& branch) {
        axial.add(force.z() * branch.z());
        radial.add(0.5 * (force.x() * branch.x() + force.y() * branch.y()));
    }
    AxisymmetricStress value() const { return {axial.value(), radial.value()}; }
};

struct StressSums {
    StressSum contact, boundary;
};

template <class Pairs>
void add_pairs(const World& world, const OverRanks& ranks, StressSums& s) {
    if (!world.has<Pairs>()) return;
    const auto position = world.column<Bodies, Position>();
    const auto motion = world.column<Bodies, MotionOf>();
    TouchingPairs<Pairs>(world).visit([&](const TouchingPair& p) {
        if (!ranks.counts(p.owner)) return;
        const Vec3 force(p.force.fx, p.force.fy, p.force.fz),
            point(p.force.px, p.force.py, p.force.pz);
        if (motion[p.partner] == static_cast<std::uint32_t>(Motion::free)) {
            s.contact.add(force, position[p.owner] - position[p.partner]);
        } else {
            s.contact.add(force, position[p.owner] - point);
            s.boundary.add(force, -point);
        }
    });
}

} // namespace

double Stresses::mismatch() const {
    const double axial = std::abs(contact.axial / boundary.axial - 1),
                 radial = std::abs(contact.radial / boundary.radial - 1);
    return std::isfinite(axial) && std::isfinite(radial) ? std::max(axial, radial)
                                                         : std::numeric_limits<double>::infinity();
}

Stresses compute_stresses(const World& world) {
    const OverRanks ranks(world);
    StressSums sums;
    for_each_kind_of_pair([&]<class Pairs>() { add_pairs<Pairs>(world, ranks, sums); });
    const OuterForces outer(world);
    const auto motion = world.column<Bodies, MotionOf>();
    for (Row r = 0; outer.any() && r < motion.size(); ++r)
        if (motion[r] == static_cast<std::uint32_t>(Motion::free) && ranks.counts(r))
            sums.boundary.add(outer(r), -world.column<Bodies, Position>()[r]);
    ranks.add(
        {&sums.contact.axial, &sums.contact.radial, &sums.boundary.axial, &sums.boundary.radial});
    return {sums.contact.value(), sums.boundary.value()};
}

} // namespace bris
