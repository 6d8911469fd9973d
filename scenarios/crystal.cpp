// A crystal of equal spheres: its elastic moduli under pressure, or the largest stable time step of
// its lattice.
#include "scenarios/verification/crystal.hpp"

#include "engine/choice.hpp"
#include "engine/errors.hpp"
#include "engine/scenario.hpp"
#include "engine/summary.hpp"
#include "scenarios/verification/names.hpp"

#include <algorithm>

namespace {

using namespace bris;

Material grain() {
    Material m;
    m.name = "sphere";
    m.density = 2650;
    m.young_modulus = 5e9;
    m.poisson_ratio = 0.25;
    m.normal_stiffness = 2e9;
    m.shear_stiffness = 1e9;
    return m;
}

struct Settings {
    Crystal crystal;
    MaterialOptions material{grain()};
    std::string lattice = "fcc", law = "hertz_mindlin", what = "moduli";
    double friction = 10, shear_ratio = 2.0 / 7;

    void describe(auto& option) {
        option("what", what, "",
               "Quantity to compute: the elastic moduli, or the stability limit of the time step "
               "for linear springs.",
               {"moduli", "stability"});
        option("lattice", lattice, "",
               "Lattice: simple cubic (sc), body-centred cubic (bcc) or face-centred cubic (fcc).",
               lattice_names);
        option.group("Moduli");
        option("law", law, "", "Contact law.", law_choices());
        option("spacing", crystal.spacing, "m",
               "Distance between the centres of neighbouring spheres under pressure.",
               above(0, 1e3));
        option("pressure", crystal.pressure, "Pa", "Isotropic pressure.", above(0, 1e12));
        option("strain", crystal.strain, "",
               "Strain applied in both directions to measure the moduli. It must be far below "
               "overlap over spacing.",
               above(0, 0.1));
        option("friction", friction, "", "Coulomb friction coefficient between spheres.",
               within(0, 1e6));
        material.describe(option, "", "of the spheres");
        option.group("Stability");
        option("shear_ratio", shear_ratio, "", "Ratio of tangential to normal contact stiffness.",
               within(0, 10));
    }
};

Crystal crystal_of(const Settings& s) {
    Crystal crystal = s.crystal;
    crystal.lattice = named<Lattice>(lattice_names, s.lattice);
    crystal.law = law_named(s.law);
    crystal.material = s.material.material;
    crystal.material.friction = s.friction;
    return crystal;
}

Summary moduli(const Crystal& crystal) {
    const CrystalResult r = run_experiment(crystal);
    const double density = crystal.material.density * pi / 6 / cell_volume(crystal.lattice);
    Summary t;
    t.add("contact_force_N", r.contact_force);
    t.add("overlap_m", r.overlap);
    t.add("pressure_Pa", r.pressure);
    t.add("c11_Pa", r.c11);
    t.add("c12_Pa", r.c12);
    t.add("c44_Pa", r.c44);
    t.add("bulk_modulus_Pa", r.bulk);
    t.add("density_of_crystal_kg_per_m3", density);
    t.add("compression_wave_100_m_per_s", std::sqrt(r.c11 / density));
    t.add("shear_wave_100_m_per_s", std::sqrt(r.c44 / density));
    t.add("resultant_over_contact_force", r.unbalanced);
    return t;
}

Summary stability(const Settings& s) {
    const auto lattice = named<Lattice>(lattice_names, s.lattice);
    const auto limit = [&](std::vector<Neighbour> around) {
        return run_experiment(
            StabilityLimit{.around = std::move(around), .shear_ratio = s.shear_ratio});
    };
    const double together = limit(in_phase(lattice)), against = limit(zone_boundary(lattice)),
                 alone = limit(held(lattice));
    Summary t; // limits in units of sqrt(m / kn)
    t.add("limit_all_spin_alike", together);
    t.add("limit_zone_boundary", against);
    t.add("limit_neighbours_held", alone);
    t.add("limit_of_lattice", std::min(together, against));
    return t;
}

void check_options(const Settings& settings, const Common&) {
    if (settings.what == "moduli") check(crystal_of(settings));
}

void run(const Settings& settings, const Common& common) {
    const Summary results =
        settings.what == "moduli" ? moduli(crystal_of(settings)) : stability(settings);
    report_results(common, results);
}

std::string explain(const Settings& settings, const Common&) {
    return explain_step(law_named(settings.law), Grains::spheres);
}

} // namespace

int main(int argc, char** argv) {
    return run_scenario<Settings>(argc, argv,
                                  {"crystal",
                                   "Elastic moduli and stability limit of a crystal of equal "
                                   "spheres.",
                                   "a run of a crystal takes only a moment"},
                                  check_options, run, explain);
}
