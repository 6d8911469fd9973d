#include "tests/support.hpp"

#include <doctest/doctest.h>

using namespace bris;
using namespace bris::testing;

namespace {

bool has(const std::string& text, const std::string& part) {
    return text.find(part) != std::string::npos;
}

/// The part that lists the systems that run, and the part that lists those left out.
std::pair<std::string, std::string> parts(const std::string& text) {
    const auto middle = text.find("systems left out:"), end = text.find("digraph");
    REQUIRE(middle != std::string::npos);
    return {text.substr(0, middle), text.substr(middle, end - middle)};
}

} // namespace

TEST_SUITE("invariance/explain") {
    TEST_CASE("a frictionless scene of two spheres runs without springs, facets, planes, servo, "
              "gravity and damping") {
        World world = make_world(Grains::spheres);
        const auto material = add_material(world, linear_material(1e5));
        add_sphere(world, Vec3(0, 0, 0), 0.01, material);
        add_sphere(world, Vec3(0, 0, 0.021), 0.01, material);
        Simulation sim = begin(std::move(world), {.law = LawName::linear_frictionless});
        const auto [runs, left_out] = parts(sim.schedule().explain());
        CAPTURE(runs);
        CAPTURE(left_out);
        for (const char* name : {"collide_spheres", "sum_contacts", "integrate",
                                 "update_sphere_positions", "guard_motion", "rebuild_pairs"}) {
            CAPTURE(name);
            CHECK(has(runs, std::string("\n  ") + name));
        }
        for (const char* what :
             {"spring", "facet", "plane", "membrane", "platen", "gravity", "rotate_clumps."}) {
            CAPTURE(what);
            CHECK_FALSE(has(runs, what));
        }
        for (const char* name :
             {"collide_facets", "collide_planes", "servo_membrane", "servo_platen", "apply_gravity",
              "damp", "update_facets", "update_turned_facets", "update_planes", "guard_facets",
              "rotate_clumps", "apply_loads", "push_patches", "record_motion"}) {
            CAPTURE(name);
            CHECK(has(left_out, std::string("\n  ") + name + ": absent"));
        }
    }

    TEST_CASE(
        "the graph contains the systems that a scene needs, with all body systems in one pass") {
        Simulation sim =
            begin(bed({.grains = Grains::clumps, .walls = Walls::facets, .bodies = 10}), {});
        const auto [runs, left_out] = parts(sim.schedule().explain());
        CHECK(has(runs, "sphere_pairs.spring"));
        CHECK(has(runs, "collide_facets"));
        CHECK(has(runs, "apply_gravity"));
        CHECK(has(left_out, "rotate_spheres: absent"));
        CHECK(has(sim.schedule().explain(), "sum_contacts + apply_gravity + integrate + "
                                            "rotate_clumps + update_clump_positions"));
    }

    TEST_CASE("the kinds of contacts are computed one after another, since they add to one sum") {
        World world = bed({.walls = Walls::facets, .bodies = 10});
        add_floor(world, 1);
        Simulation sim = begin(std::move(world), {});
        const std::string text = sim.schedule().explain();
        const auto after = [&](const std::string& name) {
            const auto at = text.find("\n  " + name + "\n");
            REQUIRE(at != std::string::npos);
            const auto line = text.find("after", at);
            return text.substr(line, text.find('\n', line) - line);
        };
        CHECK(has(after("collide_facets"), "collide_spheres"));
        CHECK(has(after("collide_planes"), "collide_facets"));
    }
}
