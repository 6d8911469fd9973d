#include "systems/contact/stable_step.hpp"

#include "components/body.hpp"
#include "components/kinds.hpp"
#include "components/material.hpp"
#include "components/pair.hpp"
#include "components/settings.hpp"
#include "components/sphere.hpp"
#include "engine/ordering.hpp"

#include <algorithm>
#include <limits>

namespace bris {

namespace {

constexpr auto free_motion = static_cast<std::uint32_t>(Motion::free);
constexpr double least_contacts = 6; // a rock is held by six or more

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
        if (!index.touches(k)) return;
        const Vec3 point(force[k].px, force[k].py, force[k].pz);
        // the contact point lies on the normal through the centre of the owner's sphere
        const PlaceRow& p = place[entry[k].owner];
        add(all[body], laws[rows[entry[k].pair].law], point - position[body],
            (Vec3(p.x, p.y, p.z) - point).normalized());
    };
    for (Row b = 0; b < all.size(); ++b) {
        for (Row k = index.incident_first[b]; k < index.incident_first[b + 1]; ++k) add_one(b, index.incident[k]);
        for (Row k = index.owned_first[b]; k < index.owned_first[b + 1]; ++k) add_one(b, k);
    }
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

MassScaling scale_masses(World& world, double dt, double safety, bool only_raise) {
    auto stiffness = body_stiffness(world);
    Table& bodies = world.table<Bodies>();
    const auto motion = bodies.column<MotionOf>();
    const auto mass = bodies.column<Mass>();
    const auto inertial = bodies.column<InertialMass>();
    const auto inertia = bodies.column<Inertia>();
    const auto inertial_inertia = bodies.column<InertialInertia>();
    const auto velocity = bodies.column<Velocity>();
    const auto momentum = bodies.column<AngularMomentum>();
    const auto spin = bodies.column<Spin>();
    const auto work = bodies.has<ScalingWork>() ? bodies.column<ScalingWork>() : std::span<double>();
    auto rows = rows_by_id(bodies.column<BodyId>()); // sums must not depend on the rows
    std::erase_if(rows, [&](Row b) { return motion[b] != free_motion; });

    // contacts come at any time: as many of the stiffest kind as hold a rock are always counted
    double one = 0, true_mass = 0, stiffness_sum = 0;
    for (const LawRow& law : world.resource<Materials>().pairs) one = std::max({one, law.kn, law.ks});
    const auto radius = bodies.column<BoundingRadius>();
    for (const Row b : rows) {
        BodyStiffness& k = stiffness[b];
        k.translation = std::max(k.translation, least_contacts * one);
        k.rotation = std::max(k.rotation, least_contacts * 0.25 * one * radius[b] * radius[b]);
        stiffness_sum += k.translation;
        true_mass += mass[b];
    }
    MassScaling result;
    // K/m = K_rotation/I = (safety / dt)^2, from dt = safety * 2 / sqrt(2 (K/m + K_rotation/I))
    result.dt = dt > 0 ? dt : safety * std::sqrt(true_mass / stiffness_sum);
    result.smallest_factor = std::numeric_limits<double>::infinity();
    const double factor = result.dt * result.dt / (safety * safety);
    for (const Row b : rows) {
        double m = factor * stiffness[b].translation;
        double i = factor * stiffness[b].rotation / inertia[b].minCoeff();
        if (only_raise) {
            m = std::max(m, inertial[b]);
            i = std::max(i, inertial_inertia[b].x() / inertia[b].x());
        }
        // velocities and angular momenta stay: the kinetic energy does not
        if (!work.empty()) {
            const double turning = 0.5 * momentum[b].dot(spin[b]), before = inertial_inertia[b].x() / inertia[b].x();
            work[b] += 0.5 * (m - inertial[b]) * velocity[b].squaredNorm() + turning * (before / i - 1);
        }
        inertial[b] = m;
        inertial_inertia[b] = i * inertia[b];
        result.total_mass += m;
        result.largest_factor = std::max(result.largest_factor, m / mass[b]);
        result.smallest_factor = std::min(result.smallest_factor, m / mass[b]);
    }
    return result;
}

void unscale_masses(World& world) {
    Table& bodies = world.table<Bodies>();
    std::copy_n(bodies.column<Mass>().begin(), bodies.size(), bodies.column<InertialMass>().begin());
    std::copy_n(bodies.column<Inertia>().begin(), bodies.size(), bodies.column<InertialInertia>().begin());
    const auto motion = bodies.column<MotionOf>();
    for (std::size_t b = 0; b < bodies.size(); ++b)
        if (motion[b] != free_motion) {
            bodies.column<InertialMass>()[b] = 1;
            bodies.column<InertialInertia>()[b] = Vec3::Ones();
        }
}

} // namespace bris
