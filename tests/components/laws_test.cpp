#include "components/laws/table.hpp"
#include "engine/math.hpp"
#include "engine/random.hpp"
#include "tests/about.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <string>

using namespace bris;

namespace {

/// One contact of a law, the same in all lanes.
template <class L>
struct Contact {
    CoefficientLanes k{lanes(1e9), lanes(8e8), lanes(0.5), lanes(0), lanes(0), lanes(0), lanes(0)};
    RollingLanes rolling{lanes(0.1), lanes(0.1), lanes(1), lanes(0)};
    ContactPolicy policy;
    double dt = 1e-5;
    SpringLanes spring{};
    RollLanes roll{};

    ForceLanes step(double overlap, const Vec3& sliding, double closing = 0,
                    const Vec3& angular_velocity = Vec3::Zero()) {
        ContactLanes c{lanes(0), lanes(0), lanes(1), lanes(overlap), lanes(10), lanes(0.005)};
        c.ux = c.vx = lanes(sliding.x());
        c.uy = c.vy = lanes(sliding.y());
        c.closing = lanes(closing);
        c.vz = lanes(-closing);
        c.wx = lanes(angular_velocity.x());
        c.wy = lanes(angular_velocity.y());
        c.wz = lanes(angular_velocity.z());
        return L::force(c, k, rolling, LawStep(policy, dt, true), spring, roll);
    }
};

} // namespace

TEST_SUITE("contact/laws") {
    TEST_CASE("the table of laws agrees with the definition of each law") {
        const auto& names = texts_of(LawName{});
        REQUIRE(names.size() > 7);
        for (std::size_t k = 0; k < names.size(); ++k) {
            const auto law = static_cast<LawName>(k);
            const LawTraits& t = traits(law);
            CAPTURE(t.name);
            CHECK(names[k] == t.name);
            CHECK(std::count(names.begin(), names.end(), names[k]) == 1);
            CHECK(names[k].starts_with(t.hertz ? "hertz" : "linear"));
            CHECK(t.springs == (names[k].find("frictionless") == std::string::npos));
            CHECK((t.springs || !t.rolling));
            CHECK((t.dashpots || !t.rolling));
            CHECK((t.springs || !t.reaches));
            CHECK(t.of_pairs.size() <= most_own_coefficients);
            const auto reads = [&](double Material::*member) {
                return std::ranges::any_of(
                    t.of_materials, [&](const Coefficient& c) { return c.of_material == member; });
            };
            CHECK(reads(&Material::young_modulus) == t.hertz);
            CHECK(reads(&Material::normal_stiffness) == !t.hertz);
            CHECK(reads(&Material::friction) == t.springs);
            CHECK(reads(&Material::restitution) == t.dashpots);
            CHECK(reads(&Material::rolling_friction) == t.rolling);
            const bool same = with_law(law, [&]<class L>() { return L::id == law; });
            CHECK(same);
        }
    }

    TEST_CASE(
        "the stiffness of a contact is the slope of the kernel's force, and its energy is the "
        "integral of the force") {
        const LawRow row{1e9, 8e8, 0.5, 0, 0, 0, 0, 0};
        const auto check = [&]<class L>(Contact<L> contact) {
            const LawTraits& t = traits(L::id);
            const double overlap = 1e-5, radius = 0.005;
            const Elasticity e = t.elasticity(row, overlap, radius);
            double energy = 0;
            constexpr int n = 1000;
            for (int k = 0; k < n; ++k) // midpoint rule, second order
                energy += contact.step((k + 0.5) / n * overlap, Vec3::Zero()).z[0] * overlap / n;
            CHECK(e.energy == about(energy).epsilon(1e-6));
            const double h = 1e-3 * overlap,
                         slope = (contact.step(overlap + h, Vec3::Zero()).z[0] -
                                  contact.step(overlap - h, Vec3::Zero()).z[0]) /
                                 (2 * h);
            CHECK(e.normal == about(slope).epsilon(1e-6));
        };
        check(Contact<LinearFrictionless>{});
        check(Contact<HertzFrictionless>{});
    }

    TEST_CASE("the potential of a liquid bridge is the work of its force, and zero at rupture") {
        const LawTraits& t = traits(LawName::linear_bridge);
        const OwnRow row =
            t.own_row(LiquidBridge{.surface_tension = 0.07, .contact_angle = 0.3, .volume = 2e-12}
                          .coefficients());
        const double radius = 0.0005, end = t.reach(row, radius);
        CHECK(end == about(1.15 * std::cbrt(2e-12)).epsilon(1e-14));
        CHECK(t.potential(row, -end, radius) == 0);
        CHECK(t.potential(row, -2 * end, radius) == 0);
        Contact<LinearBridge> contact; // touches once, then separates
        const auto own = [&] {
            OwnLanes lanes_of_row;
            for (std::size_t k = 0; k < most_own_coefficients; ++k)
                lanes_of_row.value[k] = lanes(row.value[k]);
            return lanes_of_row;
        }();
        const auto force = [&](double overlap) {
            ContactLanes c{lanes(0), lanes(0), lanes(1), lanes(overlap), lanes(10), lanes(radius)};
            return LinearBridge::force(c, contact.k, own, contact.rolling,
                                       LawStep(contact.policy, contact.dt, true), contact.spring,
                                       contact.roll);
        };
        const ForceLanes first = force(1e-12);
        CHECK(first.work.viscous[0] == about(-t.potential(row, 0, radius)).epsilon(1e-9));
        double work = 0;
        constexpr int n = 1000;
        for (int k = 0; k < n; ++k) {
            const ForceLanes f = force(-(k + 0.5) / n * end);
            CHECK(f.work.viscous[0] == 0); // only the forming bridge dissipates
            work -= f.z[0] * end / n;
        }
        CHECK(work == about(-t.potential(row, 0, radius)).epsilon(1e-5));
    }

    TEST_CASE("a liquid bridge without volume, and a law without bridges, have no reach") {
        const LawTraits& t = traits(LawName::linear_bridge);
        const OwnRow dry = t.own_row(LiquidBridge{.surface_tension = 0.07}.coefficients());
        CHECK(t.reach(dry, 1) == 0);
        CHECK(t.potential(dry, 1e-6, 1) == 0);
        CHECK(traits(LawName::linear).reach(dry, 1) == 0);
    }

    TEST_CASE("the force of Hertz is 4/3 E* sqrt(R*) overlap^1.5") {
        Contact<HertzFrictionless> contact;
        for (const double overlap : {1e-7, 1e-5, 1e-4})
            CHECK(contact.step(overlap, Vec3::Zero()).z[0] ==
                  about(4.0 / 3 * 1e9 * std::sqrt(0.005) * std::pow(overlap, 1.5)).epsilon(1e-14));
    }

    TEST_CASE(
        "a tangential spring begins when the surfaces meet, not at the beginning of the step") {
        Contact<Linear> contact;
        contact.k.friction = lanes(1e9);
        // an overlap of 1e-6 m at an approach speed of 1 m/s takes a tenth of the step
        const ForceLanes f = contact.step(1e-6, Vec3(0.2, 0, 0), 1);
        CHECK(f.x[0] == about(-8e8 * 0.2 * 1e-6).epsilon(1e-14));
    }

    TEST_CASE("a fast-rotating contact does not change the results of other contacts in its tile") {
        Random random(1, 1);
        for (int n = 0; n < 1000; ++n) {
            Lane slow = lanes(random.uniform(-9e-5, 9e-5)), with_fast = slow;
            with_fast[1] = 0.3;
            CHECK(root_near_one(with_fast)[0] == root_near_one(slow)[0]);
            CHECK(root_near_one(with_fast)[1] == std::sqrt(1.3));
            CHECK(std::abs(root_near_one(slow)[0] - std::sqrt(1 + slow[0])) < 3e-16);
        }
    }

    TEST_CASE("friction and a rescaled Mindlin spring never create energy on any path") {
        Random random(5, 0);
        double least = 0;
        const auto wander = [&]<class L>(L) {
            for (int run = 0; run < 200; ++run) {
                Contact<L> contact;
                contact.k.friction = lanes(std::pow(10, random.uniform(-3, 1)));
                double overlap = 0;
                for (int s = 0; s < 300; ++s) {
                    const double change = random.uniform(-1e-6, 1.2e-6);
                    overlap = std::max(1e-9, overlap + change);
                    const ForceLanes f =
                        contact.step(overlap, 0.3 * random.direction(), change / contact.dt);
                    // relative to the friction limit times the displacement of a step
                    least =
                        std::min(least, f.work.friction[0] /
                                            (contact.k.friction[0] * f.normal[0] * 3e-6 + 1e-300));
                }
            }
        };
        wander(Linear{});
        wander(HertzMindlin{});
        CHECK(least > -1e-12); // rounding
    }

    TEST_CASE("a spring that keeps its force while the stiffness decreases creates energy") {
        // the reason for rescaling; loaded at constant overlap, then unloaded without sliding
        const auto work_of_unloading = [](ShearHistory history) {
            Contact<HertzMindlin> contact;
            contact.policy.shear_history = history;
            contact.k.friction = lanes(1e9);
            contact.step(1e-4, Vec3::Zero());
            contact.step(1e-4, Vec3(0.1, 0, 0));
            double sum = 0;
            for (int s = 1; s <= 50; ++s)
                sum += contact.step(1e-4 * (1 - s / 100.0), Vec3::Zero()).work.friction[0];
            return sum;
        };
        CHECK(work_of_unloading(ShearHistory::rescaled) > 0);
        CHECK(work_of_unloading(ShearHistory::incremental) < 0);
    }

    TEST_CASE("spring and dashpot of a contact that sticks never exceed Coulomb's limit together") {
        Contact<LinearViscous> contact;
        contact.k.shear_rate = lanes(5e5); // 500 N at 1 cm/s and 0.1 kg
        const double limit = 0.5 * 1e9 * 1e-6;
        for (int n = 1; n <= 5; ++n) { // the spring alone takes 80 N more in each step
            const ForceLanes f = contact.step(1e-6, Vec3(0.006, 0.008, 0));
            CHECK(f.normal[0] == about(1e9 * 1e-6).epsilon(1e-12));
            CHECK(std::hypot(f.x[0], f.y[0]) == about(limit).epsilon(1e-12));
            CHECK(std::hypot(contact.spring.x[0], contact.spring.y[0]) ==
                  about(n * 0.01 * contact.dt).epsilon(1e-12));
        }
        // across the spring the dashpot has less room than the limit
        const ForceLanes f = contact.step(1e-6, Vec3(-0.008, 0.006, 0));
        CHECK(std::hypot(f.x[0], f.y[0]) == about(limit).epsilon(1e-12));
    }

    TEST_CASE("a contact whose overlap rounding has left at zero keeps no history that new lists "
              "would forget") {
        Contact<HertzMindlinRolling> contact;
        (void)contact.step(0, Vec3(0.3, 0.1, 0), 0, Vec3(5, -3, 2));
        CHECK(double{contact.spring.stiffness[0]} == 0);
        CHECK(double{contact.spring.x[0]} == 0);
        CHECK(double{contact.spring.y[0]} == 0);
        CHECK(double{contact.roll.x[0]} == 0);
        CHECK(double{contact.roll.twist[0]} == 0);
        (void)contact.step(1e-5, Vec3(0.3, 0.1, 0), 0, Vec3(5, -3, 2));
        CHECK(double{contact.spring.x[0]} != 0);
        CHECK(double{contact.roll.x[0]} != 0);
    }

    TEST_CASE("rolling and twisting have their own limits and histories") {
        Contact<LinearRolling> contact;
        ForceLanes f{};
        for (int s = 0; s < 1000; ++s) f = contact.step(1e-5, Vec3::Zero(), 0, Vec3(100, 0, 100));
        const double most = 0.1 * 0.005 * 1e9 * 1e-5; // friction times R* times normal force
        CHECK(double{f.torque_x[0]} == about(-most).epsilon(1e-12));
        CHECK(double{f.torque_z[0]} == about(-most).epsilon(1e-12));
        CHECK(double{f.work.rolling[0]} == about(2 * most * 100 * 1e-5).epsilon(1e-9));
    }

    TEST_CASE(
        "a normal force that is cut off at zero is never attractive, and one that is not may be") {
        for (const bool cut : {true, false}) {
            Contact<LinearViscous> contact;
            contact.policy.tension = cut ? Tension::cut : Tension::allowed;
            contact.k.normal_ratio = lanes(0.5);
            const double force = contact.step(1e-8, Vec3::Zero(), -1).z[0];
            CHECK(cut == (force == 0));
            CHECK((cut || force < 0));
        }
    }
}
