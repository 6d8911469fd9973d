#include "scenarios/library/material_estimate.hpp"

#include "engine/errors.hpp"
#include "engine/io/whole_file.hpp"
#include "scenarios/library/library_use.hpp"
#include "scenarios/records/draw_curves.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace bris {

namespace {

constexpr double shortest_test = 0.003; // axial strain; the library's first tenths are too few
/// Axial strain between records over which q is interpolated: laboratories write every 0.3 %.
constexpr double widest_gap = 6e-3;
constexpr std::array further_strains{0.01, 0.02, 0.04, 0.08};

double stiffness_of_library(const SpecimenLibrary& library) {
    const auto found = std::ranges::find(library.settings, std::string("clump_stiffness_N_per_m"),
                                         &NamedValue::key);
    require(found != library.settings.end(),
            "--library: expected a library that says its contact stiffness, found none");
    return std::stod(found->text());
}

/// (1 - part) a + part b of all numbers, of q as logarithms.
LibraryTest between(const LibraryTest& a, const LibraryTest& b, double part) {
    const auto linear = [&](const std::vector<float>& x, const std::vector<float>& y) {
        std::vector<float> mixed;
        for (std::size_t k = 0; k < x.size(); ++k)
            mixed.push_back(static_cast<float>((1 - part) * double{x[k]} + part * double{y[k]}));
        return mixed;
    };
    const auto geometric = [&](const std::vector<float>& x, const std::vector<float>& y) {
        std::vector<float> mixed;
        for (std::size_t k = 0; k < x.size(); ++k)
            mixed.push_back(x[k] > 0 && y[k] > 0
                                ? static_cast<float>(std::exp((1 - part) * std::log(double{x[k]}) +
                                                              part * std::log(double{y[k]})))
                                : std::min(x[k], y[k]));
        return mixed;
    };
    return {geometric(a.q, b.q),          geometric(a.smoothed_q, b.smoothed_q),
            linear(a.volume, b.volume),   linear(a.rings, b.rings),
            linear(a.sensors, b.sensors), linear(a.field, b.field)};
}

double root_mean_square(const LeaveOneOutRegression& r, Eigen::Index column) {
    return std::sqrt(r.residuals().col(column).squaredNorm() /
                     static_cast<double>(r.residuals().rows()));
}

/// A measurement of a specimen: at a pressure, and what.
struct Measurement {
    std::size_t pressure;
    LibraryObservations observed;
};

/// Finds what a further measurement on each specimen of the library adds to what is known.
class FurtherTests {
public:
    FurtherTests(const SpecimenLibrary& library, const Measurement& known)
        : library_(library), known_(known) {
        parameters_.resize(static_cast<Eigen::Index>(library.specimens.size()), 2);
        for (std::size_t k = 0; k < library.specimens.size(); ++k)
            parameters_.row(static_cast<Eigen::Index>(k))
                << std::log(library.specimens[k].rocks.friction),
                std::log(library.specimens[k].rocks.stiffness);
    }
    void add(const std::string& what, const Measurement& further, bool known = false);
    void add_all();
    std::vector<FurtherTest> sorted() && {
        std::ranges::stable_sort(
            tests_, {}, [](const FurtherTest& t) { return std::pair(!t.measured, t.ln_friction); });
        return std::move(tests_);
    }

private:
    const SpecimenLibrary& library_;
    Measurement known_;
    Matrix parameters_;
    std::vector<FurtherTest> tests_;
};

void FurtherTests::add(const std::string& what, const Measurement& further, bool known) {
    Matrix features;
    for (std::size_t k = 0; k < library_.specimens.size(); ++k) {
        const LibrarySpecimen& s = library_.specimens[k];
        const Vector before = parameter_features_of(library_, s, known_.pressure, known_.observed);
        Vector row = before;
        if (!known) {
            const Vector after =
                parameter_features_of(library_, s, further.pressure, further.observed);
            row.conservativeResize(before.size() + after.size());
            row.tail(after.size()) = after;
        }
        if (k == 0) features.resize(parameters_.rows(), row.size());
        features.row(static_cast<Eigen::Index>(k)) = row.transpose();
    }
    const LeaveOneOutRegression regression(features, Vector::Ones(features.cols()), parameters_,
                                           {{0, 1}, {1, 1}});
    tests_.push_back({what, library_.pressures[further.pressure], further.observed.strain, known,
                      root_mean_square(regression, 0), root_mean_square(regression, 1)});
}

void FurtherTests::add_all() {
    add("what is known", known_, true);
    const double last = library_.axis.strain(library_.axis.count - 1);
    LibraryObservations o = known_.observed;
    if (!o.volume) {
        o.volume = true;
        add("the volumetric strain of this test", {known_.pressure, o});
    }
    if (!known_.observed.porosity) {
        o = known_.observed;
        o.porosity = true;
        add("the porosity of the core", {known_.pressure, o});
    }
    for (std::size_t p = 0; p < library_.pressures.size(); ++p)
        for (const double strain : further_strains) {
            if (strain > last * (1 + 1e-9)) continue;
            o = {.strain = strain, .porosity = known_.observed.porosity};
            const bool same = p == known_.pressure;
            if (same && strain < known_.observed.strain + library_.axis.step) continue;
            add(same ? fmt::format("this test to {:g} %", 100 * strain)
                     : fmt::format("a test at {} to {:g} %", label_of(library_.pressures[p]),
                                   100 * strain),
                {p, o});
        }
}

/// Says what is outside the library's ranges.
std::vector<std::string> notes_on(const SpecimenLibrary& library, const TestOfMaterial& test,
                                  double distance) {
    std::vector<std::string> notes;
    const double last = library.axis.strain(library.axis.count - 1);
    if (test.measured[quantity::axial_strain].back() > last + library.axis.step)
        notes.push_back(fmt::format("what was measured beyond {:g} % of strain is not used, since "
                                    "the library ends there",
                                    100 * last));
    const auto [low, high] =
        std::ranges::minmax(library.specimens, {}, &LibrarySpecimen::core_porosity);
    if (test.core_porosity > 0 && (test.core_porosity < low.core_porosity - 0.005 ||
                                   test.core_porosity > high.core_porosity + 0.005))
        notes.push_back(fmt::format(
            "the porosity of {:.3f} is extrapolated, since the library has {:.3f} to {:.3f}",
            test.core_porosity, low.core_porosity, high.core_porosity));
    if (distance > 1)
        notes.push_back(fmt::format(
            "these measurements are {:.1f} times as far from the library's specimens as 95 % of "
            "them are from the others: the bands are wider by this factor",
            distance));
    return notes;
}

void check_test(const TestOfMaterial& test, const SpecimenLibrary& library, double strain) {
    require(
        strain >= shortest_test * (1 - 1e-9),
        fmt::format("--test: expected measurements to at least {:g} of axial strain, found {:g}",
                    shortest_test, strain));
    require(test.measured[quantity::axial_strain].front() <= library.axis.step * (1 + 1e-9),
            fmt::format("--test: expected measurements from at most {:g} of axial strain on, found "
                        "{:g} as the first",
                        library.axis.step, test.measured[quantity::axial_strain].front()));
    const double most = std::ranges::max(test.measured[quantity::deviatoric_stress]);
    require(most > 0.1 * test.pressure && most < 100 * test.pressure,
            fmt::format("--test: expected a largest deviatoric stress of 0.1 to 100 times the "
                        "confining pressure of {:g} Pa, found {:g} Pa: another unit?",
                        test.pressure, most));
}

} // namespace

std::size_t add_pressure(SpecimenLibrary& library, double pressure) {
    for (std::size_t p = 0; p < library.pressures.size(); ++p)
        if (std::abs(library.pressures[p] / pressure - 1) < 0.01) return p;
    std::size_t below = library.pressures.size(), above = below;
    for (std::size_t p = 0; p < library.pressures.size(); ++p) {
        const double at = library.pressures[p];
        if (at < pressure && (below == library.pressures.size() || at > library.pressures[below]))
            below = p;
        if (at > pressure && (above == library.pressures.size() || at < library.pressures[above]))
            above = p;
    }
    const auto [low, high] = std::ranges::minmax(library.pressures);
    require(below < library.pressures.size() && above < library.pressures.size(),
            fmt::format("--pressure: expected {:g} to {:g} Pa, the pressures of the library, found "
                        "{:g}",
                        low, high, pressure));
    const double part = std::log(pressure / library.pressures[below]) /
                        std::log(library.pressures[above] / library.pressures[below]);
    for (LibrarySpecimen& s : library.specimens)
        s.tests.push_back(between(s.tests[below], s.tests[above], part));
    library.pressures.push_back(pressure);
    return library.pressures.size() - 1;
}

MaterialEstimate estimate_material(SpecimenLibrary library, const TestOfMaterial& test) {
    const double stiffness = stiffness_of_library(library);
    const std::size_t known_pressures = library.pressures.size(),
                      own = add_pressure(library, test.pressure);
    MaterialEstimate e;
    if (own >= known_pressures)
        e.notes.push_back(
            fmt::format("the library is interpolated to {}", label_of(test.pressure)));
    const double steps =
        std::floor(std::min({test.measured[quantity::axial_strain].back(), test.last_strain,
                             library.axis.strain(library.axis.count - 1)}) /
                   library.axis.step * (1 + 1e-9));
    e.used = {.strain = steps * library.axis.step, .porosity = test.core_porosity > 0};
    check_test(test, library, e.used.strain);
    LibrarySpecimen specimen = measured_specimen(library, own, test.measured, e.used, widest_gap);
    specimen.core_porosity = test.core_porosity;
    require(e.used.force,
            fmt::format("--test: expected q at steps of {:g} of axial strain or closer up to {:g}, "
                        "found gaps; --learning-strain ends before them",
                        widest_gap, e.used.strain));
    for (std::size_t p = 0; p < library.pressures.size(); ++p) {
        const LibraryPredictor predictor(library, e.used, own, p);
        e.tests.push_back({library.pressures[p], predictor.predict(specimen)});
        if (p != own) continue;
        const LibraryPrediction& at = e.tests.back().predicted;
        const auto& [value, low, high] = at.stiffness;
        e.card = {at.friction, {stiffness * value, stiffness * low, stiffness * high}, at.porosity};
        if (test.core_porosity > 0)
            e.card.core_porosity = {test.core_porosity, test.core_porosity, test.core_porosity};
        e.distance = at.distance;
        e.ln_friction_prior =
            predictor.parameters().prior().deviation[ParameterColumn::ln_friction];
    }
    std::ranges::sort(e.tests, {}, &PredictedTest::pressure);
    for (std::string& note : notes_on(library, test, e.distance))
        e.notes.push_back(std::move(note));
    FurtherTests further(library, {own, e.used});
    further.add_all();
    e.further_tests = std::move(further).sorted();
    return e;
}

void write_further_tests(const std::filesystem::path& csv, const MaterialEstimate& estimate) {
    std::string text =
        "# root mean square errors of ln friction and ln stiffness that are expected "
        "after a further measurement, the most telling first\n"
        "measurement,confining_pressure_Pa,axial_strain,ln_friction_error,"
        "ln_stiffness_error\n";
    for (const FurtherTest& t : estimate.further_tests)
        text += fmt::format("{},{:g},{:g},{:.4f},{:.4f}\n", t.what, t.pressure, t.strain,
                            t.ln_friction, t.ln_stiffness);
    write_whole(csv, text);
}

bool draw_material(const std::filesystem::path& png, const MaterialEstimate& e,
                   const TestOfMaterial& test) {
    std::vector<Plot> q, volume;
    const std::size_t every = 1 + test.measured.size() / 100;
    const TestCurves some = test.measured.rows_where([&](std::size_t k) { return k % every == 0; });
    for (const PredictedTest& t : e.tests) {
        const TestCurves& predicted = t.predicted.curves;
        const bool own = std::abs(t.pressure / test.pressure - 1) < 0.01;
        const auto panel = [&](const char* title, const char* label, const Quantity& quantity) {
            Plot plot{.title = fmt::format("{} at {}", title, label_of(t.pressure)),
                      .x_label = "axial strain (%)",
                      .y_label = label,
                      .curves = curves_with_band(predicted, quantity)};
            if (own)
                plot.curves.insert(plot.curves.begin(),
                                   curve_of("measured",
                                            some.up_to(predicted[quantity::axial_strain].back()),
                                            quantity, Curve::Style::points));
            return plot;
        };
        q.push_back(panel("Deviatoric stress", "q (kPa)", quantity::deviatoric_stress));
        volume.push_back(
            panel("Volumetric strain", "volumetric strain (%)", quantity::volumetric_strain));
    }
    const auto columns = static_cast<unsigned>(q.size());
    q.insert(q.end(), volume.begin(), volume.end());
    return draw_plots(png, q, columns);
}

} // namespace bris
