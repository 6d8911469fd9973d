#include "systems/fusion/spread.hpp"

#include "components/body.hpp"
#include "components/kinds.hpp"
#include "components/material.hpp"
#include "components/pair.hpp"
#include "components/sensor.hpp"
#include "components/sphere.hpp"
#include "engine/errors.hpp"
#include "engine/ordering.hpp"
#include "engine/signal/attitude.hpp"
#include "systems/fusion/correct.hpp"

#include <Eigen/SparseCholesky>

#include <algorithm>
#include <array>

namespace bris {

namespace {

using Index = Eigen::Index;
using Vector6 = Eigen::Matrix<double, 6, 1>;
using Rows3x6 = Eigen::Matrix<double, 3, 6>;

/// A touching contact: its springs between two bodies.
struct Joint {
    PairNames names;
    Vec3 point, normal;
    double kn, ks;
};

template <class Pairs> void add_joints(const World& world, std::vector<Joint>& joints) {
    if (!world.has<Pairs>() || !world.has<typename Pairs::Near>()) return;
    const auto& index = world.resource<NearIndex<Pairs>>();
    const auto near = world.column<typename Pairs::Near, NearPair>();
    const auto force = world.column<typename Pairs::Near, PairForce>();
    const auto names = world.column<Pairs, PairKey>();
    const auto place = world.column<Listed, Place>();
    const auto& laws = world.resource<Materials>().linear_pairs;
    for (Row k = 0; k < index.size(); ++k) {
        if (!index.touches(k)) continue;
        const ForceRow& f = force[k];
        const PlaceRow& sphere = place[near[k].owner];
        const LawRow& law = laws[near[k].law];
        Joint j{names[near[k].pair], Vec3(f.px, f.py, f.pz), Vec3::Zero(), law.kn, law.ks};
        j.normal = (Vec3(sphere.x, sphere.y, sphere.z) - j.point).normalized();
        const double slip = (Vec3(f.fx, f.fy, f.fz) - f.normal_force * j.normal).norm();
        if (slip >= 0.99 * law.friction * f.normal_force) j.ks = 0;
        joints.push_back(j);
    }
}

/// Shifts and turns of a body move its point by [1, -r x].
Rows3x6 motion_at(const Vec3& r) {
    Rows3x6 m;
    m << Mat3::Identity(), -cross_matrix(r);
    return m;
}

struct Network {
    std::vector<Row> row;          ///< of each body id
    std::vector<Index> first;      ///< number of a body's first unknown, by id; -1: it is held
    Index unknowns = 0;
    double mean_stiffness = 0;     ///< N/m
    Eigen::SparseMatrix<double> K;
    std::vector<double> arm2;      ///< m2, of each body id: makes a turn a length
};

Network network_of(const World& world) {
    Network n;
    n.row = rows_by_id(world.column<Bodies, BodyId>());
    const auto motion = world.column<Bodies, MotionOf>();
    const auto position = world.column<Bodies, Position>();
    const auto radius = world.column<Bodies, BoundingRadius>();
    for (const Row r : n.row) {
        const bool free = motion[r] == static_cast<std::uint32_t>(Motion::free);
        n.first.push_back(free ? n.unknowns : -1);
        n.unknowns += free ? 6 : 0;
        n.arm2.push_back(radius[r] * radius[r]);
    }
    std::vector<Joint> joints;
    for_each_kind_of_pair([&]<class Pairs>() { add_joints<Pairs>(world, joints); });
    std::sort(joints.begin(), joints.end(), [](const Joint& a, const Joint& b) { return a.names < b.names; }); // the order of sums, whatever that of rows
    std::vector<Eigen::Triplet<double>> parts;
    for (const Joint& j : joints) {
        n.mean_stiffness += j.kn / static_cast<double>(joints.size());
        const Mat3 stiffness = j.ks * Mat3::Identity() + (j.kn - j.ks) * j.normal * j.normal.transpose();
        const std::array<EntityId, 2> body{j.names.owner, j.names.partner};
        for (const std::size_t a : {0u, 1u})
            for (const std::size_t b : {0u, 1u}) {
                const Index i = n.first[body[a]], k = n.first[body[b]];
                if (i < 0 || k < 0) continue;
                const Eigen::Matrix<double, 6, 6> block = (a == b ? 1 : -1) * motion_at(j.point - position[n.row[body[a]]]).transpose() * stiffness *
                                                          motion_at(j.point - position[n.row[body[b]]]);
                for (Index p = 0; p < 6; ++p)
                    for (Index q = 0; q < 6; ++q) parts.emplace_back(i + p, k + q, block(p, q));
            }
    }
    n.K.resize(n.unknowns, n.unknowns);
    n.K.setFromTriplets(parts.begin(), parts.end());
    return n;
}

} // namespace

double spread_corrections(World& world, const SpreadSettings& settings) {
    const Network n = network_of(world);
    const auto correction = world.column<Bodies, Correction>();
    const auto guided = world.column<Bodies, Guided>();
    const auto host = world.column<Sensors, SensorHost>();
    Eigen::SparseMatrix<double> A = n.K;
    Eigen::VectorXd pull = Eigen::VectorXd::Zero(n.unknowns);
    const auto hold = [&](EntityId id, double stiffness, const Vector6& at) {
        for (Index p = 0; p < 6; ++p) {
            const double k = stiffness * n.mean_stiffness * (p < 3 ? 1 : n.arm2[id]);
            A.coeffRef(n.first[id] + p, n.first[id] + p) += k;
            pull[n.first[id] + p] += k * at[p];
        }
    };
    for (EntityId id = 0; id < n.row.size(); ++id)
        if (n.first[id] >= 0) hold(id, settings.float_free, Vector6::Zero());
    double steps = 0;
    for (const EntityId id : host) {
        const CorrectionRow& c = correction[n.row[id]];
        Vector6 whole;
        whole << c.steps * c.shift, c.steps * c.turn;
        steps = std::max(steps, c.steps);
        if (c.steps > 0 && n.first[id] >= 0) hold(id, settings.hold, whole);
    }
    if (steps == 0) return 0;
    const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> solver(A);
    if (solver.info() != Eigen::Success) throw SimulationError("fusion: the stiffness of the contact network cannot be factorised");
    const Eigen::VectorXd u = solver.solve(pull);
    for (EntityId id = 0; id < n.row.size(); ++id)
        if (n.first[id] >= 0) {
            const Row b = n.row[id];
            give_correction(correction[b], guided[b], u.segment<3>(n.first[id]), u.segment<3>(n.first[id] + 3), static_cast<unsigned>(steps));
        }
    return 0.5 * u.dot(n.K * u);
}

} // namespace bris
