#include "systems/contact/stable_step.hpp"

#include "components/body.hpp"
#include "components/elasticity.hpp"
#include "components/kinds.hpp"
#include "components/material.hpp"
#include "components/pair.hpp"
#include "components/settings.hpp"
#include "components/sphere.hpp"

#include <algorithm>
#include <limits>

namespace bris {

namespace {

constexpr auto free_motion = static_cast<std::uint32_t>(Motion::free);

/// What one contact opposes to motion: tangent stiffnesses and dashpots.
struct Stiffness {
    double normal, shear, rolling, normal_damping, shear_damping;
    Stiffness times(double s) const { return {s * normal, s * shear, s * rolling, s * normal_damping, s * shear_damping}; }
};

void add(BodyStiffness& sum, const Stiffness& k, const Vec3& arm, const Vec3& normal) {
    const double across = arm.cross(normal).squaredNorm(), along = arm.squaredNorm();
    sum.translation += std::max(k.normal, k.shear);
    sum.rotation += k.normal * across + k.shear * along + k.rolling;
    sum.damping += std::max(k.normal_damping, k.shear_damping);
    sum.rotation_damping += k.normal_damping * across + k.shear_damping * along;
}

Stiffness stiffness_of(LawName name, const LawRow& law, const Elasticity& e, double inverse_mass, double rolling_ratio, double radius) {
    Stiffness k{e.normal, e.shear, has_rolling(name) ? rolling_ratio * e.shear * radius * radius : 0, 0, 0};
    if (!has_dashpots(name) || !(inverse_mass > 0)) return k;
    const double mass = 1 / inverse_mass;
    k.normal_damping = law.normal_rate * mass + law.normal_ratio * std::sqrt(e.normal * mass);
    k.shear_damping = law.shear_rate * mass + law.shear_ratio * std::sqrt(e.shear * mass);
    return k;
}

template <class Pairs> void add_pairs(const World& world, std::vector<BodyStiffness>& all) {
    if (!world.has<Pairs>()) return;
    const auto& index = world.resource<NearIndex<Pairs>>();
    if (index.size() == 0) return; // nothing is near, or no step has been taken
    const auto entry = world.column<typename Pairs::Near, NearPair>();
    const auto force = world.column<typename Pairs::Near, PairForce>();
    const auto rows = world.column<Pairs, PairRows>();
    const auto position = world.column<Bodies, Position>();
    const auto mass = world.column<Bodies, InertialMass>();
    const auto motion = world.column<Bodies, MotionOf>();
    const auto place = world.column<Listed, Place>(); // a step on: a difference of one step's motion
    const auto body = world.column<Listed, ListedBody>();
    const LawName law = world.resource<ContactLaw>().law;
    const auto& materials = world.resource<Materials>();
    const auto inverse_mass = [&](Row b) { return motion[b] == free_motion ? 1 / mass[b] : 0; };
    const double rolling = materials.policy.rolling_stiffness_ratio;
    const Table& near = world.table<typename Pairs::Near>();
    const double* share = near.template has<PatchShare>() ? near.template column<PatchShare>().data() : nullptr;
    // body by body: each adds its own contacts in the order of the force sums, the same bits always
    const auto add_one = [&](Row b, Row k) {
        const Vec3 point(force[k].px, force[k].py, force[k].pz);
        // the contact point lies on the normal through the centre of the owner's sphere
        const PlaceRow& p = place[entry[k].owner];
        const PairPlaces& pair = rows[entry[k].pair];
        const double radius = effective_radius<Pairs>(entry[k], place);
        const LawRow& row = materials.pairs(law)[pair.law];
        const double inverse = inverse_mass(body[entry[k].owner]) + inverse_mass(pair.partner_body);
        Stiffness k_of = stiffness_of(law, row, elasticity(row, is_hertz(law), force[k].overlap, radius), inverse, rolling, radius);
        if (share != nullptr) k_of = k_of.times(share[k]);
        add(all[b], k_of, point - position[b], (Vec3(p.x, p.y, p.z) - point).normalized());
    };
    for (Row b = 0; b < all.size(); ++b)
        index.for_contacts_of(b, [&](Row k, bool) { add_one(b, k); });
}

/// 2/omega of a damped mode, s: central differences with the dashpot's velocity predicted from the step before.
double limit(double omega2, double rate) {
    return omega2 > 0 ? 2 * (std::sqrt(omega2 + 0.25 * rate * rate) - 0.5 * rate) / omega2 : std::numeric_limits<double>::infinity();
}

/// Overlap of a body that hits another like it at `speed`, m (Hertz), or half a percent of its radius where that is
/// more: beds lie deeper than that only under loads that the estimate from touching contacts sees.
double impact_overlap(const LawRow& k, double mass, double radius, double speed) {
    const double coefficient = 4.0 / 3 * k.kn * std::sqrt(radius);
    return std::max(0.005 * radius, std::pow(5 * mass * speed * speed / (4 * coefficient), 0.4));
}

/// Least principal moment, by row; scaled (inertial) or true.
std::vector<double> least_inertia(const World& world, bool inertial) {
    const Table& bodies = world.table<Bodies>();
    std::vector<double> least(bodies.size());
    if (bodies.has<SphereInertia>()) {
        const auto inertia = bodies.column<SphereInertia>();
        std::copy(inertia.begin(), inertia.end(), least.begin());
        return least;
    }
    const auto inertia = inertial ? bodies.column<InertialInertia>() : bodies.column<Inertia>();
    for (std::size_t b = 0; b < least.size(); ++b) least[b] = inertia[b].minCoeff();
    return least;
}

} // namespace

std::vector<BodyStiffness> body_stiffness(const World& world) {
    std::vector<BodyStiffness> all(world.table<Bodies>().size());
    for_each_kind_of_pair([&]<class Pairs>() { add_pairs<Pairs>(world, all); });
    return all;
}

double stable_step(const World& world) {
    const auto stiffness = body_stiffness(world);
    const auto least = least_inertia(world, true);
    const auto mass = world.column<Bodies, InertialMass>();
    const auto motion = world.column<Bodies, MotionOf>();
    double step = std::numeric_limits<double>::infinity();
    for (std::size_t b = 0; b < stiffness.size(); ++b)
        if (motion[b] == free_motion) {
            const BodyStiffness& k = stiffness[b];
            step = std::min(step, limit(2 * (k.translation / mass[b] + k.rotation / least[b]),
                                        2 * (k.damping / mass[b] + k.rotation_damping / least[b])));
        }
    return step;
}

double stable_step_of_first_contact(const World& world) {
    const auto least = least_inertia(world, true);
    const Table& bodies = world.table<Bodies>();
    const auto mass = bodies.column<InertialMass>();
    const auto radius = bodies.column<BoundingRadius>();
    const auto true_mass = bodies.column<Mass>();
    const LawName law = world.resource<ContactLaw>().law;
    const bool spheres = bodies.has<SphereInertia>();
    double fastest = 0, step = std::numeric_limits<double>::infinity();
    for (const Vec3& v : bodies.column<Velocity>()) fastest = std::max(fastest, v.norm());
    for (std::size_t b = 0; b < bodies.size(); ++b) {
        if (!(true_mass[b] > 0)) continue; // boundaries; held rocks will be free some day
        for (const LawRow& row : world.resource<Materials>().pairs(law)) {
            if (!(row.kn > 0)) continue; // of boundaries among themselves
            const double overlap = is_hertz(law) ? impact_overlap(row, mass[b], radius[b], 2 * fastest) : 0;
            const Stiffness k = stiffness_of(law, row, elasticity(row, is_hertz(law), overlap, radius[b]), 1 / mass[b], world.resource<Materials>().policy.rolling_stiffness_ratio, radius[b]);
            const double largest = std::max(k.normal, k.shear), damping = std::max(k.normal_damping, k.shear_damping);
            // the normal of a single sphere passes through its centre
            const double turning = radius[b] * radius[b] / least[b];
            const double omega2 = largest / mass[b] + (spheres ? k.shear : largest) * turning;
            const double rate = damping / mass[b] + (spheres ? k.shear_damping : damping) * turning;
            step = std::min(step, limit(2 * omega2, 2 * rate));
        }
    }
    return step;
}

} // namespace bris
