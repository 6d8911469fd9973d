#include "systems/output/quantities.hpp"

#include "components/body.hpp"
#include "components/laws/edges.hpp"
#include "components/material.hpp"
#include "components/settings.hpp"
#include "components/sphere.hpp"
#include "engine/exact_sum.hpp"
#include "engine/ordering.hpp"
#include "systems/loads/table.hpp"
#include "systems/output/balance.hpp"
#include "systems/output/contacts.hpp"

namespace bris {

namespace {

bool is_free(const World& world, Row b) {
    return world.column<Bodies, MotionOf>()[b] == static_cast<std::uint32_t>(Motion::free);
}

double kinetic_energy(const World& world, Row b) {
    const Table& bodies = world.table<Bodies>();
    const double dt = world.resource<Clock>().dt;
    const Vec3 v = bodies.column<Velocity>()[b] + 0.5 * dt * bodies.column<Acceleration>()[b];
    const Vec3& w = bodies.column<AngularVelocity>()[b];
    double turning = 0;
    if (bodies.has<SphereInertia>()) {
        turning = bodies.column<SphereInertia>()[b] * w.squaredNorm();
    } else {
        const Vec3 local = bodies.column<Orientation>()[b].conjugate() * w;
        turning = local.cwiseAbs2().dot(bodies.column<InertialInertia>()[b]);
    }
    return 0.5 * (bodies.column<InertialMass>()[b] * v.squaredNorm() + turning);
}

struct Sums {
    ExactSum kinetic, elastic, overlap, normal_force;
    ExactVector boundary_force, weight;
};

template <class Pairs>
void add_contacts(const World& world, const RowIndex& rows, Quantities& q, Sums& sums) {
    const auto& materials = world.resource<Materials>();
    const LawTraits& law = traits(world.resource<ContactLaw>().law);
    PairNames last{nobody, nobody, 0, 0};
    for_touching_pairs<Pairs>(world, [&](const TouchingPair& p) {
        if (!is_free(world, rows[p.names.partner]))
            sums.boundary_force.add(-Vec3(p.force.fx, p.force.fy, p.force.fz));
        if (law.reaches)
            sums.elastic.add(law.potential(materials.own_pairs[p.law], p.force.overlap, p.radius));
        if (p.force.overlap < 0) return; // held beyond touch
        ++q.contacts;
        sums.overlap.add(p.force.overlap);
        q.largest_overlap = std::max(q.largest_overlap, p.force.overlap);
        sums.normal_force.add(p.force.normal_force);
        const Elasticity e =
            elasticity_of(law, materials, p.law, p.force.overlap, p.radius, p.worn);
        const double shear2 =
            p.spring.x * p.spring.x + p.spring.y * p.spring.y + p.spring.z * p.spring.z;
        const double roll2 = p.roll.x * p.roll.x + p.roll.y * p.roll.y + p.roll.z * p.roll.z +
                             p.roll.twist * p.roll.twist;
        sums.elastic.add(
            p.share * (e.energy + 0.5 * e.shear *
                                      (shear2 + materials.policy.rolling_stiffness_ratio * roll2)));
        if (p.names.owner != last.owner || p.names.partner != last.partner) ++q.body_contacts;
        last = p.names;
    });
}

} // namespace

Quantities compute_quantities(const World& world) {
    Quantities q;
    Sums sums;
    const RowIndex rows(world.column<Bodies, BodyId>());
    std::size_t free_bodies = 0;
    const Vec3 gravity =
        world.has_resource<Gravity>() ? world.resource<Gravity>().value : Vec3(Vec3::Zero());
    for (Row b = 0; b < world.table<Bodies>().size(); ++b) {
        if (!is_free(world, b)) continue;
        ++free_bodies;
        sums.kinetic.add(kinetic_energy(world, b));
        sums.weight.add(world.column<Bodies, Mass>()[b] * gravity);
    }
    std::size_t between_grains = 0;
    for_each_kind_of_pair([&]<class Pairs>() {
        add_contacts<Pairs>(world, rows, q, sums);
        if constexpr (std::is_same_v<Pairs, SpherePairs>) between_grains = q.body_contacts;
    });
    q.kinetic_energy = sums.kinetic.value();
    q.boundary_force = sums.boundary_force.value();
    q.weight = sums.weight.value();
    if (q.contacts > 0) {
        q.mean_overlap = sums.overlap.value() / static_cast<double>(q.contacts);
        q.mean_normal_force = sums.normal_force.value() / static_cast<double>(q.contacts);
    }
    if (free_bodies > 0)
        q.coordination = static_cast<double>(q.body_contacts + between_grains) /
                         static_cast<double>(free_bodies);
    q.element_energy = energy_of_elements(world);
    q.elastic_energy = sums.elastic.value() + q.element_energy;
    q.unbalanced_ratio = compute_balance(world).unbalanced_ratio;
    return q;
}

double potential_energy(const World& world) {
    if (!world.has_resource<Gravity>()) return 0;
    const auto mass = world.column<Bodies, Mass>();
    const auto position = world.column<Bodies, Position>();
    ExactSum energy;
    for (Row b = 0; b < mass.size(); ++b)
        energy.add(-mass[b] * world.resource<Gravity>().value.dot(position[b]));
    return energy.value();
}

double share_at_yield(const World& world) {
    if (!has_wear(world.resource<ContactLaw>().law)) return 0;
    const auto& edges = world.resource<Materials>().edge_pairs;
    double contacts = 0, at_yield = 0;
    for_touching_pairs<SpherePairs>(world, [&](const TouchingPair& p) {
        const EdgeRow& e = edges[p.law];
        const Blunted<double> edge = blunt(e, p.force.overlap, p.radius, p.worn);
        constexpr double rounding = 1e-9;
        ++contacts;
        if (edge.overlap >= (1 - rounding) * e.yield_ratio * e.yield_ratio * edge.radius)
            ++at_yield;
    });
    return contacts > 0 ? at_yield / contacts : 0;
}

double mean_radius(const World& world) {
    const Table& bodies = world.table<Bodies>();
    const RowIndex rows(bodies.column<BodyId>());
    std::vector<char> carries(bodies.size(), 0);
    for (const EntityId parent : world.column<Spheres, ParentId>()) carries[rows[parent]] = 1;
    ExactSum sum;
    double count = 0;
    for (Row b = 0; b < bodies.size(); ++b) {
        if (!is_free(world, b) || carries[b] == 0) continue;
        sum.add(bodies.column<BoundingRadius>()[b]);
        ++count;
    }
    return sum.value() / count;
}

void add_quantities(Summary& summary, const Quantities& q) {
    summary.add("contacts", q.contacts);
    summary.add("coordination", q.coordination);
    summary.add("kinetic_energy_J", q.kinetic_energy);
    summary.add("elastic_energy_J", q.elastic_energy);
    summary.add("mean_overlap_m", q.mean_overlap);
    summary.add("largest_overlap_m", q.largest_overlap);
    summary.add("mean_normal_force_N", q.mean_normal_force);
    summary.add("unbalanced_ratio", q.unbalanced_ratio);
}

} // namespace bris
