#include "engine/errors.hpp"
#include "engine/random.hpp"
#include "systems/fusion/spring_network.hpp"
#include "tests/about.hpp"

#include <Eigen/Dense>
#include <doctest/doctest.h>

#include <algorithm>
#include <limits>

using namespace bris;

namespace {

/// Bodies that are joined at random to some bodies of lower number, by one to three joints; some
/// joints lead to something that stays.
SpringNetwork random_network(std::uint32_t bodies) {
    Random random(1, bodies);
    SpringNetwork network;
    const auto vector = [&] {
        return Vec3(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1));
    };
    for (std::uint32_t i = 0; i < bodies; ++i) {
        Hold& hold = network.holds.emplace_back();
        hold.stiffness = Vector6::Constant(i % 7 == 0 ? 1e3 : 1e-3);
        if (i % 7 == 0) hold.wanted << vector(), vector();
        std::vector<std::uint32_t> others;
        for (unsigned k = 0; k < std::min(i, 4u); ++k)
            others.push_back(static_cast<std::uint32_t>(random.uniform(0, i)));
        if (i % 5 == 0) others.push_back(that_stays);
        std::ranges::sort(others); // two bodies may be joined two or three times
        for (const std::uint32_t other : others)
            network.joints.push_back({i, other, vector(), vector(), random.direction(),
                                      random.uniform(0.5, 2), random.uniform(0, 1)});
    }
    return network;
}

/// Dense solution of the equations, assembled spring by spring.
Eigen::VectorXd dense_solution(const SpringNetwork& network) {
    const auto n = static_cast<Eigen::Index>(6 * network.holds.size());
    Eigen::MatrixXd A = Eigen::MatrixXd::Zero(n, n);
    Eigen::VectorXd b = Eigen::VectorXd::Zero(n);
    for (std::size_t i = 0; i < network.holds.size(); ++i) {
        const auto at = static_cast<Eigen::Index>(6 * i);
        A.diagonal().segment<6>(at) = network.holds[i].stiffness;
        b.segment<6>(at) = network.holds[i].stiffness.cwiseProduct(network.holds[i].wanted);
    }
    for (const Joint& j : network.joints) {
        const Vec3 across = j.normal.unitOrthogonal(), along = j.normal.cross(across);
        for (const auto& [axis, k] : {std::pair{j.normal, j.kn}, {across, j.ks}, {along, j.ks}}) {
            Eigen::VectorXd spring =
                Eigen::VectorXd::Zero(n); // its elongation as a function of all motions
            spring.segment<6>(6 * j.body) << axis, j.arm.cross(axis);
            if (j.other != that_stays)
                spring.segment<6>(6 * j.other) << -axis, -j.other_arm.cross(axis);
            A += k * spring * spring.transpose();
        }
    }
    return A.ldlt().solve(b);
}

double difference(const std::vector<Vector6>& motion, const Eigen::VectorXd& other) {
    double largest = 0;
    for (std::size_t i = 0; i < motion.size(); ++i)
        largest = std::max(largest,
                           (motion[i] - other.segment<6>(static_cast<Eigen::Index>(6 * i))).norm());
    return largest;
}

} // namespace

TEST_SUITE("fusion/spring_network") {
    TEST_CASE("bodies joined at random move as in the dense solution") {
        for (const std::uint32_t bodies : {1u, 2u, 10u, 60u}) {
            CAPTURE(bodies);
            const SpringNetwork network = random_network(bodies);
            const Eigen::VectorXd whole = dense_solution(network);
            CHECK(difference(motion_of_least_energy(network, 1e-13), whole) < 1e-10 * whole.norm());
            CHECK(difference(motion_of_least_energy(network, 1e-3), whole) < 1e-2 * whole.norm());
        }
    }

    TEST_CASE("no other motion stores less energy") {
        const SpringNetwork network = random_network(30);
        const auto energy = [&](const std::vector<Vector6>& motion) {
            double sum = energy_of_joints(network, motion);
            for (std::size_t i = 0; i < motion.size(); ++i) {
                const Vector6 error = motion[i] - network.holds[i].wanted;
                sum += 0.5 * error.dot(network.holds[i].stiffness.cwiseProduct(error));
            }
            return sum;
        };
        const auto motion = motion_of_least_energy(network, 1e-13);
        for (std::size_t i = 0; i < motion.size(); ++i)
            for (Eigen::Index axis = 0; axis < 6; ++axis)
                for (const double step : {-1e-3, 1e-3}) {
                    auto other = motion;
                    other[i][axis] += step;
                    CHECK(energy(other) > energy(motion));
                }
    }

    TEST_CASE("two bodies and a wall share a displacement as springs in series do") {
        SpringNetwork network{
            {{Vector6::Constant(1e6), Vector6::Zero()}, {Vector6::Constant(1e-9), Vector6::Zero()}},
            {}};
        network.holds[0].wanted[0] = 1e-3;
        network.joints = {{1, 0, Vec3(-1, 0, 0), Vec3(1, 0, 0), Vec3::UnitX(), 2, 0},
                          {1, that_stays, Vec3(1, 0, 0), Vec3::Zero(), Vec3::UnitX(), 6, 0}};
        const auto motion = motion_of_least_energy(network, 1e-12);
        // two springs in series, 1.5 N/m, act against the spring that holds the first body
        const double held = 1e6 / (1e6 + 1.5);
        CHECK(motion[0][0] == about(1e-3 * held).epsilon(1e-9));
        CHECK(motion[1][0] == about(0.25e-3 * held).epsilon(1e-9));
        CHECK(energy_of_joints(network, motion) ==
              about(0.5 * 1.5 * 1e-6 * held * held).epsilon(1e-9));
    }

    TEST_CASE("without joints every body moves to its wanted displacement") {
        SpringNetwork network{{{Vector6::Constant(2), Vector6::Constant(1e-3)},
                               {Vector6::Constant(1e-3), Vector6::Zero()}},
                              {}};
        const auto motion = motion_of_least_energy(network, 1e-3);
        CHECK(motion[0] == Vector6::Constant(1e-3));
        CHECK(motion[1] == Vector6::Zero());
    }

    TEST_CASE("stiffnesses that are not finite or not positive are an error") {
        SpringNetwork network = random_network(10);
        network.joints[3].kn = std::numeric_limits<double>::quiet_NaN();
        constexpr auto message = "fusion: contact network: expected stiffnesses that are finite "
                                 "and positive, found others";
        CHECK_THROWS_WITH_AS(motion_of_least_energy(network, 1e-3), message, SimulationError);
        network.joints[3].kn = -1e4;
        CHECK_THROWS_WITH_AS(motion_of_least_energy(network, 1e-3), message, SimulationError);
    }

    TEST_CASE("a tolerance that the precision of numbers does not allow is an error of its own") {
        CHECK_THROWS_WITH_AS(motion_of_least_energy(random_network(10), 1e-140),
                             doctest::Contains("of its motion below 1e-140 after 61 iterations"),
                             SimulationError);
    }
}
