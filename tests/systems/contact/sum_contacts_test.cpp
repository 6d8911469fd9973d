#include "components/force_sums.hpp"
#include "engine/errors.hpp"
#include "systems/output/contact_list.hpp"
#include "systems/output/quantities.hpp"
#include "tests/about.hpp"
#include "tests/extreme_scenes.hpp"
#include "tests/support.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <cstdlib>

using namespace bris;
using namespace bris::testing;

namespace {

/// Sum of the contact forces on all bodies, in units of the grid.
std::array<std::int64_t, 3> sum_of_forces(const World& world) {
    const double unit = world.resource<ForceGrid>().force;
    std::array<std::int64_t, 3> sum{};
    for (const Vec3& force : world.column<Bodies, Force>())
        for (int i = 0; i < 3; ++i) {
            const double units = force[i] / unit;
            REQUIRE(std::abs(units) < 0x1p53); // so that the conversion to N was exact
            REQUIRE(units == std::round(units));
            sum[static_cast<std::size_t>(i)] += static_cast<std::int64_t>(units);
        }
    return sum;
}

/// A ball of ten grain radii in contact with `grains` grains of a soft material with dashpots, each
/// with an overlap of 2 % of its radius. The ball moves down at `speed` (m/s).
World ball_among_grains(unsigned grains, double stiffness, double speed) {
    constexpr double ball = 0.08, grain = 0.008, distance = ball + 0.98 * grain;
    World world = make_world(Grains::spheres);
    world.add_resource<Gravity>({Vec3::Zero()});
    Material soft = linear_material(2 * stiffness, 0, 0, 2700);
    soft.restitution = 0.05;
    const auto material = add_material(world, soft);
    value_of<Velocity>(world, add_sphere(world, Vec3::Zero(), ball, material)) = Vec3(0, 0, -speed);
    for (unsigned k = 0; k < grains; ++k) {
        const double z = -(k + 0.5) / grains, across = std::sqrt(1 - z * z),
                     turn = pi * (3 - std::sqrt(5.0)) * k;
        add_sphere(world, distance * Vec3(across * std::cos(turn), across * std::sin(turn), z),
                   grain, material);
    }
    return world;
}

Vec3 momentum_of(const World& world) {
    Vec3 sum = Vec3::Zero();
    for (Row b = 0; b < world.table<Bodies>().size(); ++b)
        sum += world.column<Bodies, Mass>()[b] * world.column<Bodies, Velocity>()[b];
    return sum;
}

/// Largest difference between the force on a body and the sum of its contacts, which are recorded
/// as floating-point numbers; relative to the sum of their magnitudes, or one unit if it is less.
double error_of_forces(const World& world) {
    std::vector<Vec3> sum(world.table<Bodies>().size(), Vec3::Zero());
    std::vector<double> size(sum.size(), 0), count(sum.size(), 0);
    for (const Contact& c : contacts_of(world))
        for (const bool of_owner : {true, false}) {
            const Row b = row_of_body(world, of_owner ? c.owner : c.partner);
            sum[b] += of_owner ? c.force : -c.force;
            size[b] += c.force.norm();
            ++count[b];
        }
    double largest = 0;
    for (Row b = 0; b < sum.size(); ++b) {
        const double scale = size[b] + 1e12 * count[b] * world.resource<ForceGrid>().force;
        if (scale > 0)
            largest = std::max(largest, (world.column<Bodies, Force>()[b] - sum[b]).norm() / scale);
    }
    return largest;
}

/// Sum of the contact forces on all bodies, which cancel; relative as in error_of_forces.
double total_force(const World& world) {
    Vec3 sum = Vec3::Zero();
    double size = 0;
    for (const Vec3& force : world.column<Bodies, Force>()) {
        sum += force;
        size += force.norm() + 1e12 * world.resource<ForceGrid>().force;
    }
    return sum.norm() / size;
}

bool is_finite(const World& world) {
    for (const Vec3& x : world.column<Bodies, Position>())
        if (!x.allFinite()) return false;
    for (const Vec3& v : world.column<Bodies, Velocity>())
        if (!v.allFinite()) return false;
    return true;
}

bool has(const std::string& text, const char* part) { return text.find(part) != std::string::npos; }

struct Outcomes {
    unsigned done = 0, contact = 0, sum = 0, other = 0;
};
/// Runs extreme scenes: in each step every force is the sum of the contacts of its body, or the run
/// stops in that step, with one line, before anything has moved by such a sum.
Outcomes run_extreme_scenes(unsigned scenes) {
    Outcomes outcomes;
    for (unsigned k = 0; k < scenes; ++k) {
        CAPTURE(k);
        ExtremeScene scene = extreme_scene(k);
        Simulation sim = begin(std::move(scene.world), scene.settings);
        std::string stopped;
        for (std::uint64_t step = 1; step <= scene.steps && stopped.empty(); ++step) {
            stopped = refusal_of([&] { sim.advance(); });
            if (!stopped.empty()) {
                CHECK(stopped.starts_with("step " + std::to_string(step) + ", "));
                break;
            }
            // later steps also correct contacts that have ended, which are on no list
            if (step == 1) REQUIRE(error_of_forces(sim.world()) < 1e-12);
            REQUIRE(total_force(sim.world()) < 1e-12);
        }
        CAPTURE(stopped);
        CHECK(!has(stopped, "(nan"));
        CHECK(!has(stopped, "\n"));
        const bool contact = has(stopped, "contact of bodies"),
                   sum = has(stopped, "contact forces on body");
        if (contact || sum) CHECK(is_finite(sim.world()));
        ++(stopped.empty() ? outcomes.done
           : contact       ? outcomes.contact
           : sum           ? outcomes.sum
                           : outcomes.other);
    }
    return outcomes;
}

} // namespace

TEST_SUITE("contact/sum_contacts") {
    TEST_CASE("the contact forces on all bodies and boundaries cancel exactly") {
        for (const Grains grains : {Grains::spheres, Grains::clumps})
            for (const Walls walls : {Walls::planes, Walls::facets}) {
                World world = bed({.grains = grains, .walls = walls, .bodies = 60, .seed = 5});
                world.resource<Gravity>().value = Vec3::Zero();
                for (Vec3& v : world.column<Bodies, Velocity>()) v = Vec3::Zero();
                const auto velocity = world.column<Bodies, Velocity>();
                const auto motion = world.column<Bodies, MotionOf>();
                for (Row b = 0; b < velocity.size(); ++b)
                    if (motion[b] == static_cast<std::uint32_t>(Motion::free))
                        velocity[b] = 0.5 * Random(9, b).direction();
                Simulation sim =
                    begin(std::move(world), {.dt = 2e-5, .law = LawName::linear_viscous});
                std::size_t contacts = 0;
                for (int k = 0; k < 40; ++k) {
                    sim.advance(25);
                    contacts += compute_quantities(sim.world()).contacts;
                    CHECK(sum_of_forces(sim.world()) == std::array<std::int64_t, 3>{});
                }
                CHECK(contacts > 20);
            }
    }

    TEST_CASE(
        "the momentum of colliding grains without boundaries stays constant to the round-off of "
        "their own updates") {
        constexpr EntityId count = 64;
        constexpr double radius = 0.01;
        World world = make_world(Grains::spheres);
        const auto material = add_material(world, linear_material(1e5, 5e4, 0.5));
        for (EntityId k = 0; k < count; ++k) {
            const Vec3 x = 2.3 * radius * Vec3(k % 4, k / 4 % 4, k / 16);
            add_sphere(world, x, radius * Random(3, k).uniform(0.7, 1), material);
            // towards the middle, and to one side
            value_of<Velocity>(world, k) =
                10 * (Vec3::Constant(3.45 * radius) - x) + Vec3(0.3, 0, 0);
        }
        Simulation sim = begin(std::move(world), {.dt = 1e-5, .law = LawName::linear});
        const auto momentum = [&] {
            Vec3 sum = Vec3::Zero();
            double size = 0;
            for (EntityId k = 0; k < count; ++k) {
                const Vec3 one = value_of<Mass>(sim, k) * value_of<Velocity>(sim, k);
                sum += one;
                size += one.norm();
            }
            return std::pair(sum, size);
        };
        sim.advance();
        const auto [before, size] = momentum();
        std::size_t contacts = 0;
        for (int k = 0; k < 20; ++k) {
            sim.advance(200);
            contacts += compute_quantities(sim.world()).contacts;
        }
        REQUIRE(contacts > 50);
        // 4000 updates of each velocity, each rounded to 2^-53
        CHECK((momentum().first - before).norm() < 4000 * 0x1p-53 * size);
    }

    TEST_CASE("rough grains without boundaries keep their angular momentum, also across the chunks "
              "in which contacts are computed") {
        constexpr EntityId count = 512;
        constexpr double radius = 0.01;
        World world = make_world(Grains::spheres);
        const auto material = add_material(world, linear_material(1e5, 5e4, 0.5));
        for (EntityId k = 0; k < count; ++k) {
            const Vec3 x = 2.05 * radius * Vec3(k % 8, k / 8 % 8, k / 64);
            add_sphere(world, x, radius * Random(3, k).uniform(0.9, 1), material);
            value_of<Velocity>(world, k) = 15 * (Vec3::Constant(7.2 * radius) - x);
            set_angular_velocity(world, k, 50 * Random(4, k).direction());
        }
        Simulation sim =
            begin(std::move(world), {.dt = 1e-5, .law = LawName::linear, .threads = 2});
        const auto momentum = [&] {
            Vec3 sum = Vec3::Zero();
            double size = 0;
            for (EntityId k = 0; k < count; ++k) {
                const Vec3 orbit = value_of<Position>(sim, k).cross(value_of<Mass>(sim, k) *
                                                                    value_of<Velocity>(sim, k)),
                           spin = value_of<AngularMomentum>(sim, k);
                sum += orbit + spin;
                size += orbit.norm() + spin.norm();
            }
            return std::pair(sum, size);
        };
        sim.advance();
        const auto [before, size] = momentum();
        std::size_t contacts = 0, chunks = 0;
        for (int k = 0; k < 20; ++k) {
            sim.advance(50);
            contacts += compute_quantities(sim.world()).contacts;
            chunks = std::max(chunks, sim.world().resource<NearIndex<SpherePairs>>().chunks.size());
        }
        REQUIRE(contacts > 1000);
        REQUIRE(chunks > 1);
        CHECK((momentum().first - before).norm() < 1000 * 0x1p-53 * size);
    }

    TEST_CASE("a sphere on a floor exerts its force on the floor at the point of contact") {
        constexpr double radius = 0.01, overlap = 1e-5, kn = 1e5;
        World world = make_world(Grains::spheres);
        const auto material = add_material(world, linear_material(kn));
        const EntityId floor = add_floor(world, material);
        add_sphere(world, Vec3(0.3, -0.2, radius - overlap), radius, material);
        Simulation sim = begin(std::move(world), {.dt = 1e-9, .law = LawName::linear_frictionless});
        sim.advance();
        const Vec3 force = value_of<Force>(sim, floor), torque = value_of<Torque>(sim, floor);
        CHECK(force.z() == about(-kn * overlap).epsilon(1e-9));
        CHECK((torque - Vec3(0.3, -0.2, 0).cross(force)).norm() < 1e-9 * force.norm());
        CHECK(torque.norm() > 0.3 * force.norm());
    }

    TEST_CASE("the units resolve the force of a contact at the limit of overlap to 2^-54, whatever "
              "the material and size") {
        for (const double stiffness : {1e2, 1e5, 1e9})
            for (const double radius : {1e-4, 0.02, 3.0}) {
                World world = make_world(Grains::spheres);
                const auto material = add_material(world, linear_material(stiffness));
                add_sphere(world, Vec3(0, 0, 0), radius, material);
                add_sphere(world, Vec3(0, 0, 1.9 * radius), radius, material);
                Simulation sim =
                    begin(std::move(world), {.dt = 1e-9, .law = LawName::linear_frictionless});
                sim.advance();
                const double force = value_of<Force>(sim, 1).z();
                CHECK(force == about(stiffness * 0.1 * radius).epsilon(1e-12));
                const double limit = stiffness * Limits{}.overlap * radius,
                             unit = sim.world().resource<ForceGrid>().force;
                CHECK(unit <= limit * 0x1p-54);
                CHECK(unit > limit * 0x1p-56);
            }
    }

    TEST_CASE("a rigid boundary does not make the units coarser than those of real contacts") {
        const auto unit = [](double stiffness_of_wall) {
            World world = make_world(Grains::spheres);
            const auto grain = add_material(world, linear_material(1e5)),
                       wall = add_material(world, linear_material(stiffness_of_wall));
            add_sphere(world, Vec3(0, 0, 0.02), 0.01, grain);
            add_floor(world, wall);
            Simulation sim = begin(std::move(world), {.law = LawName::linear_frictionless});
            sim.advance();
            return sim.world().resource<ForceGrid>().force;
        };
        CHECK(unit(1e30) <= 2 * unit(1e5));
    }

    TEST_CASE("a contact force beyond the range of the sums stops the run with the bodies' ids") {
        World world = make_world(Grains::spheres);
        Material m = linear_material(1e5);
        m.restitution = 0.1;
        const auto material = add_material(world, m);
        add_sphere(world, Vec3(0, 0, 0), 0.01, material);
        add_sphere(world, Vec3(0, 0, 0.0199999), 0.01, material);
        value_of<Velocity>(world, 1) = Vec3(0, 0, -1e5);
        Simulation sim = begin(std::move(world),
                               {.dt = 1e-13, .law = LawName::linear_viscous, .unlimited = true});
        const std::string text = refusal_of([&] { sim.advance(10); });
        CAPTURE(text);
        CHECK(has(text, "step 1, "));
        CHECK(has(text, "contact of bodies 0 and 1: expected force and torques that add to at most "
                        "3.277e+04 N"));
        CHECK(has(text, "its dashpot is too strong for such speeds"));
        CHECK((value_of<Velocity>(sim, 1) == Vec3(0, 0, -1e5))); // nobody has felt it
    }

    TEST_CASE("a fast ball among soft grains with dashpots keeps the momentum, or stops the run in "
              "that step with body, sum, limit and cause") {
        unsigned kept = 0, stopped = 0;
        for (const double stiffness : {1e2, 1e3, 1e4})
            for (const double speed :
                 {0.5, 2.0, 5.0, 10.0, 18.0, 20.0, 22.0, 25.0, 30.0, 50.0, 100.0, 200.0, 400.0})
                for (const unsigned grains : {60u, 100u, 110u, 120u, 140u}) {
                    CAPTURE(stiffness);
                    CAPTURE(speed);
                    CAPTURE(grains);
                    Simulation sim = begin(ball_among_grains(grains, stiffness, speed),
                                           {.dt = 1e-7, .law = LawName::linear_viscous});
                    const Vec3 before = momentum_of(sim.world());
                    const std::string text = refusal_of([&] { sim.advance(); });
                    if (text.empty()) {
                        ++kept;
                        CHECK(error_of_forces(sim.world()) < 1e-12);
                        CHECK((momentum_of(sim.world()) - before).norm() < 1e-15 * before.norm());
                        continue;
                    }
                    ++stopped;
                    CAPTURE(text);
                    CHECK(has(text, "step 1, time 1e-07 s: contact"));
                    if (stiffness == 1e2 && speed > 10) {
                        const bool by_dashpots = has(text, "their dashpots are too strong") ||
                                                 has(text, "its dashpot is too strong");
                        CHECK(by_dashpots);
                    }
                    if (!has(text, "contact of bodies 0 and")) {
                        CHECK(has(text, "contact forces on body 0: expected magnitudes that add to "
                                        "at most "));
                        CHECK(has(text, (" in " + std::to_string(grains) + " contacts").c_str()));
                    }
                    CHECK(is_finite(sim.world()));
                    CHECK(refusal_of([&] { sim.advance(); }) == text); // and it stays stopped
                }
        CHECK(kept > 20);
        CHECK(stopped > 20);
    }

    TEST_CASE("the run stops where the magnitudes of four hundred contacts are beyond the grid, "
              "also if their sum is not, whatever chunks they are computed in") {
        for (const bool ball_is_last : {false, true})
            for (const unsigned threads : {1u, 2u}) {
                World world = make_world(Grains::spheres);
                const auto material = add_material(world, linear_material(1e5));
                const auto add_ball = [&] { add_sphere(world, Vec3::Zero(), 0.1, material); };
                if (!ball_is_last) add_ball();
                for (int k = 0; k < 400; ++k) { // on opposite sides, deep in the ball
                    const double z = (k / 2 + 0.5) / 200, across = std::sqrt(1 - z * z),
                                 turn = pi * (3 - std::sqrt(5.0)) * (k / 2);
                    add_sphere(world,
                               (k % 2 == 0 ? 0.05 : -0.05) *
                                   Vec3(across * std::cos(turn), across * std::sin(turn), z),
                               0.001, material);
                }
                if (ball_is_last) add_ball();
                Simulation sim = begin(std::move(world), {.dt = 1e-9,
                                                          .law = LawName::linear_frictionless,
                                                          .threads = threads,
                                                          .unlimited = true});
                const std::string text = refusal_of([&] { sim.advance(); });
                CAPTURE(text);
                CHECK(has(text, ball_is_last ? "contact forces on body 400: expected magnitudes"
                                             : "contact forces on body 0: expected magnitudes"));
                CHECK(has(text, "N in 400 contacts, "));
                CHECK(has(text, ": there are too many"));
                if (threads > 1 && ball_is_last)
                    CHECK(sim.world().resource<NearIndex<SpherePairs>>().chunks.size() > 1);
            }
    }

    TEST_CASE("the contacts of a boundary are added exactly, or stop the run where a part of them "
              "is beyond the grid") {
        constexpr unsigned grains = 200;
        for (const double overlap : {0.01, 0.1, 0.9, 1.9}) { // over the radius
            CAPTURE(overlap);
            World world = make_world(Grains::spheres);
            const auto material = add_material(world, linear_material(1e5));
            const EntityId floor = add_floor(world, material);
            for (unsigned k = 0; k < grains; ++k)
                add_sphere(world, Vec3(0.03 * k, 0, (1 - overlap) * 0.01), 0.01, material);
            Simulation sim =
                begin(std::move(world),
                      {.dt = 1e-9, .law = LawName::linear_frictionless, .unlimited = true});
            const std::string text = refusal_of([&] { sim.advance(); });
            CAPTURE(text);
            if (overlap < 1) {
                CHECK(text.empty());
                CHECK(value_of<Force>(sim, floor).z() ==
                      about(-1e5 * overlap * 0.01 * grains).epsilon(1e-12));
            } else {
                CHECK(has(text, "contact forces on body 0: expected magnitudes that add to at "
                                "most"));
                CHECK(has(text, "on a part of it"));
                CHECK(has(text, "it has 200 contacts"));
            }
        }
    }

    TEST_CASE("dashpots may be as strong as they are at the speed at which the limit of overlap "
              "stops a pair") {
        for (const double rate : {1e3, 1e6, 1e9}) {
            CAPTURE(rate);
            World world = make_world(Grains::spheres);
            Material m = linear_material(1e5);
            m.normal_damping = rate;
            const auto material = add_material(world, m);
            add_sphere(world, Vec3(0, 0, 0), 0.01, material);
            add_sphere(world, Vec3(0, 0, 0.0199999), 0.01, material);
            const double overlap = world.resource<Limits>().overlap * 0.01,
                         mass = value_of<Mass>(world, 1), reduced = mass / 2,
                         speed =
                             std::min(overlap * std::max(rate, std::sqrt(1e5 / reduced)), 999.0);
            value_of<Velocity>(world, 1) = Vec3(0, 0, -speed);
            Simulation sim = begin(std::move(world), {.dt = 1e-14, .law = LawName::linear_viscous});
            CHECK(refusal_of([&] { sim.advance(); }) == "");
            CHECK(value_of<Force>(sim, 1).z() == about(rate * reduced * speed).epsilon(1e-3));
            CHECK((value_of<Force>(sim, 0) == -value_of<Force>(sim, 1)));
        }
    }

    TEST_CASE("random scenes of extreme ratios, stiffnesses, dashpots and speeds have exact forces "
              "or stop in that step") {
        const char* asked = std::getenv("BRIS_RANDOM_SCENES");
        const unsigned scenes = asked != nullptr ? static_cast<unsigned>(std::atoi(asked)) : 600;
        const Outcomes found = run_extreme_scenes(scenes);
        MESSAGE("completed ", found.done, ", stopped by a contact ", found.contact, ", by a sum ",
                found.sum, ", by others ", found.other);
        CHECK(found.done > scenes / 10);
        CHECK(found.contact > scenes / 100);
        CHECK(found.sum > 0);
    }
}

TEST_SUITE("slow") {
    TEST_CASE("10 000 random scenes of extreme ratios have exact forces or stop in that step") {
        const Outcomes found = run_extreme_scenes(10'000);
        CHECK(found.done > 1000);
        CHECK(found.sum > 0);
    }
}
