#include "engine/io/csv.hpp"
#include "engine/io/plot.hpp"
#include "engine/report.hpp"
#include "scenarios/ensemble/compared_curves.hpp"
#include "scenarios/ensemble/layouts.hpp"
#include "scenarios/ensemble/learning_results.hpp"
#include "scenarios/ensemble/twin_experiment.hpp"
#include "scenarios/triaxial/triaxial_results.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>
#include <optional>

namespace bris {

namespace {

constexpr std::array shell_names{"sensors", "shell_1", "shell_2", "shell_3", "shell_4"};

/// Calls visit(name, unit, error) for each error of a run; errors of rocks for the first `shells`
/// shells only.
void visit_errors(const TwinErrors& e, std::size_t shells, auto&& visit) {
    visit("q", "Pa", e.q);
    visit("volumetric_strain", "", e.volumetric_strain);
    visit("ring_radius", "m", e.ring_radius);
    for (std::size_t s = 0; s < shells; ++s)
        visit(fmt::format("displacement_{}", shell_names[s]), "m", e.displacement[s]);
    for (std::size_t s = 0; s < shells; ++s)
        visit(fmt::format("rotation_{}", shell_names[s]), "rad", e.rotation[s]);
}

/// Whether an error is shown, and not only written: stress, and the rocks with sensors and next to
/// them.
bool is_shown(const std::string& error) {
    return error == "q" || error == "displacement_sensors" || error == "displacement_shell_1";
}

/// What the sensors contributed to a run.
void add_fusion(Report& own, const ModelRun& run, bool computed) {
    own.add("measurements_accepted", run.accepted);
    own.add("measurements_refused", run.refused);
    own.show({"measurements_accepted", "measurements_refused"});
    if (computed) return own.add("sensors_inconsistent_from", run.inconsistent_from);
    own.add("fusion_work_over_boundary_work", run.fusion_work / run.boundary_work);
    own.add("corrections_reduced", run.reduced);
    own.add("corrections_withheld", run.withheld);
    own.show({"fusion_work_over_boundary_work"});
}

} // namespace

std::size_t TwinExperiment::shells() const {
    return t_.mismatch.packing > 0 ? 1 : shell_names.size();
}

void TwinExperiment::add_variant(Report& summary, std::size_t k, const TwinErrors* of_free) const {
    const std::string& name = variants_[k].name;
    Report own;
    std::map<std::string, double> free;
    if (of_free && kinds_[k] != TwinVariant::free)
        visit_errors(*of_free, shells(),
                     [&](const std::string& what, const char*, double e) { free[what] = e; });
    visit_errors(errors_of(runs_[k], truth_), shells(),
                 [&](const std::string& what, const char* unit, double e) {
                     const std::string error =
                                           fmt::format("rmse_{}{}{}", what, *unit ? "_" : "", unit),
                                       ratio = "error_ratio_" + what;
                     own.add(error, e);
                     if (is_shown(what)) own.show({error});
                     if (!free.contains(what)) return;
                     own.add(ratio, e / free.at(what));
                     if (is_shown(what)) own.show({ratio});
                 });
    own.add("steps", runs_[k].steps);
    own.add("wall_time_s", runs_[k].wall_time);
    own.add_part("", properties(runs_[k]));
    if (!variants_[k].trajectories.empty()) add_fusion(own, runs_[k], is_computed(kinds_[k]));
    summary.add_part(name, own);
}

Report TwinExperiment::properties(const ModelRun& run) const {
    const TriaxialProperties p = properties_of(run.curves, test_.confining_pressure);
    Report own;
    own.add("secant_modulus_E50_Pa", p.secant_modulus);
    own.add("poisson_ratio_E50", p.poisson_ratio);
    own.add("peak_friction_angle_deg", p.peak_friction_angle);
    own.show({"secant_modulus_E50_Pa", "peak_friction_angle_deg"});
    return own;
}

/// Adds the differences between the specimens of model and truth at the start of shearing.
void TwinExperiment::add_starts(Report& summary) const {
    if (!model_) return;
    const auto put = [&](const std::string& whose, const ModelRun& run) {
        summary.add(whose + "_core_porosity", run.core_porosity);
        summary.add(whose + "_coordination_number",
                    run.curves[quantity::coordination_number].front());
    };
    put("truth", truth_);
    summary.add("learning_specimen_scatter", learning_.specimen_scatter);
    const ModelRun* model = assimilated_ ? &assimilated_->learned.first.runs.front() : nullptr;
    for (std::size_t k = 0; k < variants_.size(); ++k)
        if (!is_computed(kinds_[k]) && (model == nullptr || kinds_[k] == TwinVariant::free))
            model = &runs_[k];
    if (model == nullptr) return; // no variant runs it
    put("model", *model);
    const StartDifference apart = start_difference(*model, truth_);
    summary.add("model_start_error_sensors_mm", 1e3 * apart.sensor_distance);
    summary.add("model_start_rotation_error_sensors_rad", apart.sensor_angle);
    if (t_.mismatch.packing > 0) return; // its other rocks are not those of the truth
    summary.add("model_start_error_mm", 1e3 * apart.distance);
    summary.add("model_start_rotation_error_rad", apart.angle);
}

/// Adds the estimates of friction and stiffness.
void TwinExperiment::add_learned(Report& summary, const Assimilated& assimilated) const {
    const auto& estimates = assimilated.learned.estimates;
    const Gaussian last =
        estimates.empty() ? prior_of(t_.model, learning_) : estimates.back().estimate;
    summary.add(named_values_of(last));
    summary.show({"learned_friction", "learned_stiffness_ratio"});
    summary.add("learned_squared_distance_of_truth",
                squared_distance(last, logarithms_of({test_.friction, 1})));
    summary.add("learning_wall_time_s", assimilated.wall);
    summary.add("learning_outlying_displacements", assimilated.outliers);
    for (const auto& [what, scatter] :
         {std::pair{"displacements", &assimilated.scatter.displacement},
          std::pair{"rotations", &assimilated.scatter.rotation}}) {
        if (scatter->correlation.length <= 0) continue;
        summary.add(fmt::format("correlation_of_{}", what), scatter->correlation.near);
        summary.add(fmt::format("correlation_of_{}_length_m", what), scatter->correlation.length);
    }
    write_estimates(common_.out / "learned.csv", estimates);
    write_members(common_.out / "members.csv", assimilated.learned.second);
}

void TwinExperiment::draw() const {
    const auto free = std::ranges::find(kinds_, TwinVariant::free);
    const auto first = static_cast<std::size_t>(free - kinds_.begin());
    const auto panel = [&](const char* title, const Quantity& quantity) {
        // the truth takes the place of the measurements; other variants have colours of their own
        Plot plot{.title = title,
                  .x_label = "axial strain (%)",
                  .y_label = title,
                  .curves = compared_curves(
                      {&truth_.curves, free != kinds_.end() ? &runs_[first].curves : nullptr},
                      curves_of(quantity))};
        plot.curves.front().label = "truth";
        for (std::size_t k = 0; k < variants_.size(); ++k)
            if (kinds_[k] != TwinVariant::free)
                plot.curves.push_back(curve_of(variants_[k].name, runs_[k].curves, quantity));
        if (assimilated_) mark_end_of_learning(plot, learning_.final_strain);
        return plot;
    };
    draw_plots(common_.out / "twin.png",
               {panel("q (kPa)", quantity::deviatoric_stress),
                panel("volumetric strain (%)", quantity::volumetric_strain)});
}

void TwinExperiment::report() const {
    Report summary;
    const auto free = std::ranges::find(kinds_, TwinVariant::free);
    std::optional<TwinErrors> of_free;
    if (free != kinds_.end())
        of_free = errors_of(runs_[static_cast<std::size_t>(free - kinds_.begin())], truth_);
    for (std::size_t k = 0; k < variants_.size(); ++k)
        add_variant(summary, k, of_free ? &*of_free : nullptr);
    summary.add_part("truth", properties(truth_));
    add_starts(summary);
    summary.add("sensors_refused", observations_->refused);
    summary.show({"sensors_refused"});
    if (assimilated_) add_learned(summary, *assimilated_);
    for (std::size_t k = 0; k < variants_.size(); ++k)
        if (!runs_[k].analyses.empty())
            write_records(common_.out / fmt::format("analyses_{}.csv", variants_[k].name),
                          runs_[k].analyses, "axial_strain");
    draw();
    if (t_.layouts && assimilated_)
        write_layouts(common_.out / "layouts.csv",
                      try_layouts(truth_, assimilated_->forecast, assimilated_->scatter,
                                  {.position_noise = t_.sensors.position_noise,
                                   .attitude_noise = t_.sensors.attitude_noise,
                                   .seed = common_.seed}));
    summary.show_sentence("Errors are root mean squares over the test, and ratios are those of a "
                          "variant over those of the model without assimilation (free).");
    if (t_.mismatch.packing > 0)
        summary.show_sentence("The model has another packing: only its sensor rocks are those of "
                              "the truth, so there are no errors of other rocks.");
    report_results(common_, summary);
}

} // namespace bris
