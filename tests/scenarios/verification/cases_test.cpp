#include "scenarios/verification/cases.hpp"

#include <doctest/doctest.h>

using namespace bris;

namespace {

/// Every number of a group is within its tolerance.
void check_all(const char* group) {
    const std::vector<Check> checks = verify(group);
    REQUIRE(!checks.empty());
    for (const Check& c : checks)
        CHECK_MESSAGE(c.passes(), c.quantity, ": expected ", c.expected, ", found ", c.found,
                      ", error ", c.error(), ", tolerance ", c.tolerance);
}

} // namespace

TEST_SUITE("verification/cases") {
    TEST_CASE("elastic impacts follow Hertz in overlap, force and time, and keep momentum") {
        check_all("elastic_impact");
    }
    TEST_CASE("force and contact time grow and shrink with speed as Hertz says") {
        check_all("impact_scaling");
    }
    TEST_CASE("restitution is the one asked for, under all three policies of tension") {
        check_all("restitution");
    }
    TEST_CASE("oblique impacts rebound and spin as published, and as the law in fine steps") {
        check_all("oblique_impact");
    }
    TEST_CASE("a sphere that slips at a given normal speed leaves as published") {
        check_all("slip_impact");
    }
    TEST_CASE("spinning spheres rebound as published, and a heavy stiff partner is a wall") {
        check_all("spinning_impact");
    }
    TEST_CASE("tangential springs have the known energy defect, and the rescaled one never gives "
              "energy") {
        check_all("energy_defect");
    }
    TEST_CASE("a plane cut into facets is the same plane, on edges and vertices too") {
        check_all("surfaces");
    }
    TEST_CASE("a bouncing ball touches, leaves and rises as the closed form says") {
        check_all("bouncing");
    }
    TEST_CASE("two spheres pressed between floor and lid follow the matrix exponential") {
        check_all("stack");
    }
    TEST_CASE("slip turns to rolling, and rolling friction brakes, as the closed forms say") {
        check_all("rolling");
    }
    TEST_CASE("many impacts in one scene are those of each alone") { check_all("array"); }
    TEST_CASE("local damping slows a fall and a rebound by the closed forms") {
        check_all("local_damping");
    }
    TEST_CASE("a torque-free top follows Jacobi's solution") { check_all("top"); }
    TEST_CASE("a compound pendulum has the period of the elliptic integral") {
        check_all("pendulum");
    }
    TEST_CASE("overlapping balls have the volume and moments of their union") {
        check_all("mass_properties");
    }
    TEST_CASE("chains of beads have their dispersion and Nesterenko's wave") {
        check_all("chains");
    }
    TEST_CASE("crystals have the moduli of their lattices") { check_all("crystals"); }
    TEST_CASE("long waves run through crystals at the root of modulus over density") {
        check_all("waves");
    }
    TEST_CASE("steps are stable up to the limits of lattices and pairs, and no further") {
        check_all("stability");
    }
    TEST_CASE("a contact's shear loop, rigid turns and torques are exact") {
        check_all("contact_pair");
    }
    TEST_CASE("a gas keeps its energy, and what stiffens in contact gives what it must") {
        check_all("energy");
    }
    TEST_CASE("a gas that loses energy cools as Haff says") { check_all("cooling"); }
    TEST_CASE("what has come to rest stays, and carries its weight") { check_all("rest"); }
    TEST_CASE("physics is the same in another frame, unit, order or number of threads") {
        check_all("descriptions");
    }
}
