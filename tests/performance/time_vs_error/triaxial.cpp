// S5: drained triaxial compression of a small specimen. A seed has one specimen for each clump
// library, kept in a checkpoint. Every variant is consolidated and sheared from there, so two
// variants of a seed differ by the method and by the divergence of perturbed runs of a few hundred
// rocks.
#include "scenarios/triaxial/triaxial.hpp"

#include "components/membrane.hpp"
#include "components/platen.hpp"
#include "engine/assets.hpp"
#include "engine/errors.hpp"
#include "engine/io/checkpoint.hpp"
#include "scenarios/rocks/clump_library.hpp"
#include "scenarios/rocks/make_library.hpp"
#include "scenarios/rocks/mass_properties.hpp"
#include "scenarios/specimens/true_masses.hpp"
#include "scenarios/triaxial/triaxial_results.hpp"
#include "systems/broadphase/lists.hpp"
#include "systems/contact/energy_budget.hpp"
#include "systems/contact/mass_scaling.hpp"
#include "systems/output/quantities.hpp"
#include "systems/steps.hpp"
#include "tests/performance/time_vs_error/scene.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace bris::time_vs_error {

namespace {

constexpr std::size_t rocks = 240;
constexpr double pressure = 110e3;     // Pa
constexpr double final_strain = 0.024; // a little more than 2 %, a multiple of every stage
constexpr double stiffness = 0.63e8;   // N/m, of one partner

/// Porosity of the specimens of a library: the usual one for angular rocks, and one that spheres
/// can also reach where libraries are compared.
double porosity_of(const std::string& library) { return library == "assets" ? 0.32 : 0.36; }

/// Folder of the clumps with the given number of spheres, which are made once. A single sphere has
/// the sieve size as diameter.
std::filesystem::path library_folder(const std::filesystem::path& work,
                                     const std::string& library) {
    if (library == "assets") return assets_folder() / "clumps";
    const auto folder = work / ("clumps_" + library);
    if (std::filesystem::exists(folder / "report.csv")) return folder; // this file is written last
    if (library == "1") {
        const std::vector<Ball> ball{{Vec3::Zero(), 0.5}};
        std::filesystem::create_directories(folder);
        write_clump(folder / "rock_01.csv", make_clump("rock_01", ball),
                    {"SOURCE: one ball of sieve size 1"});
        return folder;
    }
    LibrarySettings settings;
    settings.fill.restarts = 2; // instead of the usual four, to halve the time
    settings.fill.fit.spheres = static_cast<std::size_t>(std::stoul(library));
    settings.cube = false;
    settings.out = folder;
    make_library(settings);
    return folder;
}

/// The rocks of a specimen and its mould, without sensor rocks, for which a small specimen has no
/// space.
World make_world_of(const std::vector<Clump>& clumps, double initial_porosity, std::uint64_t seed) {
    const Grading grading = read_grading(assets_folder() / "gradings" / "arema_4.csv");
    const RockSample sample = sample_rocks(grading, clumps, rocks, seed);
    SpecimenSettings specimen;
    specimen.clump_stiffness = stiffness;
    specimen.seed = seed;
    specimen.radius = radius_for(sample.solid_volume, initial_porosity, specimen.sectors);
    specimen.height = 4 * specimen.radius;
    return make_triaxial_world(specimen, clumps, std::span(clumps).first(1), sample.rocks, {});
}

class TriaxialRuns {
public:
    explicit TriaxialRuns(std::filesystem::path work) : work_(std::move(work)) {}
    Outcome run(const Settings& settings, std::uint64_t seed);

private:
    TriaxialSettings test_of(const Settings& settings) const;
    Simulation begin(const Settings& settings, std::uint64_t seed) const;
    const Archive& specimen(const std::string& library, std::uint64_t seed);

    std::filesystem::path work_;
    std::string ready_name_; // name of the specimen that was used last
    Archive ready_;
};

TriaxialSettings TriaxialRuns::test_of(const Settings& settings) const {
    TriaxialSettings test;
    test.confining_pressure = pressure;
    test.final_axial_strain = final_strain;
    test.porosity = porosity_of(settings.word("library"));
    test.tolerance = settings.number("tolerance");
    test.stage_strain = settings.number("stage_strain");
    test.move_steps = static_cast<unsigned>(settings.number("move_steps"));
    test.damping = settings.number("damping");
    test.longest_stage = 200'000;
    test.mass_scaling = settings.word("mass_scaling") != "off";
    if (test.mass_scaling) test.safety = settings.number("mass_scaling");
    return test;
}

Simulation TriaxialRuns::begin(const Settings& settings, std::uint64_t seed) const {
    const std::string& library = settings.word("library");
    auto clumps = read_clumps(library_folder(work_, library));
    std::erase_if(clumps, [](const Clump& c) { return c.name == "cube"; });
    World world = make_world_of(clumps, porosity_of(library) + 0.04, seed);
    const auto patch =
        settings.word("patch") == "shared" ? PatchStiffness::shared : PatchStiffness::per_sphere;
    world.resource<Materials>().policy.patch = patch;
    ListSettings lists;
    if (settings.word("skin") != "tuned") {
        const double skin = settings.number("skin") * 0.025; // m, with a rock size of 0.025 m
        lists = {
            .outer_skin = 3 * skin, .inner_skin = skin, .largest_skin = 3 * skin, .tune = false};
    }
    add_lists(world, LawName::linear, lists);
    add_energy_budget(world);
    world.add_resource<TriaxialState>();
    Simulation simulation(std::move(world), steps(LawName::linear, true, patch));
    simulation.on_restore(forget_lists);
    return simulation;
}

/// Specimen made with the standard settings of the scene, before consolidation.
const Archive& TriaxialRuns::specimen(const std::string& library, std::uint64_t seed) {
    const std::string name = fmt::format("specimen_{}_seed_{}", library, seed);
    if (name == ready_name_) return ready_;
    const auto file = work_ / (name + ".ckpt.h5");
    Settings made = triaxial(work_.string()).standard;
    made.set("library", library);
    const TriaxialSettings how = test_of(made);
    const std::vector<NamedValue> provenance{{"library", library},
                                             {"rocks", rocks},
                                             {"porosity", how.porosity},
                                             {"stiffness_N_per_m", stiffness},
                                             {"taps", how.taps}};
    if (std::filesystem::exists(file)) {
        Checkpoint kept = read_checkpoint(file);
        require_same_run("checkpoint", file, kept, "time_vs_error", provenance, {});
        ready_ = std::move(kept.state);
    } else {
        Simulation simulation = begin(made, seed);
        TriaxialTest test(simulation, how);
        while (test.state().phase < TriaxialPhase::consolidate) test.advance();
        ready_ = simulation.snapshot();
        std::filesystem::create_directories(work_);
        write_checkpoint(
            file, {"time_vs_error", simulation.world().resource<Clock>().step, provenance, ready_});
    }
    ready_name_ = name;
    return ready_;
}

/// Sets the contact stiffnesses of the test, and adapts masses and time step to them before the
/// first step.
void set_stiffness(World& world, const Settings& settings, const TriaxialSettings& test) {
    auto& materials = world.resource<Materials>();
    const auto& specimen = world.resource<Specimen>();
    const double kn = settings.number("stiffness") * stiffness,
                 wall = settings.number("wall_stiffness");
    const double ratio = settings.number("shear_ratio");
    for (const auto& [which, k] : {std::pair(specimen.rock_material, kn),
                                   {specimen.platen_material, wall},
                                   {specimen.membrane_material, wall}}) {
        materials.list[which].normal_stiffness = k;
        materials.list[which].shear_stiffness = ratio * k;
    }
    materials.policy.patch =
        settings.word("patch") == "shared" ? PatchStiffness::shared : PatchStiffness::per_sphere;
    materials.mix();
    const double contact =
        materials.linear_pairs[materials.pair(specimen.rock_material, specimen.membrane_material)]
            .kn;
    world.resource<Membrane>().contact_stiffness = world.resource<Platen>().contact_stiffness =
        contact;
    world.resource<LocalDamping>().fraction = test.damping;
    const double dt = test.mass_scaling ? scale_masses(world, 0, test.safety, false).dt
                                        : test.safety * restore_masses(world);
    world.resource<Clock>().change_step(dt);
    invalidate_lists(world);
}

/// Mean of a curve over axial strains within 0.25 % of `strain`, since single points of a small
/// specimen jump when force chains break.
double around(const TestCurves& curves, double strain, const Quantity& q) {
    double sum = 0, count = 0;
    for (std::size_t k = 0; k < curves.size(); ++k)
        if (std::abs(curves[quantity::axial_strain][k] - strain) < 0.0025 + 1e-9)
            sum += curves[q][k], ++count;
    return count > 0 ? sum / count : unknown;
}

Outcome TriaxialRuns::run(const Settings& settings, std::uint64_t seed) {
    const TriaxialSettings settings_of_test = test_of(settings);
    const Archive& start = specimen(settings.word("library"), seed);
    Simulation simulation = begin(settings, seed);
    simulation.restore(start);
    set_stiffness(simulation.world(), settings, settings_of_test);
    TriaxialTest test(simulation, settings_of_test);
    const World& world = simulation.world();
    const std::uint64_t first = world.resource<Clock>().step;
    Outcome outcome;
    outcome.wall_time = median_time(1, 0, [&] {
        while (test.advance()) {
        }
    });
    const TestCurves& curves = test.state().curves;
    const TriaxialProperties p = properties_of(curves, pressure);
    outcome.steps = world.resource<Clock>().step - first;
    outcome.contacts = static_cast<double>(compute_quantities(world).contacts);
    outcome.measured = {{around(curves, 0.01, quantity::deviatoric_stress)},
                        {around(curves, 0.02, quantity::deviatoric_stress)},
                        {p.initial_modulus},
                        {p.secant_modulus},
                        {around(curves, 0.02, quantity::volumetric_strain)},
                        {p.relative_energy_error, 0}};
    outcome.fingerprint = hexadecimal(fingerprint(simulation.snapshot()));
    outcome.note =
        fmt::format("core porosity {:.4f}, inertial number {:.1e}, stress mismatch {:.1e}",
                    test.state().core_porosity, p.largest_inertial_number, p.worst_stress_mismatch);
    return outcome;
}

} // namespace

Scene triaxial(const std::string& work) {
    Scene s{"S5",
            fmt::format("triaxial test of {} rocks at {:.0f} kPa", rocks, pressure / 1e3),
            {{"tolerance", "1e-3"},
             {"stage_strain", "1e-4"},
             {"move_steps", "60"},
             {"stiffness", "1"},
             {"shear_ratio", "1"},
             {"wall_stiffness", "1e8"},
             {"mass_scaling", "0.9"},
             {"damping", "0.7"},
             {"skin", "tuned"},
             {"library", "assets"},
             {"patch", "per_sphere"}},
            {},
            {},
            {},
            "test"};
    s.kinds = {{"q_at_1_percent", 0.03, true},           {"q_at_2_percent", 0.03, true},
               {"initial_modulus", 0.1, true},           {"E50", 0.1, true},
               {"volumetric_strain_at_2_percent", 1e-3}, {"energy_balance", 1e-3, false, true}};
    const std::vector<std::string> counts{"1", "8", "15", "30", "60"};
    s.knobs = {
        {"unbalanced ratio",
         "tolerance",
         {"1e-2", "3e-3", "1e-3", "1e-4", "1e-5"},
         {},
         {{"tolerance", "1e-5"}}},
        {"stage strain",
         "stage_strain",
         {"4e-4", "2e-4", "1e-4", "5e-5"},
         {},
         {{"stage_strain", "5e-5"}}},
        {"move steps (inertial number)",
         "move_steps",
         {"12", "24", "60", "120", "240"},
         {},
         {{"move_steps", "240"}}},
        {"stiffness level", "stiffness", {"0.1", "0.3", "1", "3", "10"}, {}, {{"stiffness", "10"}}},
        {"ks/kn", "shear_ratio", {"0.3", "0.5", "0.8", "1"}, {}, {{"shear_ratio", "0.8"}}},
        {"wall stiffness (N/m)",
         "wall_stiffness",
         {"1e7", "1e8", "1e9"},
         {},
         {{"wall_stiffness", "1e9"}}},
        {"mass scaling (safety)",
         "mass_scaling",
         {"0.9", "0.7", "0.5", "off"},
         {},
         {{"mass_scaling", "off"}}},
        {"local damping", "damping", {"0.1", "0.3", "0.7"}, {}, {{"damping", "0.1"}}},
        {"skin (rock sizes)", "skin", {"tuned", "0.01", "0.05"}, {}, {}, true},
        {"spheres, patches shared",
         "library",
         counts,
         {{"patch", "shared"}},
         {{"library", "60"}, {"patch", "shared"}}},
        {"spheres, each its stiffness",
         "library",
         counts,
         {{"patch", "per_sphere"}},
         {{"library", "60"}, {"patch", "shared"}}}};
    const auto runs = std::make_shared<TriaxialRuns>(work);
    s.run = [runs](const Settings& settings, std::uint64_t seed) {
        return runs->run(settings, seed);
    };
    return s;
}

} // namespace bris::time_vs_error
