#include "systems/contact/stable_step.hpp"

#include "components/body.hpp"
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

void add(BodyStiffness& sum, const LawRow& law, const Vec3& arm, const Vec3& normal) {
    sum.translation += std::max(law.kn, law.ks);
    sum.rotation += law.kn * arm.cross(normal).squaredNorm() + law.ks * arm.squaredNorm();
}

template <class Pairs> void add_pairs(const World& world, std::vector<BodyStiffness>& all) {
    if (!world.has<Pairs>()) return;
    const auto& index = world.resource<NearIndex<Pairs>>();
    if (index.size() == 0) return; // nothing is near, or no step has been taken
    const auto entry = world.column<typename Pairs::Near, NearPair>();
    const auto force = world.column<typename Pairs::Near, PairForce>();
    const auto rows = world.column<Pairs, PairRows>();
    const auto position = world.column<Bodies, Position>();
    const auto place = world.column<Listed, Place>(); // a step on: a difference of one step's motion
    const auto& laws = world.resource<Materials>().pairs;
    // body by body: each adds its own contacts in the order of the force sums, the same bits always
    const auto add_one = [&](Row body, Row k) {
        const Vec3 point(force[k].px, force[k].py, force[k].pz);
        // the contact point lies on the normal through the centre of the owner's sphere
        const PlaceRow& p = place[entry[k].owner];
        add(all[body], laws[rows[entry[k].pair].law], point - position[body],
            (Vec3(p.x, p.y, p.z) - point).normalized());
    };
    for (Row b = 0; b < all.size(); ++b)
        index.for_contacts_of(b, [&](Row k, bool) { add_one(b, k); });
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
    double largest = 0;
    for (std::size_t b = 0; b < stiffness.size(); ++b)
        if (motion[b] == free_motion)
            largest = std::max(largest, stiffness[b].translation / mass[b] + stiffness[b].rotation / least[b]);
    return largest > 0 ? 2 / std::sqrt(2 * largest) : std::numeric_limits<double>::infinity();
}

double stable_step_of_first_contact(const World& world) {
    const auto least = least_inertia(world, true);
    const Table& bodies = world.table<Bodies>();
    const auto mass = bodies.column<InertialMass>();
    const auto radius = bodies.column<BoundingRadius>();
    const auto true_mass = bodies.column<Mass>();
    double kn = 0, ks = 0, largest = 0;
    for (const LawRow& law : world.resource<Materials>().pairs) {
        kn = std::max(kn, law.kn);
        ks = std::max(ks, law.ks);
    }
    const bool spheres = bodies.has<SphereInertia>();
    for (std::size_t b = 0; b < bodies.size(); ++b) {
        if (!(true_mass[b] > 0)) continue; // boundaries; held rocks will be free some day
        // the normal of a single sphere passes through its centre
        const double turning = (spheres ? ks : std::max(kn, ks)) * radius[b] * radius[b];
        largest = std::max(largest, std::max(kn, ks) / mass[b] + turning / least[b]);
    }
    return largest > 0 ? 2 / std::sqrt(2 * largest) : std::numeric_limits<double>::infinity();
}

} // namespace bris
