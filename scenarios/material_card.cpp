// A material card from one measured triaxial curve: the friction and stiffness of the rocks with
// their bands, predicted curves at other pressures, and which further test would tell most.

#include "engine/assets.hpp"
#include "engine/errors.hpp"
#include "engine/report.hpp"
#include "scenarios/library/library_use.hpp"
#include "scenarios/library/material_estimate.hpp"
#include "scenarios/records/machine_file.hpp"
#include "scenarios/records/machine_quality_control.hpp"
#include "scenarios/rocks/own_rocks.hpp"
#include "scenarios/triaxial/triaxial_results.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace bris {

namespace {

struct CardRun {
    std::filesystem::path test = assets_folder() / "smartrock" / "110kPa" / "test.csv", columns;
    std::filesystem::path library = assets_folder() / "libraries" / "arema_4_400_rocks.h5";
    double pressure = 110e3, porosity = 0, diameter = 0, height = 0, grain_size = 0,
           learning_strain = 0;

    void declare_options(auto& option) {
        option.group("Test");
        option("test", test, "",
               "CSV file of the measured test, as the laboratory has it: axial strain or "
               "displacement, "
               "deviatoric stress or force and, if it was measured, volumetric strain or change of "
               "volume, with their units. Default: the example of the assets at 110 kPa.");
        option("columns", columns, "",
               "File that maps the columns of the test: names, units, signs, delimiter. Without it "
               "they are guessed, and the guess is written as columns.txt.");
        option("pressure", pressure, "Pa", "Confining pressure of the test.",
               above(0, 1e9).usually(1e3, 1e7));
        option("porosity", porosity, "",
               "Porosity of the core at the start of shearing; 0: not known.", within(0, 0.6));
        option("diameter", diameter, "m",
               "Diameter of the specimen; 0: that of the library's specimens.", within(0, 10));
        option("height", height, "m",
               "Height of the specimen before shearing, for displacements and changes of volume; "
               "0: not known.",
               within(0, 20));
        option(
            "grain_size", grain_size, "m",
            "Size of the grains that half of their mass passes (d50), to be compared with that of "
            "the library's rocks; 0: not known.",
            within(0, 1));
        option("learning_strain", learning_strain, "",
               "Axial strain up to which measurements are used; 0: all of them.", within(0, 0.5));
        option("library", library, "",
               "File of a library of specimens (specimen_library) of the same rocks.");
    }
};

std::string setting_of(const SpecimenLibrary& library, const std::string& key) {
    const auto found = std::ranges::find(library.settings, key, &NamedValue::key);
    if (found == library.settings.end()) return "unknown";
    return found->text();
}

void require_size(const SpecimenLibrary& library, double diameter) {
    constexpr double tolerance = 1.25; // 4 000 rocks instead of 400 are 2.2 times as wide
    const auto [low, high] = std::ranges::minmax(library.specimens, {}, &LibrarySpecimen::diameter);
    require(diameter == 0 ||
                (diameter > low.diameter / tolerance && diameter < high.diameter * tolerance),
            fmt::format("--diameter: expected a specimen about as wide as those of the library, "
                        "{:.3g} to {:.3g} m, found {:g}: strength depends on size, so make a "
                        "library of that size (specimen_library --bodies)",
                        low.diameter, high.diameter, diameter));
}

void add_band(Report& summary, const std::string& name, const std::string& unit,
              const NumberWithBand& n) {
    summary.add(name + unit, n.value);
    summary.add(name + "_low" + unit, n.low);
    summary.add(name + "_high" + unit, n.high);
}

Report card_of(const MaterialEstimate& e, const SpecimenLibrary& library) {
    Report card;
    add_band(card, "friction", "", e.card.friction);
    add_band(card, "clump_stiffness", "_N_per_m", e.card.clump_stiffness);
    add_band(card, "core_porosity", "", e.card.core_porosity);
    card.add("ln_friction_prior_deviation", e.ln_friction_prior);
    card.add("library_distance", e.distance);
    card.add("strain_used", e.used.strain);
    card.add("volume_used", e.used.volume);
    card.add("porosity_used", e.used.porosity);
    for (const PredictedTest& t : e.tests) {
        const TestCurves::Column& q = t.predicted.curves.column(quantity::smoothed_q);
        add_band(card, folder_of(t.pressure) + "_largest_smoothed_q", "_Pa",
                 {std::ranges::max(q.values), std::ranges::max(q.low), std::ranges::max(q.high)});
    }
    if (e.further_tests.size() > 1) {
        card.add("most_telling_further_test", e.further_tests[1].what);
        card.add("ln_friction_error_now", e.further_tests[0].ln_friction);
        card.add("ln_friction_error_after_it", e.further_tests[1].ln_friction);
    }
    for (const char* key : {"grading", "clumps", "bodies", "density_kg_per_m3"})
        card.add(std::string("library_") + key, setting_of(library, key));
    std::string notes;
    for (const std::string& note : e.notes) notes += (notes.empty() ? "" : "; ") + note;
    card.add("notes", notes);
    return card;
}

/// The records of the test, without those that no machine can have measured, and notes about what
/// is left out. Throws InputError if strain or stress are refused.
LaboratoryCurves checked_records(const CardRun& s, const Common& common) {
    LaboratoryCurves read = read_laboratory_test({.file = s.test,
                                                  .columns = s.columns,
                                                  .pressure = s.pressure,
                                                  .diameter = s.diameter,
                                                  .height = s.height,
                                                  .guessed = common.out / "columns.txt"});
    for (const Finding& f : check_machine(read.curves, s.pressure)) {
        const bool needed = f.check == "axial_strain" || f.check == "deviatoric_stress_Pa";
        require(!needed || f.kind == Finding::Kind::note,
                fmt::format("--test: {}: {}: {}", s.test.string(), f.check, f.text));
        read.notes.push_back(fmt::format("{}: {}", f.check, f.text));
    }
    return read;
}

/// Compares the size (m) of the tested grains with that of the library's rocks; the sentence says
/// if it is not known. Throws InputError if the library is of another material.
std::string compared_grains(const SpecimenLibrary& library, double grain_size) {
    constexpr double tolerance = 1.5; // the sieves of a grading are as far apart
    const std::string name = setting_of(library, "grading");
    if (name == "unknown") return "The library does not say of which rocks it is.";
    const double size = grading_named(name).size_at(0.5);
    if (grain_size == 0)
        return fmt::format(
            "Whether the rocks of the test are as those of the library, whose d50 is "
            "{:.0f} mm, is not known: give --grain-size.",
            1e3 * size);
    require(
        std::max(size / grain_size, grain_size / size) <= tolerance,
        fmt::format("--grain-size: expected that of the library's rocks, {:.3g} m within a factor "
                    "of {:g}, found {:g} m: the library is of another material; make one of its "
                    "grading (specimen_library --grading)",
                    size, tolerance, grain_size));
    return {};
}

/// Shows the estimate with its bands, the predicted tests, and how far the card can be trusted.
void show(Report& card, const MaterialEstimate& e, const SpecimenLibrary& library) {
    card.show({"friction", "clump_stiffness_N_per_m", "core_porosity"});
    for (const PredictedTest& t : e.tests)
        card.show({folder_of(t.pressure) + "_largest_smoothed_q_Pa"});
    card.show({"strain_used", "library_distance"});
    if (e.further_tests.size() > 1) card.show({"most_telling_further_test"});
    card.show_sentence(fmt::format(
        "The card holds for rocks as those of the library ({} rocks of {}), with friction {} to {} "
        "and stiffness {} to {} times its own. The bands are those of 90 %.",
        setting_of(library, "bodies"), setting_of(library, "grading"),
        setting_of(library, "lowest_friction"), setting_of(library, "highest_friction"),
        setting_of(library, "lowest_stiffness"), setting_of(library, "highest_stiffness")));
    for (const std::string& note : e.notes) card.show_sentence(fmt::format("Note: {}.", note));
}

void run(const CardRun& s, const Common& common) {
    const LaboratoryCurves read = checked_records(s, common);
    TestOfMaterial test{read.curves, s.pressure, s.porosity,
                        s.learning_strain > 0 ? s.learning_strain : 1};
    const SpecimenLibrary library = read_library(s.library);
    const std::string about_grains = compared_grains(library, s.grain_size);
    require(!library.specimens.empty(), "--library: expected specimens, found none");
    require_size(library, s.diameter);
    const MaterialEstimate e = estimate_material(library, test);
    write_material_card(common.out / "card.csv", e.card);
    const Report card = card_of(e, library);
    card.write(common.out / "card.json");
    for (const PredictedTest& t : e.tests)
        write_prediction(common.out / (folder_of(t.pressure) + ".csv"), t.predicted.curves);
    write_further_tests(common.out / "further_tests.csv", e);
    draw_material(common.out / "card.png", e, test);
    Report shown = card;
    show(shown, e, library);
    if (!about_grains.empty()) shown.show_sentence(about_grains);
    for (const std::string& note : read.notes) shown.show_sentence(fmt::format("Note: {}", note));
    report_results(common, shown);
}

} // namespace

} // namespace bris

int main(int argc, char** argv) {
    return bris::run_scenario<bris::CardRun>(
        argc, argv,
        {.name = "material_card",
         .description = "Estimates the friction and stiffness of rocks from one measured triaxial "
                        "test, and predicts tests at other pressures.",
         .cannot_resume = "a card takes seconds",
         .cannot_explain = "it simulates nothing"},
        bris::run);
}
