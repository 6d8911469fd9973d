#include "systems/output/quantities.hpp"

#include "components/body.hpp"
#include "components/laws/edges.hpp"
#include "components/material.hpp"
#include "components/over_ranks.hpp"
#include "components/settings.hpp"
#include "components/sphere.hpp"
#include "engine/exact_sum.hpp"
#include "engine/ordering.hpp"
#include "systems/loads/table.hpp"
#include "systems/output/balance.hpp"
#include "systems/output/contacts.hpp"

#include <algorithm>
#include <span>
#include <utility>
#include <vector>

namespace bris {

namespace {

/// Which bodies are free.
class Free {
public:
    explicit Free(const World& world) : motion_(world.column<Bodies, MotionOf>()) {}
    bool operator[](Row b) const { return motion_[b] == static_cast<std::uint32_t>(Motion::free); }

private:
    std::span<const std::uint32_t> motion_;
};

/// Kinetic energy (J) of the body of a row.
class KineticEnergy {
public:
    explicit KineticEnergy(const World& world)
        : half_step_(0.5 * world.resource<Clock>().dt), mass_(world.column<Bodies, InertialMass>()),
          velocity_(world.column<Bodies, Velocity>()),
          acceleration_(world.column<Bodies, Acceleration>()),
          spin_(world.column<Bodies, AngularVelocity>()) {
        const Table& bodies = world.table<Bodies>();
        if (bodies.has<SphereInertia>()) {
            of_spheres_ = bodies.column<SphereInertia>();
        } else {
            orientation_ = bodies.column<Orientation>();
            of_clumps_ = bodies.column<InertialInertia>();
        }
    }
    double operator()(Row b) const {
        const Vec3 v = velocity_[b] + half_step_ * acceleration_[b];
        const Vec3& w = spin_[b];
        double turning = 0;
        if (!of_spheres_.empty()) {
            turning = of_spheres_[b] * w.squaredNorm();
        } else {
            const Vec3 local = orientation_[b].conjugate() * w;
            turning = local.cwiseAbs2().dot(of_clumps_[b]);
        }
        return 0.5 * (mass_[b] * v.squaredNorm() + turning);
    }

private:
    double half_step_;
    std::span<const double> mass_, of_spheres_; ///< inertia of single spheres, or of clumps
    std::span<const Vec3> velocity_, acceleration_, spin_, of_clumps_;
    std::span<const Quat> orientation_;
};

struct Sums {
    ExactSum kinetic, elastic, overlap, normal_force;
    ExactVector boundary_force, weight;
};

double elastic_energy(const Materials& materials, const LawTraits& law, const TouchingPair& p) {
    const Elasticity e = elasticity_of(law, materials, p.law, p.force.overlap, p.radius, p.worn);
    const double shear2 =
                     p.spring.x * p.spring.x + p.spring.y * p.spring.y + p.spring.z * p.spring.z,
                 roll2 = p.roll.x * p.roll.x + p.roll.y * p.roll.y + p.roll.z * p.roll.z +
                         p.roll.twist * p.roll.twist;
    return p.share *
           (e.energy + 0.5 * e.shear * (shear2 + materials.policy.rolling_stiffness_ratio * roll2));
}

/// Number of different pairs of bodies.
std::size_t number_of(std::vector<std::pair<Row, Row>>& bodies) {
    std::ranges::sort(bodies);
    return bodies.size() - std::ranges::unique(bodies).size();
}

/// Returns the number of pairs of bodies that touch.
template <class Pairs>
std::size_t add_contacts(const World& world, const OverRanks& ranks, Quantities& q, Sums& sums) {
    if (!world.has<Pairs>()) return 0;
    const LawTraits& law = traits(world.resource<ContactLaw>().law);
    const auto& materials = world.resource<Materials>();
    const Free is_free(world);
    // each body has one sphere, and no two bodies touch in several places
    const bool are_single =
        std::is_same_v<Pairs, SpherePairs> && world.table<Bodies>().has<SphereInertia>();
    std::size_t single = 0;
    std::vector<std::pair<Row, Row>> bodies;
    TouchingPairs<Pairs>(world).visit([&](const TouchingPair& p) {
        if (!ranks.counts(p.owner)) return;
        if (!is_free[p.partner]) sums.boundary_force.add(-Vec3(p.force.fx, p.force.fy, p.force.fz));
        if (law.reaches)
            sums.elastic.add(law.potential(materials.own_pairs[p.law], p.force.overlap, p.radius));
        if (p.force.overlap < 0) return; // held beyond touch
        ++q.contacts;
        sums.overlap.add(p.force.overlap);
        q.largest_overlap = std::max(q.largest_overlap, p.force.overlap);
        sums.normal_force.add(p.force.normal_force);
        sums.elastic.add(elastic_energy(materials, law, p));
        if (are_single)
            ++single;
        else
            bodies.emplace_back(p.owner, p.partner);
    });
    return single + number_of(bodies);
}

/// Returns the number of free bodies.
std::size_t add_bodies(const World& world, const OverRanks& ranks, Sums& sums) {
    std::size_t free_bodies = 0;
    const Vec3 gravity =
        world.has_resource<Gravity>() ? world.resource<Gravity>().value : Vec3(Vec3::Zero());
    const Free is_free(world);
    const KineticEnergy kinetic_energy(world);
    const auto mass = world.column<Bodies, Mass>();
    for (Row b = 0; b < mass.size(); ++b) {
        if (!is_free[b] || !ranks.counts(b)) continue;
        ++free_bodies;
        sums.kinetic.add(kinetic_energy(b));
        sums.weight.add(mass[b] * gravity);
    }
    return free_bodies;
}

} // namespace

Quantities compute_quantities(const World& world) {
    Quantities q;
    Sums sums;
    const OverRanks ranks(world);
    std::size_t free_bodies = add_bodies(world, ranks, sums), between_grains = 0;
    for_each_kind_of_pair([&]<class Pairs>() {
        const std::size_t pairs = add_contacts<Pairs>(world, ranks, q, sums);
        q.body_contacts += pairs;
        if constexpr (std::is_same_v<Pairs, SpherePairs>) between_grains = pairs;
    });
    auto &force = sums.boundary_force, &weight = sums.weight;
    ranks.add({&sums.kinetic, &sums.elastic, &sums.overlap, &sums.normal_force, &force[0],
               &force[1], &force[2], &weight[0], &weight[1], &weight[2]});
    ranks.add({&free_bodies, &between_grains, &q.contacts, &q.body_contacts});
    q.largest_overlap = ranks.largest(q.largest_overlap);
    q.kinetic_energy = sums.kinetic.value();
    q.boundary_force = force.value();
    q.weight = weight.value();
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
    const Free is_free(world);
    std::vector<char> carries(bodies.size(), 0);
    for (const EntityId parent : world.column<Spheres, ParentId>()) carries[rows[parent]] = 1;
    ExactSum sum;
    double count = 0;
    for (Row b = 0; b < bodies.size(); ++b) {
        if (!is_free[b] || carries[b] == 0) continue;
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
