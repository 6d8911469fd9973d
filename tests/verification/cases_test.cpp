#include "tests/verification/cases.hpp"

#include <doctest/doctest.h>

using namespace bris;

namespace {

/// Checks that every number of a group is within its tolerance.
void check_all(const char* group) {
    const std::vector<Check> checks = verify(group);
    REQUIRE(!checks.empty());
    for (const Check& c : checks)
        CHECK_MESSAGE(c.passes(), c.quantity, ": expected ", c.expected, ", found ", c.found,
                      ", error ", c.error(), ", tolerance ", c.tolerance);
}

} // namespace

TEST_SUITE("verification/cases") {
    TEST_CASE(
        "overlap, force and time of elastic impacts follow Hertz, and momentum is conserved") {
        check_all("elastic_impact");
    }
    TEST_CASE("force and contact time depend on the impact speed as in Hertz's theory") {
        check_all("impact_scaling");
    }
    TEST_CASE("restitution has its expected value under all three policies of tension") {
        check_all("restitution");
    }
    TEST_CASE("rebound and rotation after oblique impacts agree with published values and with the "
              "law integrated in fine steps") {
        check_all("oblique_impact");
    }
    TEST_CASE("slip after an oblique impact agrees with published values") {
        check_all("slip_impact");
    }
    TEST_CASE("rebounds of spinning spheres agree with published values, and a heavy stiff partner "
              "acts as a wall") {
        check_all("spinning_impact");
    }
    TEST_CASE("tangential springs have the known energy defect, and the rescaled spring never adds "
              "energy") {
        check_all("energy_defect");
    }
    TEST_CASE("a plane divided into facets acts as the same plane, also on edges and vertices") {
        check_all("surfaces");
    }
    TEST_CASE("contact times, speeds and heights of a bouncing sphere follow closed forms") {
        check_all("bouncing");
    }
    TEST_CASE("two spheres compressed between floor and lid follow the matrix exponential") {
        check_all("stack");
    }
    TEST_CASE(
        "the transition from slip to rolling and the effect of rolling friction follow closed "
        "forms") {
        check_all("rolling");
    }
    TEST_CASE("impacts in one scene equal the same impacts alone") { check_all("array"); }
    TEST_CASE("local damping slows falls and rebounds as in closed forms") {
        check_all("local_damping");
    }
    TEST_CASE("a torque-free top follows Jacobi's solution") { check_all("top"); }
    TEST_CASE("a compound pendulum has the period of the elliptic integral") {
        check_all("pendulum");
    }
    TEST_CASE("overlapping spheres have the volume and moments of inertia of their union") {
        check_all("mass_properties");
    }
    TEST_CASE("chains of beads have the dispersion of their lattice and Nesterenko's solitary "
              "wave") {
        check_all("chains");
    }
    TEST_CASE("crystals have the elastic moduli of their lattices") { check_all("crystals"); }
    TEST_CASE("long waves travel through crystals at the square root of modulus over density") {
        check_all("waves");
    }
    TEST_CASE("time steps are stable up to the limits of lattices and pairs, and not beyond") {
        check_all("stability");
    }
    TEST_CASE("shear loop, rigid rotation and torques of a contact are exact") {
        check_all("contact_pair");
    }
    TEST_CASE("a gas conserves its energy, and stiffening during contact adds the exact energy") {
        check_all("energy");
    }
    TEST_CASE("a granular gas cools by Haff's law") { check_all("cooling"); }
    TEST_CASE("bodies at rest stay at rest and carry their weight") { check_all("rest"); }
    TEST_CASE("physics does not depend on reference frame, units, numbering or threads") {
        check_all("descriptions");
    }
    TEST_CASE("a liquid bridge pulls as published, forms at touch, ruptures at its distance, and "
              "costs its work") {
        check_all("liquid_bridge");
    }
}
