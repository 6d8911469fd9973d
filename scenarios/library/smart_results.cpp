#include "scenarios/library/smart_results.hpp"

#include "engine/io/plot.hpp"
#include "engine/report.hpp"
#include "scenarios/ensemble/compared_curves.hpp"
#include "scenarios/ensemble/learning_results.hpp"
#include "scenarios/library/library_sensors.hpp"
#include "scenarios/records/quality_control_report.hpp"
#include "scenarios/triaxial/triaxial_results.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace bris {

namespace {

constexpr double to_the_end = std::numeric_limits<double>::infinity();

/// The curves of "fused": the library's prediction, or the model that learns.
TestCurves fused_curves(const SmartTest& c, double last_strain) {
    return c.by_library() ? c.library.predicted.curves.up_to(last_strain * (1 + 1e-9))
                          : c.running.front().curves;
}

/// The rows at strains of other curves, so that all are scored at the same.
MeasuredCurves at_strains_of(const TestCurves& others, const MeasuredCurves& measured) {
    const MonotonicStage stages(others);
    return MeasuredCurves(measured.rows_where([&](std::size_t k) {
        return stages.nearest(measured[quantity::axial_strain][k], 1e-6).has_value();
    }));
}

/// Adds the errors of DEM only and fused, and shows their ratio.
void add_errors(Report& to, const char* what, const char* unit, double without, double with) {
    to.add(fmt::format("DEM_only_rmse_{}{}", what, unit), without);
    to.add(fmt::format("fused_rmse_{}{}", what, unit), with);
    const std::string ratio = fmt::format("error_ratio_{}", what);
    to.add(ratio, with / without);
    to.show({ratio});
}

/// Shows what the library predicts, whether the test agrees, and how far this can be trusted.
void show_prediction(Report& to, const RecordedTest& test, const TestPrediction& t) {
    const LibraryPrediction& p = t.predicted;
    const auto last = [&](const Quantity& quantity, const char* unit, double scale) {
        const TestCurves::Column& c = p.curves.column(quantity);
        return three_digits(scale * c.values.back(), scale * c.low.back(), scale * c.high.back(),
                            unit);
    };
    const double strain = p.curves[quantity::axial_strain].back();
    to.show_row(fmt::format("predicted q at {:g} % of strain", 100 * strain),
                last(quantity::deviatoric_stress, "Pa", 1));
    if (const auto there = MonotonicStage(test.curves).nearest(strain, 1e-6)) {
        const TestCurves::Column& predicted = p.curves.column(quantity::deviatoric_stress);
        const double q = test.curves[quantity::deviatoric_stress][*there];
        const bool inside = predicted.low.back() <= q && q <= predicted.high.back();
        to.show_row("measured q there",
                    three_digits(q, "Pa") + (inside ? "" : ": outside the band"));
    }
    to.show_row("predicted volumetric strain", last(quantity::volumetric_strain, "%", 100));
    to.show_row("learned from", fmt::format("{:g} % of strain", 100 * t.used.strain));
    to.show_row("distance from the library",
                three_digits(p.distance) + (p.distance > 1 ? ": extrapolated" : ": inside"));
}

void add_learned(Report& to, const RecordedTest& test, const SmartTest& c, const SmartResults& s) {
    if (!c.learned.estimates.empty()) {
        to.add(named_values_of(c.learned.estimates.back().estimate));
        to.show({"learned_friction", "learned_friction_deviation", "learned_stiffness_ratio"});
    }
    if (!c.by_library())
        return to.show_sentence(c.library.not_used == "none was given" ? ""
                                                                       : sentence_of(c.library));
    const LibraryPrediction& p = c.library.predicted;
    to.add("library_friction", p.friction.value);
    to.add("library_friction_low", p.friction.low);
    to.add("library_friction_high", p.friction.high);
    to.add("library_distance", p.distance);
    to.add("members", sentence_of(*s.library, c.members));
    to.show({"library_friction"});
    show_prediction(to, test, c.library);
}

/// Errors of q and volumetric strain beyond the strains learned from.
void add_curve_errors(Report& to, const RecordedTest& test, const SmartTest& c,
                      const SmartResults& s) {
    const TestCurves &free = c.free.curves, fused = fused_curves(c, s.last_strain);
    const MeasuredCurves measured = at_strains_of(fused, test.curves);
    const auto error = [&](const TestCurves& curves, const Quantity& quantity, double strain) {
        return curve_difference(measured, curves, s.scored(strain), quantity);
    };
    constexpr const Quantity &q = quantity::deviatoric_stress,
                             &volume = quantity::volumetric_strain;
    add_errors(to, "q", "_Pa", error(free, q, to_the_end), error(fused, q, to_the_end));
    add_errors(to, "volumetric_strain", "", error(free, volume, to_the_end),
               error(fused, volume, to_the_end));
    if (s.last_strain > 0.04) { // at larger strain specimens diverge
        to.add("error_ratio_q_to_4_percent", error(fused, q, 0.04) / error(free, q, 0.04));
        to.add("error_ratio_volumetric_strain_to_4_percent",
               error(fused, volume, 0.04) / error(free, volume, 0.04));
    }
    if (!c.by_library()) return;
    const TestCurves &member = c.running.front().curves, &without = c.library.prior.curves;
    to.add("error_ratio_q_over_prior", error(fused, q, to_the_end) / error(without, q, to_the_end));
    to.add("error_ratio_volumetric_strain_over_prior",
           error(fused, volume, to_the_end) / error(without, volume, to_the_end));
    to.add("error_ratio_q_of_member", error(member, q, to_the_end) / error(free, q, to_the_end));
    to.add("error_ratio_volumetric_strain_of_member",
           error(member, volume, to_the_end) / error(free, volume, to_the_end));
    to.add("member_difference_from_library",
           difference_from(*s.library, c.members.front().index,
                           pressure_index(*s.library, test.pressure), c.running.front()));
}

/// Errors of the rings at the end of the test.
void add_ring_errors(Report& to, const RecordedTest& test, const SmartTest& c) {
    const ModelRun& fused = c.running.front();
    const Misfit without = misfit_of(test, c.free);
    if (!c.by_library()) {
        add_errors(to, "ring_strain", "", without.ring_strain, misfit_of(test, fused).ring_strain);
        return;
    }
    if (!c.rings.not_made.empty()) return;
    const auto measured = ring_strains(test.curves, c.rings.strain);
    const double error = ring_difference(c.rings.mean, measured);
    add_errors(to, "ring_strain", "",
               ring_difference(ring_strains(c.free.curves, c.rings.strain), measured), error);
    to.add("fused_rings_over_mean_profile", error / ring_difference(c.rings.scaled_mean, measured));
}

/// Errors (m) of the displacements of the sensor rocks at the coarse strains of the library: by the
/// model alone, and predicted.
struct SensorErrors {
    double free = std::nan(""), fused = std::nan("");
};
SensorErrors sensor_errors(const RecordedTest& test, const SmartTest& c, const SmartResults& s) {
    const SpecimenLibrary& library = *s.library;
    if (!reason_against_sensors(library, test).empty()) return {};
    const MonotonicStage stages(c.free.curves);
    double free = 0, fused = 0, count = 0;
    for (std::size_t k = 0; k < library.axis.coarse_count(); ++k) {
        const double strain = library.axis.coarse_strain(k);
        const auto stage = stages.nearest(strain, 1e-6);
        if (!s.scored(s.last_strain).holds(strain) || !stage) continue;
        for (std::size_t r = 0; r < library.sensors; ++r) {
            const auto recorded = recorded_displacement(library, test, r, k);
            if (!recorded) continue;
            const SensorInfo& info = test.recordings[r].info;
            Vec3 predicted;
            for (std::size_t axis = 0; axis < 3; ++axis)
                predicted[static_cast<Eigen::Index>(axis)] =
                    c.library.predicted.motion
                        .column(quantity::sensor_motion, r * LibraryTest::per_sensor + axis)
                        .values[k];
            free += (polar(c.free.displacement[*stage][r], {info.x, info.y, info.z}) - *recorded)
                        .squaredNorm();
            fused += (predicted - *recorded).squaredNorm();
            ++count;
        }
    }
    return {std::sqrt(free / count), std::sqrt(fused / count)};
}

void add_sensor_errors(Report& to, const RecordedTest& test, const SmartTest& c,
                       const SmartResults& s) {
    const StrainRange range = s.scored(to_the_end);
    const SensorErrors errors =
        c.by_library()
            ? sensor_errors(test, c, s)
            : SensorErrors{misfit_of(test, c.free, range).sensor_displacement,
                           misfit_of(test, c.running.front(), range).sensor_displacement};
    add_errors(to, "sensor_displacement", "_m", errors.free, errors.fused);
}

/// Errors of a test whose runs have all ended.
void add_comparison(Report& to, const RecordedTest& test, const SmartTest& c,
                    const SmartResults& s) {
    const ModelRun& fused = c.running.front();
    const auto last_q = [](const TestCurves& curves) {
        return three_digits(
            curves.empty() ? std::nan("") : curves[quantity::deviatoric_stress].back(), "Pa");
    };
    if (!c.by_library()) {
        to.show_row("last q measured", last_q(test.curves));
        to.show_row("last q fused", last_q(fused.curves));
        to.show_row("last q of DEM only", last_q(c.free.curves));
    }
    add_curve_errors(to, test, c, s);
    add_ring_errors(to, test, c);
    add_sensor_errors(to, test, c, s);
    if (!s.nudged) return; // there are no corrections
    to.add("measurements_accepted", fused.accepted);
    to.add("fusion_work_over_boundary_work", fused.fusion_work / fused.boundary_work);
    to.show({"measurements_accepted", "fusion_work_over_boundary_work"});
}

} // namespace

bool SmartTest::complete() const {
    const auto ended = [](const ModelRun& run) { return run.stopped.empty(); };
    return ended(free) && !running.empty() && std::ranges::all_of(running, ended);
}

void add_results(Report& summary, const RecordedTest& test, const SmartTest& c,
                 const SmartResults& s) {
    Report to;
    add_learned(to, test, c, s);
    to.add("sensors_accepted", test.recordings.size() - test.refused());
    to.add("sensors_refused", test.refused());
    to.add("machine_channels_refused", refused_channels(test));
    to.show_row("sensors accepted", fmt::format("{} of {}", test.recordings.size() - test.refused(),
                                                test.recordings.size()));
    to.show({"machine_channels_refused"});
    if (c.complete()) add_comparison(to, test, c, s);
    summary.add_part(folder_of(test.pressure), to);
}

void write_runs(const std::filesystem::path& folder, const SmartTest& c, const SmartResults& s) {
    if (c.free.stopped.empty()) write_stages(folder / "dem_only.csv", c.free.curves);
    for (std::size_t m = 0; m < c.running.size(); ++m) {
        if (!c.running[m].stopped.empty()) continue;
        const std::string name =
            c.by_library()
                ? fmt::format("specimen_{}", s.library->specimens[c.members[m].index].number)
                : "fused";
        write_stages(folder / (name + ".csv"), c.running[m].curves);
    }
}

void draw_results(const std::filesystem::path& out, const std::vector<RecordedTest>& tests,
                  const std::vector<SmartTest>& computed, double learned_strain) {
    constexpr auto of_fused = "fused (dashed: 90 % band)";
    std::vector<Plot> panels;
    for (std::size_t k = 0; k < tests.size(); ++k) {
        const SmartTest& c = computed[k];
        const bool learned = !c.by_library() && !c.running.empty();
        const ComparedTests compared{&tests[k].curves, &c.free.curves,
                                     learned ? &c.running.front().curves : nullptr};
        const auto panel = [&](const char* title, const char* x, const char* y,
                               const MakeCurve& make, std::vector<Curve> by_library) {
            panels.push_back({.title = fmt::format("{} at {}", title, label_of(tests[k].pressure)),
                              .x_label = x,
                              .y_label = y,
                              .curves = compared_curves(compared, make)});
            if (by_library.empty()) return;
            panels.back().curves.pop_back(); // the place of the model that learns
            std::ranges::move(by_library, std::back_inserter(panels.back().curves));
        };
        const auto mark = [&] { mark_end_of_learning(panels.back(), learned_strain); };
        const auto with_members = [&](const Quantity& quantity) {
            if (!c.by_library()) return std::vector<Curve>{};
            std::vector<Curve> curves =
                curves_with_band(c.library.predicted.curves, quantity, of_fused);
            const char* name = c.running.size() == 1 ? "favoured specimen" : "favoured specimens";
            for (const ModelRun& run : c.running)
                curves.push_back(
                    curve_of(&run == &c.running.front() ? name : "", run.curves, quantity));
            return curves;
        };
        panel("Deviatoric stress", "axial strain (%)", "q (kPa)",
              curves_of(quantity::deviatoric_stress), with_members(quantity::deviatoric_stress));
        mark();
        panel("Volumetric strain", "axial strain (%)", "volumetric strain (%)",
              curves_of(quantity::volumetric_strain), with_members(quantity::volumetric_strain));
        mark();
        panel("Rings at the end of the test", "radial strain, widening positive (%)",
              "ring, from below", profile_of,
              c.rings.not_made.empty() ? curves_of(c.rings, of_fused) : std::vector<Curve>{});
    }
    draw_plots(out / "smart_triaxial.png", panels, 3);
    for (std::size_t k = 0; k < tests.size(); ++k)
        if (!computed[k].views.empty())
            draw_picture(out / folder_of(tests[k].pressure) / "smart_rocks.png", computed[k].views,
                         {.azimuth = 0.3, .elevation = 0.15}, 700);
}

} // namespace bris
