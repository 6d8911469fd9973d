#include "systems/output/stress.hpp"

#include "components/body.hpp"
#include "components/kinds.hpp"
#include "engine/exact_sum.hpp"
#include "engine/ordering.hpp"
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
void add_pairs(const World& world, const RowIndex& rows, StressSums& s) {
    const auto position = world.column<Bodies, Position>();
    const auto motion = world.column<Bodies, MotionOf>();
    for_touching_pairs<Pairs>(world, [&](const TouchingPair& p) {
        const Vec3 force(p.force.fx, p.force.fy, p.force.fz),
            point(p.force.px, p.force.py, p.force.pz);
        const Row owner = rows[p.names.owner], partner = rows[p.names.partner];
        if (motion[partner] == static_cast<std::uint32_t>(Motion::free)) {
            s.contact.add(force, position[owner] - position[partner]);
        } else {
            s.contact.add(force, position[owner] - point);
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
    const RowIndex rows(world.column<Bodies, BodyId>());
    StressSums sums;
    for_each_kind_of_pair([&]<class Pairs>() { add_pairs<Pairs>(world, rows, sums); });
    const OuterForces outer(world);
    const auto motion = world.column<Bodies, MotionOf>();
    for (Row r = 0; outer.any() && r < motion.size(); ++r)
        if (motion[r] == static_cast<std::uint32_t>(Motion::free))
            sums.boundary.add(outer(r), -world.column<Bodies, Position>()[r]);
    return {sums.contact.value(), sums.boundary.value()};
}

} // namespace bris
