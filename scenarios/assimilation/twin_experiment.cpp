#include "scenarios/assimilation/twin_experiment.hpp"

#include "engine/choice.hpp"
#include "engine/random.hpp"
#include "engine/stopwatch.hpp"
#include "scenarios/assimilation/checkpointed_run.hpp"
#include "scenarios/assimilation/twin_variants.hpp"
#include "scenarios/recordings/recorded_test.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace bris {

namespace {

/// Settings of learning with the scatter of ln q between specimens: as given, or if none is given,
/// as measured for the mismatch of this experiment.
Learning learning_for(const TwinSettings& t) {
    Learning learning = t.learning;
    if (learning.specimen_scatter < 0) learning.specimen_scatter = t.mismatch.specimen_scatter();
    return learning;
}

} // namespace

TwinExperiment::TwinExperiment(const TwinSettings& settings, const Common& common)
    : t_(settings), common_(common),
      learning_(learning_for(t_)), true_{make_scene(t_.triaxial, common.seed), {}},
      names_(names_of_variants(t_.variants)), test_(t_.triaxial.test),
      progress_(make_progress(common)) {
    test_.confining_pressure = t_.triaxial.confining_pressure.front();
}

// Name of the data set from which the ensemble members learn. Variants with the same data set share
// the result.
std::string TwinExperiment::data_set_of(const std::string& variant) const {
    const bool sensors_uninformative = t_.sensors.mode == "inertial" || !learning_.by_sensors;
    const bool own = variant == "sensors_only" ||
                     (!sensors_uninformative && (variant == "load_cell" || variant == "null"));
    return own ? variant : "all";
}

ModelVariant TwinExperiment::variant_of(const std::string& name) const {
    ModelVariant variant{.name = name, .rocks = t_.model, .corrections = t_.corrections};
    variant.corrections.filter.kind = named<FilterKind>(filter_names, t_.filter);
    if (name == "perturbed") {
        variant.rocks = {test_.friction, 1};
        variant.disturbance = t_.disturbance;
    }
    if (learns(name)) {
        variant.learned =
            schedule_of(assimilated_.at(data_set_of(name)).learned.estimates, t_.model, t_.change);
        variant.catch_up = t_.catch_up;
    }
    if (is_corrected(name)) {
        const SensorObservations& observations =
            *(name == "null" ? observations_of_another_ : observations_);
        variant.trajectories = observations.trajectories;
        variant.corrections.position_noise = observations.position_noise;
        variant.corrections.attitude_noise = observations.attitude_noise;
    }
    if (name == "inserted" || name == "spread") variant.corrections.nudging.stiffness = 0;
    variant.corrections.sample_delay = t_.sample_delay;
    variant.corrections.note_every = t_.sensors.interval;
    variant.corrections.spread = name == "spread";
    return variant;
}

void TwinExperiment::make_specimens() {
    true_.state = make_specimen(true_.scene, test_, common_, progress_slot(progress_)).state;
    if (t_.mismatch.any())
        model_ = make_model_specimen(t_.triaxial, test_, true_, t_.mismatch, common_,
                                     progress_slot(progress_));
    progress_.pause();
    if (t_.mismatch.packing > 0)
        fmt::print(
            "another packing: only the sensor rocks correspond to rocks of the truth, so the "
            "errors of all other rocks are omitted\n");
}

std::vector<ModelRun> TwinExperiment::run_all(const std::vector<ModelVariant>& variants,
                                              double strain) {
    std::vector<const PreparedSpecimen*> specimens;
    for (const ModelVariant& variant : variants) specimens.push_back(&specimen_of(variant.name));
    return run_models(specimens, test_, variants, strain, common_, progress_);
}

/// The truth of another specimen, packed around sensor rocks in the same positions.
ModelRun TwinExperiment::run_another() {
    const Common common = common_of_packing(common_, "another", common_.seed + 1000);
    const PreparedSpecimen another =
        make_another_packing(t_.triaxial, test_, true_.scene, 0, common, progress_slot(progress_));
    ModelRun run =
        run_models({&another}, test_, {{.name = "another truth", .rocks = {test_.friction, 1}}},
                   test_.final_axial_strain, common, progress_)
            .front();
    remove_checkpoints(common);
    return run;
}

Assimilated TwinExperiment::assimilate(const std::string& data_set,
                                       const SensorObservations& observations) {
    const auto began = this_instant();
    MeasuredTest measured = measured_test(this->measured());
    measured.trajectories = observations.trajectories;
    measured.displacement_noise = observations.position_noise;
    measured.sample_delay = t_.sample_delay;
    Learning learning = learning_;
    if (data_set == "load_cell") learning.by_sensors = false;
    if (data_set == "sensors_only") {
        learning.by_sensors = true;
        learning.by_force = learning.by_volume = false;
    }
    const Gaussian prior = prior_of(t_.model, learning);
    const PreparedSpecimen& specimen = specimen_of(data_set);
    const auto try_variants = [&](const std::vector<ModelVariant>& variants, double strain) {
        return try_models(specimen.scene, test_, specimen.state, variants, strain, common_,
                          progress_);
    };
    if (!first_)
        first_ = run_members(prior, learning.members, "first", learning.first_strain, try_variants);
    const auto is_forecast = [&](const std::string& variant) {
        return is_computed(variant) && data_set_of(variant) == data_set;
    };
    const bool all_the_way = std::ranges::any_of(names_, is_forecast);
    Assimilated assimilated{
        .learned =
            learn_on(prior, *first_, measured, learning,
                     all_the_way ? test_.final_axial_strain : learning.final_strain, try_variants)};
    if (learning.by_sensors)
        assimilated.outliers = outlying_displacements(assimilated.learned.second, measured);
    if (all_the_way) {
        assimilated.forecast = ensemble_forecast(assimilated.learned, prior);
        assimilated.scatter = scatter_of(assimilated.learned.second);
    }
    assimilated.wall = seconds_since(began);
    return assimilated;
}

/// Measurements of the truth by the test machine.
std::vector<TriaxialPoint> TwinExperiment::measured() const {
    std::vector<TriaxialPoint> points = truth_.points;
    Random random(common_.seed, 999);
    for (TriaxialPoint& p : points)
        p.deviatoric_stress *= 1 + t_.learning.force_noise * random.normal();
    return points;
}

/// Forecast of a variant's ensemble members. If the variant uses sensors, the analysis that extends
/// their recordings to all rocks.
ModelRun TwinExperiment::compute(const ModelVariant& variant) {
    const Assimilated& assimilated = assimilated_.at(data_set_of(variant.name));
    if (variant.trajectories.empty()) return assimilated.forecast;
    return compute_analysis(assimilated.forecast, assimilated.scatter,
                            {sensor_rocks(truth_), variant.trajectories,
                             variant.corrections.position_noise, variant.corrections.attitude_noise,
                             t_.sample_delay});
}

void TwinExperiment::record(const RecordingSettings& settings) const {
    const auto recordings = record_sensors(truth_, settings, common_.seed);
    const auto points = measured();
    if (t_.record_format == "csv")
        return write_recorded_test(t_.record, test_.confining_pressure, recordings,
                                   true_.scene.specimen, true_.scene.poses, points);
    std::vector<double> time;
    for (const TriaxialPoint& p : points)
        time.push_back(settings.rest + p.axial_strain / 1e-4 * settings.stage_time);
    write_recorded_test_hdf5(t_.record, test_.confining_pressure, recordings, true_.scene.specimen,
                             true_.scene.poses, points, time);
}

void TwinExperiment::run() {
    make_specimens();
    truth_ = run_all({{.name = "truth", .rocks = {test_.friction, 1}}}, test_.final_axial_strain)
                 .front();
    if (!t_.record.empty()) {
        const RecordingSettings settings{.interval = t_.sensors.interval,
                                         .imu = t_.sensors.imu,
                                         .displacement_noise = t_.sensors.position_noise,
                                         .attitude_noise = t_.sensors.attitude_noise};
        record(settings);
    }
    observations_ = observe_sensors(truth_, t_.sensors, common_.seed);
    if (std::ranges::count(names_, "null") > 0)
        observations_of_another_ = observe_sensors(run_another(), t_.sensors, common_.seed);
    for (const std::string& name : names_)
        if (learns(name) && !assimilated_.contains(data_set_of(name)))
            assimilated_[data_set_of(name)] = assimilate(
                data_set_of(name), *(name == "null" ? observations_of_another_ : observations_));
    std::vector<ModelVariant> to_run;
    for (const std::string& name : names_) {
        variants_.push_back(variant_of(name));
        if (!is_computed(name)) to_run.push_back(variants_.back());
    }
    auto runs = run_all(to_run, test_.final_axial_strain);
    auto next = runs.begin();
    for (const ModelVariant& variant : variants_)
        runs_.push_back(is_computed(variant.name) ? compute(variant) : std::move(*next++));
}

} // namespace bris
