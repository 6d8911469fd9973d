#include "systems/experiments/bench.hpp"
#include "systems/fusion/correct.hpp"
#include "systems/fusion/fuse.hpp"
#include "systems/fusion/spread.hpp"
#include "tests/about.hpp"

#include <doctest/doctest.h>

using namespace bris;

namespace {

constexpr double radius = 0.01, kn = 1e5, overlap = 1e-5;

/// Balls in a row along x, every two of them in touch, the last one held; the first is to go `d`.
struct Chain {
    Simulation sim;
    unsigned balls;

    Chain(unsigned count, const Vec3& d) : sim(make(count)), balls(count) {
        sim.advance();
        give_correction(value_of<Correction>(sim, 0), value_of<Guided>(sim, 0), d, Vec3::Zero(), 10);
    }
    static Simulation make(unsigned count) {
        World world = make_world(Grains::spheres);
        const auto m = world.resource<Materials>().add(linear_material(kn, 0));
        world.resource<Materials>().mix();
        for (unsigned k = 0; k < count; ++k)
            (void)add_sphere(world, Vec3(k * (2 * radius - overlap), 0, 0), radius, m, k + 1 == count ? Motion::fixed : Motion::free);
        add_sensors(world, {0}, {{}}, {}, 10);
        return begin(std::move(world), LawName::linear, 1e-6);
    }
    Vec3 way(EntityId ball) {
        const CorrectionRow& c = value_of<Correction>(sim, ball);
        return c.steps * c.shift;
    }
};

} // namespace

TEST_SUITE("systems/fusion/spread") {
    TEST_CASE("a correction fades along a chain as its springs share the way, and stores the energy of springs in series") {
        Chain chain(6, Vec3(1e-6, 0, 0)); // five springs
        const double energy = spread_corrections(chain.sim.world(), {.hold = 1e9, .float_free = 1e-9});
        for (EntityId k = 0; k < 5; ++k) CHECK(chain.way(k).x() == about(1e-6 * (5 - k) / 5).epsilon(1e-6));
        CHECK(chain.way(5).norm() == 0);
        CHECK(energy == about(0.5 * kn / 5 * 1e-12).epsilon(1e-6));
    }

    TEST_CASE("nobody but the sensor's ball gets a net force from it") {
        Chain chain(6, Vec3(1e-6, 0, 0));
        (void)spread_corrections(chain.sim.world(), {.hold = 1e9, .float_free = 1e-9});
        for (EntityId k = 1; k < 5; ++k) {
            const double left = chain.way(k - 1).x() - chain.way(k).x(), right = chain.way(k).x() - chain.way(k + 1).x();
            CHECK(kn * (left - right) == doctest::Approx(0).scale(kn * 1e-6).epsilon(1e-6));
        }
    }

    TEST_CASE("what no spring resists moves the sensor's ball alone") {
        Chain chain(6, Vec3(0, 1e-6, 0)); // across a chain without tangential springs
        (void)spread_corrections(chain.sim.world());
        CHECK(chain.way(0).y() == about(1e-6).epsilon(2e-3));
        for (EntityId k = 1; k < 5; ++k) CHECK(std::abs(chain.way(k).y()) < 1e-9);
    }

    TEST_CASE("with nothing to correct nothing moves") {
        Chain chain(4, Vec3::Zero());
        value_of<Correction>(chain.sim, 0) = {};
        CHECK(spread_corrections(chain.sim.world()) == 0);
        CHECK(chain.way(1).norm() == 0);
    }
}
