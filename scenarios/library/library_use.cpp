#include "scenarios/library/library_use.hpp"

#include "engine/errors.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace bris {

namespace {

/// Settings that must be those of the library: the rocks, their number, and the procedure.
constexpr std::array same_settings{"bodies",
                                   "grading",
                                   "clumps",
                                   "density_kg_per_m3",
                                   "clump_stiffness_N_per_m",
                                   "wall_stiffness_N_per_m",
                                   "law",
                                   "platen_friction",
                                   "taps",
                                   "preparation_friction",
                                   "membrane",
                                   "servo_per_element",
                                   "gravity"};
/// The same for specimens with Hertz-Mindlin contacts. Others may be of a version that had no such
/// settings.
constexpr std::array same_settings_of_hertz{"young_modulus_Pa", "poisson_ratio"};
constexpr std::array same_settings_of_latex{"latex_thickness_m", "latex_modulus_Pa",
                                            "latex_wrinkles", "latex_edge"};
constexpr std::array same_settings_of_edges{
    "friction_rise",  "friction_half_pressure_Pa", "friction_half_force_N", "couple_arm_m",
    "couple_force_N", "contact_strength_Pa",       "cone_half_angle_rad",   "edge_radius_m"};

std::string text_of(std::span<const NamedValue> settings, const std::string& key) {
    const auto found = std::ranges::find(settings, key, &NamedValue::key);
    if (found == settings.end()) // libraries from before there was a choice
        return key == "law" ? "linear" : key == "membrane" ? "rings" : "none";
    return found->text();
}

/// The first of the settings in which a library and the model differ; empty: none.
std::string difference(std::span<const NamedValue> library, std::span<const NamedValue> model,
                       std::span<const char* const> keys) {
    for (const char* key : keys) {
        const std::string theirs = text_of(library, key), ours = text_of(model, key);
        if (theirs != ours)
            return fmt::format("its specimens have {} {}, the model has {}", key,
                               theirs.empty() ? "none" : theirs, ours.empty() ? "none" : ours);
    }
    return {};
}

} // namespace

bool is_given(const std::filesystem::path& library) {
    return !library.empty() && library != "none";
}

std::size_t pressure_index(const SpecimenLibrary& library, double pressure) {
    std::size_t p = 0;
    while (p < library.pressures.size() && std::abs(library.pressures[p] / pressure - 1) > 0.01)
        ++p;
    return p;
}

std::string reason_against(const SpecimenLibrary& library, const ModelOfTest& model) {
    std::string other = difference(library.settings, model.settings, same_settings);
    if (other.empty() && text_of(library.settings, "law").starts_with("hertz"))
        other = difference(library.settings, model.settings, same_settings_of_hertz);
    if (other.empty() && text_of(library.settings, "law").ends_with("edges"))
        other = difference(library.settings, model.settings, same_settings_of_edges);
    if (other.empty() && text_of(library.settings, "membrane") == "latex")
        other = difference(library.settings, model.settings, same_settings_of_latex);
    if (!other.empty()) return other;
    if (pressure_index(library, model.pressure) == library.pressures.size()) {
        std::string all;
        for (const double p : library.pressures)
            all += fmt::format("{}{:g}", all.empty() ? "" : ", ", p / 1e3);
        return fmt::format("it has the pressures {} kPa, the test has {:g}", all,
                           model.pressure / 1e3);
    }
    if (library.specimens.empty()) return "it has no specimens";
    const auto [low, high] = std::ranges::minmax(library.specimens, {}, &LibrarySpecimen::porosity);
    constexpr double margin = 0.005; // the default tolerance of the preparation
    if (model.core_porosity < low.porosity - margin || model.core_porosity > high.porosity + margin)
        return fmt::format("its core porosities are {:.3f} to {:.3f}, that of the model is {:.3f}",
                           low.porosity, high.porosity, model.core_porosity);
    return {};
}

LibraryOfFile read_fitting_library(const std::filesystem::path& file_or_folder,
                                   std::span<const ModelOfTest> models) {
    namespace fs = std::filesystem;
    if (!fs::is_directory(file_or_folder)) return {file_or_folder, read_library(file_or_folder)};
    std::vector<fs::path> files;
    for (const auto& entry : fs::directory_iterator(file_or_folder))
        if (entry.is_regular_file() && entry.path().extension() == ".h5")
            files.push_back(entry.path());
    require(!files.empty(),
            fmt::format("--library: expected a file or a folder with libraries (*.h5), found none "
                        "in '{}'",
                        file_or_folder.string()));
    std::ranges::sort(files);
    LibraryOfFile best;
    std::ptrdiff_t most = -1;
    for (const fs::path& file : files) {
        SpecimenLibrary library = read_library(file);
        const auto fits = std::ranges::count_if(
            models, [&](const ModelOfTest& m) { return reason_against(library, m).empty(); });
        if (fits <= most) continue;
        most = fits;
        best = {file, std::move(library)};
    }
    return best;
}

LibrarySpecimen measured_specimen(const SpecimenLibrary& library, std::size_t pressure,
                                  const MeasuredCurves& measured, LibraryObservations& observed,
                                  double widest_gap) {
    LibrarySpecimen specimen;
    specimen.tests.resize(library.pressures.size());
    LibraryTest& test = specimen.tests[pressure];
    const MonotonicStage stage(measured);
    for (std::size_t k = 0; k < library.axis.count; ++k) {
        const double strain = library.axis.strain(k);
        if (strain > observed.strain * (1 + 1e-9)) break;
        for (const auto& [numbers, quantity] : {std::pair{&test.q, &quantity::deviatoric_stress},
                                                {&test.volume, &quantity::volumetric_strain}})
            numbers->push_back(static_cast<float>(stage.value_at(*quantity, strain, widest_gap)));
    }
    const auto is_complete = [](const std::vector<float>& curve) {
        return std::ranges::all_of(curve, [](float x) { return std::isfinite(x); });
    };
    observed.force = observed.force && is_complete(test.q);
    observed.volume = observed.volume && is_complete(test.volume);
    observed.rings = observed.tracked = observed.tilt = false;
    return specimen;
}

TestPrediction predict_test(const SpecimenLibrary& library, const ModelOfTest& model,
                            const MeasuredCurves& measured, LibraryObservations observed,
                            bool motion) {
    TestPrediction t;
    t.not_used = reason_against(library, model);
    if (!t.not_used.empty()) return t;
    const std::size_t p = pressure_index(library, model.pressure);
    LibrarySpecimen specimen =
        measured_specimen(library, p, measured, observed, 2 * library.axis.step);
    specimen.core_porosity = model.core_porosity;
    if (!observed.force && !observed.volume) {
        t.not_used = fmt::format("neither q nor volumetric strain was measured at all of its "
                                 "strains to {:g}",
                                 observed.strain);
        return t;
    }
    t.used = observed;
    const LibraryPredictor predictor(library, observed, p, p, motion);
    t.predicted = predictor.predict(specimen);
    t.prior = predictor.prior();
    t.weights = predictor.weights(specimen);
    return t;
}

std::string sentence_of(const TestPrediction& t) {
    if (!t.not_used.empty()) return "the library of specimens is not used: " + t.not_used;
    const LibraryPrediction& p = t.predicted;
    const TestCurves::Column& q = p.curves.column(quantity::deviatoric_stress);
    std::string text = fmt::format(
        "the library of specimens predicts from {}{} to {:g} % of strain: friction {:.2f} ({:.2f} "
        "to {:.2f} with 90 %), q at {:g} % {:.0f} kPa ({:.0f} to {:.0f})",
        t.used.porosity ? "porosity and " : "",
        t.used.force && t.used.volume ? "q and volume"
        : t.used.force                ? "q"
                                      : "volume",
        100 * t.used.strain, p.friction.value, p.friction.low, p.friction.high,
        100 * p.curves[quantity::axial_strain].back(), q.values.back() / 1e3, q.low.back() / 1e3,
        q.high.back() / 1e3);
    if (p.distance > 1)
        text += fmt::format("; these measurements are {:.1f} times as far from its specimens as 95 "
                            "% of them are from the others: the bands are wider by this factor",
                            p.distance);
    return text;
}

void write_prediction(const std::filesystem::path& csv, const TestCurves& predicted) {
    write_curves(csv, predicted,
                 {{&quantity::axial_strain},
                  {&quantity::deviatoric_stress, "q"},
                  {&quantity::smoothed_q},
                  {&quantity::volumetric_strain}},
                 "mean and 90 % band predicted by a library of specimens", 6);
}

} // namespace bris
