#include "tests/verification/cases.hpp"

#include "engine/errors.hpp"

#include <array>

namespace bris {

namespace {

constexpr std::array cases{
    VerificationCase{"elastic_impact", "Chung and Ooi (2011), tests 1 and 2; Hertz (1882)",
                     detail::verify_elastic_impacts},
    VerificationCase{"impact_scaling",
                     "Hertz (1882): F ~ v^(6/5), t ~ v^(-1/5); linear spring: t = pi sqrt(m/k)",
                     detail::verify_impact_scaling},
    VerificationCase{"restitution", "Chung and Ooi (2011), test 3; Schwager and Poeschel (2007)",
                     detail::verify_restitution},
    VerificationCase{"phases",
                     "Schwager and Poeschel (2007), eq. 21; Tsuji, Tanaka and Ishida (1992)",
                     detail::verify_phases},
    VerificationCase{
        "oblique_impact",
        "Chung and Ooi (2011), test 4; independent integration of the law in 60 000 steps; "
        "experiment of Kharaz et al. (2001)",
        detail::verify_oblique_impacts},
    VerificationCase{"slip_impact",
                     "Chung and Ooi (2011), test 5; independent integration of the law in 60 000 "
                     "steps",
                     detail::verify_slip_impacts},
    VerificationCase{"spinning_impact", "Chung and Ooi (2011), tests 6 to 8",
                     detail::verify_spinning_impacts},
    VerificationCase{"energy_defect",
                     "independent integration of tangential springs without slip in 60 000 steps",
                     detail::verify_energy_defect},
    VerificationCase{"surfaces", "a plane divided into facets acts as the same plane",
                     detail::verify_surfaces},
    VerificationCase{"bouncing", "Garg et al. (2012), MFiX DEM01 and DEM02, closed forms",
                     detail::verify_bouncing},
    VerificationCase{"stack", "MFiX DEM03, matrix exponential", detail::verify_stack},
    VerificationCase{"rolling", "MFiX DEM04 and rolling on a slope, closed forms",
                     detail::verify_rolling},
    VerificationCase{"array", "MFiX DEM05: impacts in one scene equal the same impacts alone",
                     detail::verify_array},
    VerificationCase{"local_damping", "Cundall (1987), closed forms", detail::verify_local_damping},
    VerificationCase{"top", "Jacobi's solution of Euler's equations", detail::verify_top},
    VerificationCase{"pendulum", "compound pendulum, complete elliptic integral",
                     detail::verify_pendulum},
    VerificationCase{"mass_properties",
                     "two spheres: closed form; thirty spheres: independent quadrature; library: "
                     "integrals over the surface",
                     detail::verify_mass_properties},
    VerificationCase{"chains",
                     "lattice dispersion; Nesterenko's solitary wave, integrated in fine steps",
                     detail::verify_chains},
    VerificationCase{"crystals", "moduli of cubic lattices, closed forms", detail::verify_crystals},
    VerificationCase{"waves", "speed of long waves in a crystal, sqrt(modulus / density)",
                     detail::verify_waves},
    VerificationCase{"stability", "stability limit 2 / omega of the leapfrog, lattice dynamics",
                     detail::verify_stability},
    VerificationCase{"contact_pair", "closed forms of a shear loop, objectivity, torque limits",
                     detail::verify_contact_pair},
    VerificationCase{"liquid_bridge",
                     "Willett et al. (2000), eqs. (12) and (13); rupture: Lian et al. (1993)",
                     detail::verify_liquid_bridge},
    VerificationCase{"energy",
                     "energy conservation in a gas; a spring that stiffens adds 8/15 dE* sqrt(R*) "
                     "overlap^(5/2)",
                     detail::verify_gas},
    VerificationCase{"cooling", "Haff (1983): 1/sqrt(T) of a cooling gas grows linearly in time",
                     detail::verify_cooling},
    VerificationCase{"rest", "statics: bodies at rest stay at rest and carry their weight",
                     detail::verify_rest},
    VerificationCase{"descriptions",
                     "invariance under changes of reference frame, units, numbering and threads",
                     detail::verify_descriptions},
};

} // namespace

std::span<const VerificationCase> verification_cases() { return cases; }

std::vector<Check> verify(const std::string& name) {
    for (const VerificationCase& c : cases)
        if (name == c.name) {
            Checks checks(name);
            c.run(checks);
            return checks.list();
        }
    std::string names;
    for (const VerificationCase& c : cases)
        names += (names.empty() ? "" : ", ") + std::string(c.name);
    throw InputError("case: expected one of " + names + ", found \"" + name + "\"");
}

} // namespace bris
