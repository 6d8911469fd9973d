#include "engine/errors.hpp"
#include "systems/guard.hpp"
#include "tests/support.hpp"

#include <doctest/doctest.h>

#include <functional>
#include <limits>
#include <utility>

using namespace bris;
using namespace bris::testing;

namespace {

constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();
constexpr double infinity = std::numeric_limits<double>::infinity();

/// Five spheres far apart above a floor.
Simulation five(
    Grains grains, bool facets, const std::function<void(World&)>& change = [](World&) {}) {
    World world = make_world(grains);
    const auto material = add_material(world, linear_material(1e5, 5e4, 0.5));
    for (int k = 0; k < 5; ++k) add_sphere(world, Vec3(0.05 * k, 0, 0.011), 0.01, material);
    if (facets)
        add_facet_floor(world, -0.3, 0.3, 3, material);
    else
        add_floor(world, material);
    change(world);
    return begin(std::move(world), {.dt = 1e-5});
}

std::string message_of(Simulation& sim, std::uint64_t steps) {
    try {
        sim.advance(steps);
    } catch (const SimulationError& e) {
        return e.what();
    }
    return "no error";
}

bool has(const std::string& text, const std::string& part) {
    return text.find(part) != std::string::npos;
}

} // namespace

TEST_SUITE("guard") {
    TEST_CASE("a valid run is not stopped") {
        Simulation sim = five(Grains::spheres, false);
        CHECK(message_of(sim, 200) == "no error");
    }

    TEST_CASE(
        "a position or velocity that is not a number stops the run with body, step and time") {
        for (const Grains grains : {Grains::spheres, Grains::clumps})
            for (const double bad : {not_a_number, infinity, -infinity}) {
                CAPTURE(bad);
                Simulation sim = five(grains, false);
                sim.advance(10);
                value_of<Velocity>(sim, 3).y() = bad;
                const std::string text = message_of(sim, 100);
                CAPTURE(text);
                CHECK(has(text, "body 3"));
                CHECK(has(text, "step 11"));
                CHECK(has(text, "time 0.00011 s"));
                CHECK(text.find('\n') == std::string::npos);

                Simulation other = five(grains, false);
                other.advance(10);
                value_of<Position>(other, 2).x() = bad;
                CHECK(has(message_of(other, 100), "body 2"));
            }
    }

    TEST_CASE("an angular velocity that is not a number stops a run of clumps") {
        Simulation sim = five(Grains::clumps, false);
        sim.advance(10);
        value_of<AngularMomentum>(sim, 1).z() = not_a_number;
        const std::string text = message_of(sim, 100);
        CAPTURE(text);
        CHECK(has(text, "body 1"));
        CHECK(has(text, "step 11"));
    }

    TEST_CASE("a scene that begins with a position that is not a number stops, and does not hang") {
        for (const double bad : {not_a_number, infinity}) {
            Simulation sim =
                five(Grains::spheres, false, [&](World& w) { value_of<Position>(w, 0).x() = bad; });
            const std::string text = message_of(sim, 3);
            CAPTURE(text);
            CHECK(has(text, "body 0"));
        }
    }

    TEST_CASE("a body faster than the limit stops the run") {
        Simulation sim = five(Grains::spheres, false,
                              [](World& w) { value_of<Velocity>(w, 4) = Vec3(0, 1500, 0); });
        const std::string text = message_of(sim, 100);
        CAPTURE(text);
        CHECK(has(text, "body 4"));
        CHECK(has(text, "step 1,"));
        CHECK(has(text, "1500"));
    }

    TEST_CASE("a free body that leaves the box of the scene stops the run; a driven body may be "
              "anywhere") {
        Simulation sim = five(Grains::spheres, false, [](World& w) {
            w.resource<Limits>().low = Vec3(-0.1, -0.1, 0);
            w.resource<Limits>().high = Vec3(0.3, 0.1, 0.3);
            value_of<Velocity>(w, 2) = Vec3(0, 20, 0);
            value_of<MotionOf>(w, 1) = static_cast<std::uint32_t>(Motion::fixed);
            value_of<Position>(w, 1) = Vec3(0, 0, -5);
        });
        const std::string text = message_of(sim, 1000); // 0.1 m at 20 m/s
        CAPTURE(text);
        CHECK(has(text, "body 2"));
        CHECK(has(text, "escaped"));
        CHECK(sim.world().resource<Clock>().step > 490);
        CHECK(sim.world().resource<Clock>().step < 510);
    }

    TEST_CASE("a run that continues from a checkpoint has the box of its scene") {
        Simulation before = five(Grains::spheres, false, [](World& w) {
            w.resource<Limits>().high = Vec3(0.3, 0.1, 0.3);
            value_of<Velocity>(w, 2) = Vec3(0, 20, 0);
        });
        Simulation after = five(Grains::spheres, false);
        after.restore(before.snapshot());
        CHECK(after.world().resource<Limits>().high == Vec3(0.3, 0.1, 0.3));
        CHECK(after.world().resource<Limits>().low.x() == -infinity);
        CHECK(has(message_of(after, 1000), "body 2"));
    }

    TEST_CASE("an angular velocity that is not a number stops a run of single spheres before the "
              "sphere has contacts") {
        Simulation sim = five(Grains::spheres, false);
        sim.advance(10);
        value_of<AngularMomentum>(sim, 1).z() = not_a_number;
        const std::string text = message_of(sim, 100);
        CAPTURE(text);
        CHECK(has(text, "body 1"));
        CHECK(has(text, "step 11"));
    }

    TEST_CASE("a body that could pass through a surface undetected in one step stops the run") {
        // a quarter of 0.01 m in 1e-5 s: 250 m/s
        Simulation sim = five(Grains::spheres, false,
                              [](World& w) { value_of<Velocity>(w, 4) = Vec3(0, 260, 0); });
        const std::string text = message_of(sim, 100);
        CAPTURE(text);
        CHECK(has(text, "body 4"));
        CHECK(has(text, "a displacement up to 0.0025 m in a step, found 0.0026 m"));
        Simulation slower = five(Grains::spheres, false,
                                 [](World& w) { value_of<Velocity>(w, 4) = Vec3(0, 240, 0); });
        CHECK(message_of(slower, 3) == "no error");
    }

    TEST_CASE("a wall that moves farther in a step than the smallest grain allows stops the run") {
        Simulation sim = five(Grains::spheres, true, [](World& w) {
            value_of<MotionOf>(w, 5) = static_cast<std::uint32_t>(Motion::prescribed);
            value_of<DriveVelocity>(w, 5) = Vec3(260, 0, 0);
        });
        CHECK(has(message_of(sim, 100), "body 5"));
    }

    TEST_CASE("the message names two spheres that overlap too deeply") {
        Simulation sim = five(Grains::spheres, false, [](World& w) {
            value_of<Position>(w, 2) = value_of<Position>(w, 1) + Vec3(0.0, 0, 0.016);
        });
        const std::string text = message_of(sim, 100);
        CAPTURE(text);
        CHECK(has(text, "bodies 1 and 2"));
        CHECK(has(text, "step 1,"));
        CHECK(has(text, "expected less than 0.25 of the mean radius (0.0025 m), found 0.4 of it "
                        "(0.004 m)"));
    }

    TEST_CASE("the message names a sphere that is too deep in a plane or facet, and the boundary") {
        for (const bool facets : {false, true}) {
            Simulation sim = five(Grains::spheres, facets,
                                  [](World& w) { value_of<Position>(w, 3).z() = 0.0074; });
            const std::string text = message_of(sim, 100);
            CAPTURE(text);
            CHECK(has(text, "bodies 3 and 5"));
            CHECK(has(text, "found 0.26 of it (0.0026 m)"));
            Simulation just = five(Grains::spheres, facets,
                                   [](World& w) { value_of<Position>(w, 3).z() = 0.0076; });
            CHECK(message_of(just, 1) == "no error"); // a quarter of the radius is allowed
        }
    }

    TEST_CASE("a run that stops within many steps leaves the motion of the step that stopped it") {
        for (const std::string cause : {"escaped", "overlap", "body 40"}) {
            CAPTURE(cause);
            const auto flight = [&](std::uint64_t at_once) {
                World world = make_world(Grains::spheres);
                world.add_resource(Gravity{Vec3(0, 0, -9.81)});
                const auto material = add_material(world, linear_material(1e5, 5e4, 0.5));
                for (int k = 0; k < 40; ++k)
                    add_sphere(world, Vec3(0.019 * k, 0, 0.0099), 0.01, material);
                add_floor(world, material);
                world.resource<Limits>().high = Vec3(10, 0.1, 10);
                if (cause == "escaped") value_of<Velocity>(world, 30) = Vec3(0, 20, 0);
                if (cause == "overlap") value_of<Velocity>(world, 30) = Vec3(100, 0, 0);
                if (cause == "body 40") {
                    value_of<MotionOf>(world, 40) = static_cast<std::uint32_t>(Motion::prescribed);
                    value_of<DriveVelocity>(world, 40) = Vec3(260, 0, 0);
                }
                Simulation sim =
                    begin(std::move(world),
                          {.dt = 1e-5, .law = LawName::linear_viscous, .schedule = {.grain = 16}});
                std::string text = "no error";
                for (std::uint64_t done = 0; done < 1000 && text == "no error"; done += at_once)
                    text = message_of(sim, at_once);
                return std::pair(text, std::move(sim));
            };
            const auto [text, sim] = flight(1000);
            const auto [same_text, same] = flight(1);
            CAPTURE(text);
            CHECK(has(text, cause));
            CHECK(text == same_text);
            CHECK(fingerprint(sim.snapshot()) == fingerprint(same.snapshot()));
        }
    }

    TEST_CASE("a stopped run cannot be continued") {
        Simulation sim = five(Grains::spheres, false,
                              [](World& w) { value_of<Velocity>(w, 4) = Vec3(0, 1500, 0); });
        CHECK_THROWS_AS(sim.advance(100), SimulationError);
        CHECK(sim.world().resource<Clock>().step == 1);
        CHECK_THROWS_AS(sim.advance(100), SimulationError);
        CHECK(sim.world().resource<Clock>().step == 1);
    }
}
