#include "engine/errors.hpp"
#include "scenarios/specimens/check_scene.hpp"
#include "tests/support.hpp"

#include <doctest/doctest.h>

#include <functional>
#include <limits>

using namespace bris;
using namespace bris::testing;

namespace {

/// Message of check_scene for two spheres above a floor after `change`; empty if it accepts the
/// scene.
std::string said(LawName law, const std::function<void(World&)>& change) {
    World world = make_world(Grains::spheres);
    Material m = linear_material(1e5, 5e4, 0.5);
    m.young_modulus = 1e9;
    m.poisson_ratio = 0.25;
    const auto grain = add_material(world, m);
    add_sphere(world, Vec3(0, 0, 0.02), 0.01, grain);
    add_sphere(world, Vec3(0.1, 0, 0.02), 0.01, grain);
    add_floor(world, grain);
    change(world);
    world.resource<Materials>().mix();
    try {
        check_scene(world, law);
    } catch (const InputError& error) {
        return error.what();
    }
    return "";
}

/// Message of check_overlaps for two spheres whose centres are `apart` radii from each other and
/// `high` radii above a boundary; empty if it accepts the scene.
std::string said_of_start(double apart, double high, bool facets) {
    World world = make_world(Grains::spheres);
    const auto grain = add_material(world, linear_material(1e5, 5e4, 0.5));
    add_sphere(world, Vec3(0, 0, 0.01 * high), 0.01, grain);
    add_sphere(world, Vec3(0.01 * apart, 0, 0.01 * high), 0.01, grain);
    if (facets)
        add_facet_floor(world, -0.1, 0.1, 2, grain);
    else
        add_floor(world, grain);
    add_lists(world, LawName::linear);
    try {
        check_overlaps(world);
    } catch (const InputError& error) {
        return error.what();
    }
    return "";
}

} // namespace

TEST_SUITE("specimens/check_scene") {
    TEST_CASE("a valid scene is accepted with every contact law") {
        for (const LawName law : {LawName::linear, LawName::linear_viscous, LawName::linear_rolling,
                                  LawName::hertz_mindlin, LawName::hertz_mindlin_rolling})
            CHECK(said(law, [](World&) {}) == "");
    }

    TEST_CASE("conical damage that would create energy is refused with both materials and both "
              "numbers, under that law only") {
        const auto with_angle = [](LawName law, double degrees) {
            return said(law, [=](World& w) {
                Material& m = w.resource<Materials>().list[0];
                m.young_modulus = 1e10;
                m.poisson_ratio = 0.2;
                m.contact_strength = 6e7;
                m.cone_half_angle = degrees * pi / 180;
                w.resource<Materials>().mix();
            });
        };
        CHECK(with_angle(LawName::hertz_edges, 89) == "");
        CHECK(with_angle(LawName::hertz_edges, 89.5) ==
              "materials 'grain' and 'grain': conical damage: expected (pi strength / (2 E*))^2 "
              "below 5 (1 - sin a) / sin a of the cone's half-angle a, as the contact would create "
              "energy otherwise, found 0.000327 and 0.00019");
        CHECK(with_angle(LawName::hertz_mindlin, 89.5) == "");
    }

    TEST_CASE("coefficients that one law reads of a pair are refused like those of a material, "
              "under that law only") {
        const auto with_angle = [](LawName law, double angle) {
            return said(law, [=](World& w) {
                w.resource<Materials>().set_own(LawName::linear_bridge, 0, 0, {0.07, angle, 1e-12});
            });
        };
        CHECK(with_angle(LawName::linear_bridge, 0.5) == "");
        CHECK(
            with_angle(LawName::linear_bridge, 2) ==
            "materials 'grain' and 'grain': contact angle: expected from 0 to 0.872665 rad, found "
            "2 rad");
        CHECK(with_angle(LawName::linear, 2) == "");
    }

    TEST_CASE("an unphysical material is refused with its name, the expected range and the value") {
        const auto with = [](double Material::*member, double value) {
            return said(LawName::linear,
                        [=](World& w) { w.resource<Materials>().list[0].*member = value; });
        };
        CHECK(with(&Material::restitution, 1.2) ==
              "material 'grain': restitution: expected from 0 to 1, found 1.2");
        CHECK(with(&Material::poisson_ratio, 0.6) ==
              "material 'grain': Poisson's ratio: expected above -1 to 0.5, found 0.6");
        CHECK(with(&Material::friction, -0.1) ==
              "material 'grain': friction: expected at least 0, found -0.1");
        CHECK(with(&Material::normal_stiffness, 0) ==
              "material 'grain': normal stiffness: expected above 0 N/m, found 0 N/m");
        CHECK(with(&Material::density, std::numeric_limits<double>::quiet_NaN()).find("density") !=
              std::string::npos);
    }

    TEST_CASE("a contact law requires only the material properties that it uses") {
        const auto without_modulus = [](World& w) {
            w.resource<Materials>().list[0].young_modulus = 0;
        };
        const auto without_stiffness = [](World& w) {
            w.resource<Materials>().list[0].normal_stiffness = 0;
        };
        CHECK(said(LawName::linear, without_modulus) == "");
        CHECK(said(LawName::hertz_mindlin, without_modulus)
                  .find("Young's modulus: expected above 0 Pa, found 0 Pa") != std::string::npos);
        CHECK(said(LawName::hertz_mindlin, without_stiffness) == "");
        CHECK(said(LawName::linear, without_stiffness) != "");
    }

    TEST_CASE("properties given for a pair of materials are checked too") {
        CHECK(said(LawName::linear, [](World& w) {
                  w.resource<Materials>().set_pair(0, 0, {.friction = -1});
              }) == "materials 'grain' and 'grain': friction: expected at least 0, found -1");
        CHECK(said(LawName::linear, [](World& w) {
                  w.resource<Materials>().set_pair(0, 0, {.restitution = 1.2});
              }) == "materials 'grain' and 'grain': restitution: expected from 0 to 1, found 1.2");
    }

    TEST_CASE("restitution 0 is refused under calibrated tension, where no dashpot can give it") {
        const auto with = [](Tension tension, double restitution) {
            return said(LawName::linear_viscous, [=](World& w) {
                w.resource<Materials>().policy.tension = tension;
                w.resource<Materials>().list[0].restitution = restitution;
            });
        };
        for (const Tension tension : {Tension::allowed, Tension::cut})
            CHECK(with(tension, 0) == "");
        CHECK(with(Tension::calibrated, 1e-6) == "");
        CHECK(with(Tension::calibrated, 0) == "materials 'grain' and 'grain': restitution under "
                                              "calibrated tension: expected above 0 to 1, found 0");
    }

    TEST_CASE("a free body without mass or inertia is refused, while a boundary needs neither") {
        CHECK(said(LawName::linear, [](World& w) { value_of<Mass>(w, 1) = 0; }) ==
              "body 1: mass: expected above 0 kg, found 0 kg");
        CHECK(said(LawName::linear, [](World& w) { value_of<SphereInertia>(w, 0) = 0; }) ==
              "body 0: inertia: expected above 0 kg m2, found 0 kg m2");
        CHECK(said(LawName::linear, [](World& w) { value_of<Mass>(w, 2) = 0; }) == "");
    }

    TEST_CASE("a start is refused if spheres overlap by more than the limit or have the same "
              "centre") {
        CHECK(said_of_start(2.5, 2, false) == "");
        CHECK(said_of_start(1.76, 2, false) == ""); // 0.24 of the mean radius
        const std::string deep = said_of_start(1.7, 2, false);
        CAPTURE(deep);
        CHECK(deep.find("bodies 0 and 1: overlap at the start: expected at most 0.25 of the mean "
                        "radius, found 0.3 (0.003 m)") != std::string::npos);
        CHECK(said_of_start(0, 2, false).find("found 2 (0.02 m)") != std::string::npos);
    }

    TEST_CASE("a start is refused if a sphere overlaps a plane or a facet by more than the limit") {
        for (const bool facets : {false, true}) {
            CHECK(said_of_start(3, 0.76, facets) == "");
            CHECK(said_of_start(3, 0.7, facets).find("found 0.3") != std::string::npos);
        }
    }

    TEST_CASE("checking the start for overlaps changes no bit of the run") {
        const auto state = [](bool looked) {
            World world = bed({.bodies = 40});
            add_lists(world, LawName::linear_viscous);
            if (looked) check_overlaps(world);
            world.resource<Clock>().dt = 2e-5;
            Simulation sim(std::move(world), steps(LawName::linear_viscous));
            sim.advance(500);
            return fingerprint(sim.snapshot());
        };
        CHECK(state(true) == state(false));
    }
}
