#include "systems/stress/block_bound.hpp"

#include "components/body.hpp"
#include "components/elasticity.hpp"
#include "components/kinds.hpp"
#include "components/material.hpp"
#include "components/pair.hpp"
#include "components/sphere.hpp"

#include <vector>

namespace bris::stress {

namespace {

using Vec6 = Eigen::Matrix<double, 6, 1>;
using Mat6 = Eigen::Matrix<double, 6, 6>;

constexpr auto free_motion = static_cast<std::uint32_t>(Motion::free);

/// Stiffness of one contact against a body's translation and rotation, with its arm from the centre.
Mat6 block(const Elasticity& e, const Vec3& arm, const Vec3& normal) {
    const Mat3 along = normal * normal.transpose(), contact = e.normal * along + e.shear * (Mat3::Identity() - along);
    Mat3 cross; // arm x
    cross << 0, -arm.z(), arm.y(), arm.z(), 0, -arm.x(), -arm.y(), arm.x(), 0;
    Eigen::Matrix<double, 3, 6> motion; // of the contact point: v - arm x w
    motion << Mat3::Identity(), -cross;
    return motion.transpose() * contact * motion;
}

template <class Pairs> void add_pairs(const World& world, std::vector<Mat6>& all) {
    if (!world.has<Pairs>()) return;
    const auto& index = world.resource<NearIndex<Pairs>>();
    if (index.size() == 0) return;
    const auto entry = world.column<typename Pairs::Near, NearPair>();
    const auto force = world.column<typename Pairs::Near, PairForce>();
    const auto rows = world.column<Pairs, PairRows>();
    const auto position = world.column<Bodies, Position>();
    const auto motion = world.column<Bodies, MotionOf>();
    const auto place = world.column<Listed, Place>();
    const auto body = world.column<Listed, ListedBody>();
    const LawName law = world.resource<ContactLaw>().law;
    for (Row b = 0; b < all.size(); ++b)
        index.for_contacts_of(b, [&](Row k, bool) {
            const PairPlaces& pair = rows[entry[k].pair];
            const PlaceRow& p = place[entry[k].owner];
            const Vec3 point(force[k].px, force[k].py, force[k].pz);
            double inverse_radius = 1 / p.radius;
            if constexpr (std::is_same_v<Pairs, SpherePairs>) inverse_radius += 1 / place[entry[k].other].radius;
            const Elasticity e = elasticity(world.resource<Materials>().pairs(law)[pair.law], is_hertz(law), force[k].overlap, 1 / inverse_radius);
            const bool both = motion[body[entry[k].owner]] == free_motion && motion[pair.partner_body] == free_motion;
            all[b] += (both ? 2 : 1) * block(e, point - position[b], (Vec3(p.x, p.y, p.z) - point).normalized());
        });
}

/// Largest eigenvalue of a positive matrix: the norm of a high power, within 0.1 %.
double largest_eigenvalue(Mat6 m) {
    double log_scale = 0;
    constexpr int squarings = 12; // 6^(1/4096) = 1.0004
    for (int k = 0; k < squarings; ++k) {
        const double norm = m.norm();
        if (!(norm > 0)) return 0;
        m /= norm;
        log_scale = 2 * (log_scale + std::log(norm));
        m = (m * m).eval();
    }
    return std::exp((log_scale + std::log(m.norm())) / (1 << squarings));
}

} // namespace

double block_bound(const World& world) {
    const Table& bodies = world.table<Bodies>();
    std::vector<Mat6> all(bodies.size(), Mat6::Zero());
    for_each_kind_of_pair([&]<class Pairs>() { add_pairs<Pairs>(world, all); });
    double largest = 0;
    for (Row b = 0; b < all.size(); ++b) {
        if (bodies.column<MotionOf>()[b] != free_motion) continue;
        Mat3 root = Mat3::Identity(); // of the inverse inertia
        if (bodies.has<SphereInertia>()) {
            root /= std::sqrt(bodies.column<SphereInertia>()[b]);
        } else {
            const Mat3 axes = bodies.column<Orientation>()[b].toRotationMatrix();
            root = axes * bodies.column<InertialInertia>()[b].cwiseSqrt().cwiseInverse().asDiagonal() * axes.transpose();
        }
        Mat6 scale = Mat6::Zero();
        scale.topLeftCorner<3, 3>() = Mat3::Identity() / std::sqrt(bodies.column<InertialMass>()[b]);
        scale.bottomRightCorner<3, 3>() = root;
        largest = std::max(largest, largest_eigenvalue(scale * all[b] * scale));
    }
    return 2 / std::sqrt(largest);
}

} // namespace bris::stress
