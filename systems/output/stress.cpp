#include "systems/output/stress.hpp"

#include "components/body.hpp"
#include "components/kinds.hpp"
#include "engine/ordering.hpp"
#include "systems/output/contacts.hpp"
#include "systems/output/outer_force.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace bris {

namespace {

void add(AxisymmetricStress& sum, const Vec3& force, const Vec3& branch) {
    sum.axial += force.z() * branch.z();
    sum.radial += 0.5 * (force.x() * branch.x() + force.y() * branch.y());
}

template <class Pairs>
void add_pairs(const World& world, const std::vector<Row>& rows, Stresses& s) {
    const auto position = world.column<Bodies, Position>();
    const auto motion = world.column<Bodies, MotionOf>();
    for_touching_pairs<Pairs>(world, [&](const TouchingPair& p) {
        const Vec3 force(p.force.fx, p.force.fy, p.force.fz),
            point(p.force.px, p.force.py, p.force.pz);
        const Row owner = rows[p.names.owner], partner = rows[p.names.partner];
        if (motion[partner] == static_cast<std::uint32_t>(Motion::free)) {
            add(s.contact, force, position[owner] - position[partner]);
        } else {
            add(s.contact, force, position[owner] - point);
            add(s.boundary, force, -point);
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
    const auto rows = rows_by_id(world.column<Bodies, BodyId>());
    Stresses s;
    for_each_kind_of_pair([&]<class Pairs>() { add_pairs<Pairs>(world, rows, s); });
    const OuterForces outer(world);
    if (!outer.any()) return s;
    const auto motion = world.column<Bodies, MotionOf>();
    for (const Row r : rows)
        if (motion[r] == static_cast<std::uint32_t>(Motion::free))
            add(s.boundary, outer(r), -world.column<Bodies, Position>()[r]);
    return s;
}

} // namespace bris
