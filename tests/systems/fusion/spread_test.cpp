#include "engine/random.hpp"
#include "scenarios/specimens/bench.hpp"
#include "systems/fusion/correct.hpp"
#include "systems/fusion/fuse.hpp"
#include "systems/fusion/spread.hpp"
#include "systems/fusion/spring_network.hpp"
#include "tests/about.hpp"
#include "tests/support.hpp"

#include <Eigen/Dense>
#include <doctest/doctest.h>

#include <algorithm>

using namespace bris;

namespace {

constexpr double radius = 0.01, kn = 1e5, ks = 4e4, overlap = 1e-5, apart = 2 * radius - overlap;

/// Balls in a row along x, each in contact with the next. The last one is fixed; the first has a
/// correction `d` (m).
struct Chain {
    Simulation sim;
    unsigned balls;

    Chain(unsigned count, const Vec3& d, double friction = 0)
        : sim(make(count, friction)), balls(count) {
        sim.advance();
        correct(d);
    }
    void correct(const Vec3& d) {
        set_correction(value_of<Correction>(sim, 0), value_of<Guided>(sim, 0), d, Vec3::Zero(), 10);
    }
    static Simulation make(unsigned count, double friction) {
        World world = make_world(Grains::spheres);
        const auto m = world.resource<Materials>().add(linear_material(kn, ks, friction));
        world.resource<Materials>().mix();
        for (unsigned k = 0; k < count; ++k)
            (void)add_sphere(world, Vec3(k * apart, 0, 0), radius, m,
                             k + 1 == count ? Motion::fixed : Motion::free);
        add_sensors(world, {0}, {{}}, {}, 10);
        return begin(std::move(world), {.dt = 1e-6, .law = LawName::linear, .unlimited = true});
    }
    Vec3 displacement(EntityId ball) {
        const CorrectionRow& c = value_of<Correction>(sim, ball);
        return c.steps * c.shift;
    }
};

struct Grain {
    Vec3 position;
    bool free;
};

/// Balls with friction, some of them with sensors. After one step all contact forces are known.
Simulation with_sensors(const std::vector<Grain>& balls, const std::vector<EntityId>& sensors,
                        const BenchSettings& settings = {.dt = 1e-6}) {
    World world = make_world(Grains::spheres);
    const auto m = world.resource<Materials>().add(linear_material(kn, ks, 0.5));
    world.resource<Materials>().mix();
    for (const Grain& b : balls)
        (void)add_sphere(world, b.position, radius, m, b.free ? Motion::free : Motion::fixed);
    add_sensors(world, sensors, std::vector<std::vector<TimedMeasurement>>(sensors.size()), {}, 10);
    return begin(std::move(world), settings);
}

void correct(Simulation& sim, EntityId ball, const Vec3& shift, const Vec3& turn) {
    set_correction(value_of<Correction>(sim, ball), value_of<Guided>(sim, ball), shift, turn, 10);
}

Vector6 motion(Simulation& sim, EntityId ball) {
    const CorrectionRow& c = value_of<Correction>(sim, ball);
    Vector6 m;
    m << c.steps * c.shift, c.steps * c.turn;
    return m;
}

/// A cube with `side` balls along each edge, the outer ones fixed.
std::vector<Grain> lattice(int side) {
    std::vector<Grain> balls;
    const auto outer = [&](int i) { return i == 0 || i == side - 1; };
    for (int k = 0; k < side * side * side; ++k) {
        const int x = k % side, y = k / side % side, z = k / side / side;
        balls.push_back({apart * Vec3(x, y, z), !outer(x) && !outer(y) && !outer(z)});
    }
    return balls;
}

/// Shifts and rotations of all balls from the dense equations, assembled spring by spring.
Eigen::VectorXd dense_solution(const std::vector<Grain>& balls,
                               const std::vector<std::pair<EntityId, Vector6>>& wanted,
                               const SpreadSettings& settings) {
    const auto n = static_cast<Eigen::Index>(6 * balls.size());
    Eigen::MatrixXd A = Eigen::MatrixXd::Zero(n, n);
    Eigen::VectorXd b = Eigen::VectorXd::Zero(n);
    Vector6 unit;
    unit << Vec3::Constant(kn), Vec3::Constant(kn * radius * radius);
    for (std::size_t i = 0; i < balls.size(); ++i)
        A.diagonal().segment<6>(static_cast<Eigen::Index>(6 * i)) =
            balls[i].free ? settings.float_free * unit : 1e20 * unit;
    for (const auto& [ball, displacement] : wanted) {
        A.diagonal().segment<6>(6 * ball) += settings.hold * unit;
        b.segment<6>(6 * ball) = settings.hold * unit.cwiseProduct(displacement);
    }
    for (std::size_t i = 0; i < balls.size(); ++i)
        for (std::size_t k = 0; k < i; ++k) {
            const Vec3 between = balls[i].position - balls[k].position;
            if (between.norm() >= 2 * radius) continue;
            const Vec3 normal = between.normalized(), across = normal.unitOrthogonal();
            for (const auto& [axis, stiffness] :
                 {std::pair<Vec3, double>{normal, kn}, {across, ks}, {normal.cross(across), ks}}) {
                Eigen::VectorXd spring =
                    Eigen::VectorXd::Zero(n); // its elongation as a function of all motions
                spring.segment<6>(static_cast<Eigen::Index>(6 * i)) << axis,
                    Vec3(-0.5 * between).cross(axis);
                spring.segment<6>(static_cast<Eigen::Index>(6 * k)) << -axis,
                    Vec3(0.5 * between).cross(-axis);
                A += stiffness * spring * spring.transpose();
            }
        }
    return A.ldlt().solve(b);
}

} // namespace

TEST_SUITE("fusion/spread") {
    TEST_CASE("a correction decreases linearly along a chain and stores the energy of springs in "
              "series") {
        Chain chain(6, Vec3(1e-6, 0, 0)); // five springs
        const double energy =
            spread_corrections(chain.sim.world(), {.hold = 1e9, .float_free = 1e-9});
        for (EntityId k = 0; k < 5; ++k)
            CHECK(chain.displacement(k).x() == about(1e-6 * (5 - k) / 5).epsilon(1e-6));
        CHECK(chain.displacement(5).norm() == 0);
        CHECK(energy == about(0.5 * kn / 5 * 1e-12).epsilon(1e-6));
    }

    TEST_CASE("with springs that hold all balls in place, a correction decreases along a chain as "
              "Green's function") {
        constexpr unsigned n =
            40; // number of springs: u(k - 1) - (2 + f) u(k) + u(k + 1) = 0, u(n) = 0
        for (const double f : {1e-3, 0.3}) {
            Chain chain(n + 1, Vec3(1e-6, 0, 0));
            const SpreadSettings settings{.float_free = f, .tolerance = 1e-13};
            const double angle = std::acosh(1 + 0.5 * f), whole = std::sinh(n * angle);
            const double first =
                1e-6 * settings.hold / (settings.hold + f + 1 - std::sinh((n - 1) * angle) / whole);
            (void)spread_corrections(chain.sim.world(), settings);
            for (EntityId k = 0; k < n; ++k)
                CHECK(std::abs(chain.displacement(k).x() -
                               first * std::sinh((n - k) * angle) / whole) < 1e-10 * first);
        }
    }

    TEST_CASE("in a lattice that resists shifts and rotations a correction spreads as in the dense "
              "solution") {
        const auto balls = lattice(5);
        const EntityId centre = 62, beside = 63, corner = 31;
        std::vector<std::pair<EntityId, Vector6>> wanted(2);
        wanted[0].first = centre;
        wanted[0].second << 1e-6, -2e-6, 0.5e-6, 1e-4, 2e-4, -1e-4;
        wanted[1].first = corner;
        wanted[1].second << 0, 1e-6, 1e-6, 0, 0, 3e-4;
        SpreadSettings settings{.tolerance = 1e-13};
        const Eigen::VectorXd whole = dense_solution(balls, wanted, settings);
        for (const double tolerance :
             {1e-10, 1e-2}) { // with the smallest tolerance, and with the default
            Simulation sim = with_sensors(balls, {corner, centre});
            sim.advance();
            for (const auto& [ball, displacement] : wanted)
                correct(sim, ball, displacement.head<3>(), displacement.tail<3>());
            if (tolerance > 1e-3) settings = {};
            (void)spread_corrections(sim.world(), settings);
            for (EntityId b = 0; b < balls.size(); ++b) {
                CAPTURE(b);
                const Vector6 error = motion(sim, b) - whole.segment<6>(6 * b);
                CHECK(error.head<3>().norm() < tolerance * wanted[0].second.head<3>().norm());
                CHECK(error.tail<3>().norm() < tolerance * wanted[0].second.tail<3>().norm());
            }
            CHECK(motion(sim, beside).head<3>().norm() > 3e-7); // neighbours do move
        }
    }

    TEST_CASE("a spread correction exerts a net force only on the sensor's ball") {
        Chain chain(6, Vec3(1e-6, 0, 0));
        (void)spread_corrections(chain.sim.world(), {.hold = 1e9, .float_free = 1e-9});
        for (EntityId k = 1; k < 5; ++k) {
            const double left = chain.displacement(k - 1).x() - chain.displacement(k).x(),
                         right = chain.displacement(k).x() - chain.displacement(k + 1).x();
            CHECK(kn * (left - right) == doctest::Approx(0).scale(kn * 1e-6).epsilon(1e-6));
        }
    }

    TEST_CASE("transverse to a chain the sensor's ball moves alone if contacts slip, and moves its "
              "neighbour if they stick") {
        for (const double before :
             {0.0, 1e-7, 4e-5}) { // m; contacts slip beyond friction kn overlap / ks
            CAPTURE(before);
            const bool sticks = before == 1e-7;
            Chain chain(6, Vec3(0, before, 0), before > 0 ? 0.5 : 0);
            chain.sim.advance(10);
            chain.correct(Vec3(0, 1e-6, 0));
            (void)spread_corrections(chain.sim.world());
            CHECK(chain.displacement(0).y() == about(1e-6).epsilon(2e-3));
            const CorrectionRow& next = value_of<Correction>(chain.sim, 1);
            CHECK((next.steps * radius * next.turn.norm() > 1e-7) == sticks);
            if (!sticks)
                for (EntityId k = 1; k < 5; ++k) CHECK(std::abs(chain.displacement(k).y()) < 1e-9);
        }
    }

    TEST_CASE("neighbours without other contacts shift and rotate with the sensor's ball as one "
              "rigid body") {
        std::vector<Grain> balls; // each touches the other three, so they cannot roll on each other
        for (const Vec3& corner :
             {Vec3(1, 1, 1), Vec3(1, -1, -1), Vec3(-1, 1, -1), Vec3(-1, -1, 1)})
            balls.push_back({apart / std::sqrt(8) * corner, true});
        Simulation sim = with_sensors(balls, {0});
        sim.advance();
        const Vec3 shift(1e-6, 2e-6, -1e-6), turn(1e-4, -2e-4, 3e-4);
        correct(sim, 0, shift, turn);
        const double energy =
            spread_corrections(sim.world(), {.hold = 1e3, .float_free = 1e-9, .tolerance = 1e-10});
        for (EntityId b = 0; b < 4; ++b) {
            const Vec3 along = shift + turn.cross(balls[b].position - balls[0].position);
            CHECK((motion(sim, b).head<3>() - along).norm() < 1e-6 * shift.norm());
            CHECK((motion(sim, b).tail<3>() - turn).norm() < 1e-6 * turn.norm());
        }
        CHECK(energy < 1e-9 * kn * shift.squaredNorm());
    }

    TEST_CASE("balls without contacts stay, and a sensor's ball without contacts moves alone") {
        std::vector<Grain> balls = lattice(3); // one free ball among fixed ones
        const EntityId inside = 13, lonely = 27, pair = 28;
        balls.push_back({Vec3(-3 * apart, 0, 0), true});
        balls.push_back({Vec3(-6 * apart, 0, 0), true});
        balls.push_back({Vec3(-7 * apart, 0, 0), true});
        for (const EntityId sensor : {inside, lonely}) {
            Simulation sim = with_sensors(balls, {inside, lonely});
            sim.advance();
            correct(sim, sensor, Vec3(1e-6, 0, 0), Vec3::Zero());
            const double energy = spread_corrections(sim.world());
            CHECK((energy > 0) == (sensor == inside));
            CHECK(motion(sim, sensor).x() == about(1e-6).epsilon(5e-3));
            for (EntityId b = 0; b < balls.size(); ++b)
                if (b != sensor) {
                    CHECK(motion(sim, b).norm() == 0);
                    CHECK(value_of<Guided>(sim, b) == 0);
                }
            CHECK(value_of<Position>(sim, lonely) == balls[lonely].position);
        }
        Simulation sim = with_sensors(balls, {pair});
        sim.advance();
        correct(sim, pair, Vec3(1e-6, 0, 0), Vec3::Zero());
        (void)spread_corrections(sim.world());
        CHECK(motion(sim, pair + 1).x() ==
              about(1e-6).epsilon(2e-3)); // the sensor's ball touches this one
        CHECK(motion(sim, inside).norm() == 0);
    }

    TEST_CASE("spread corrections have the same bits before and after a restore, in any order of "
              "rows and on any number of threads") {
        std::vector<Grain> balls = lattice(6);
        Random random(5, 1);
        for (Grain& b : balls)
            b.position += 4e-6 * random.direction(); // some contacts slip, some pairs do not touch
        for (std::size_t k = balls.size() - 1; k > 0; --k)
            std::swap(balls[k],
                      balls[static_cast<std::size_t>(random.uniform(0, static_cast<double>(k)))]);
        std::vector<EntityId> sensors;
        for (EntityId b = 0; sensors.size() < 3; ++b)
            if (balls[b].free) sensors.push_back(b);
        const auto spread = [&](Simulation& sim) {
            sim.advance();
            for (const EntityId s : sensors)
                correct(sim, s, Vec3(1e-6, 2e-6 * s, 0), Vec3(0, 1e-4, 0));
            const double energy = spread_corrections(sim.world());
            std::vector<Vector6> all;
            for (EntityId b = 0; b < balls.size(); ++b) all.push_back(motion(sim, b));
            return std::pair(energy, all);
        };
        Simulation whole = with_sensors(balls, sensors, {.dt = 1e-6, .lists = {.sort_every = 0}});
        whole.advance(20);
        const Archive kept = whole.snapshot();
        const auto expected = spread(whole);
        CHECK(std::ranges::count_if(expected.second,
                                    [](const Vector6& m) { return m.norm() > 1e-9; }) > 40);
        for (const unsigned threads : {1u, 2u}) {
            Simulation sorted = with_sensors(
                balls, sensors, {.dt = 1e-6, .threads = threads, .lists = {.sort_every = 1}});
            sorted.restore(kept);
            CHECK(spread(sorted) == expected);
            unsigned moved = 0;
            for (EntityId b = 0; b < balls.size(); ++b)
                moved += row_of_body(sorted.world(), b) != row_of_body(whole.world(), b) ? 1u : 0u;
            CHECK(moved > 100);
        }
    }

    TEST_CASE("without a correction nothing moves") {
        Chain chain(4, Vec3::Zero());
        value_of<Correction>(chain.sim, 0) = {};
        CHECK(spread_corrections(chain.sim.world()) == 0);
        CHECK(chain.displacement(1).norm() == 0);
    }
}
