#include "scenarios/ensemble/twin_experiment.hpp"

#include "engine/choice.hpp"
#include "engine/random.hpp"
#include "engine/stopwatch.hpp"
#include "scenarios/ensemble/checkpointed_run.hpp"
#include "scenarios/records/recorded_test.hpp"
#include "scenarios/specimens/recorded_motion.hpp"

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

const std::vector<std::string>& texts_of(RecordingFormat) {
    static const std::vector<std::string> texts{"csv", "hdf5"};
    return texts;
}

TwinExperiment::TwinExperiment(const TwinSettings& settings, const Common& common)
    : t_(settings), common_(common),
      learning_(learning_for(t_)), true_{make_scene(t_.triaxial, common.seed), {}},
      kinds_(variants_in(t_.variants)), test_(t_.triaxial.test), progress_(make_progress(common)) {
    test_.confining_pressure = t_.triaxial.confining_pressure.front();
}

ModelVariant TwinExperiment::model_variant(TwinVariant kind) const {
    ModelVariant variant{.name = text_of(kind), .rocks = t_.model, .corrections = t_.corrections};
    if (kind == TwinVariant::inserted) variant.corrections.nudging.stiffness = 0;
    if (kind == TwinVariant::free) return variant;
    variant.trajectories = observations_->trajectories;
    variant.corrections.position_noise = observations_->position_noise;
    variant.corrections.attitude_noise = observations_->attitude_noise;
    return variant;
}

void TwinExperiment::make_specimens() {
    true_.state = make_specimen(true_.scene, test_, common_, progress_slot(progress_)).state;
    if (t_.mismatch.any())
        model_ = make_model_specimen(t_.triaxial, test_, true_, t_.mismatch, common_,
                                     progress_slot(progress_));
    progress_.pause();
}

std::vector<ModelRun> TwinExperiment::run_all(const PreparedSpecimen& specimen,
                                              const std::vector<ModelVariant>& variants) {
    return run_models(std::vector(variants.size(), &specimen), test_, variants,
                      test_.final_axial_strain, common_, progress_);
}

/// Learns friction and stiffness from the test machine and the sensors, by ensemble members that
/// run to the end of the test.
Assimilated TwinExperiment::assimilate() {
    const auto began = this_instant();
    const Measurements measured{this->measured(), observations_->trajectories,
                                observations_->position_noise};
    const Gaussian prior = prior_of(t_.model, learning_);
    const PreparedSpecimen& specimen = model_specimen();
    Assimilated assimilated{.learned = learn_in_two_generations(
                                prior, measured, learning_, test_.final_axial_strain,
                                [&](const std::vector<ModelVariant>& variants, double strain) {
                                    return try_models(specimen.scene, test_, specimen.state,
                                                      variants, strain, common_, progress_);
                                })};
    if (learning_.by_sensors)
        assimilated.outliers = outlying_displacements(assimilated.learned.second, measured);
    assimilated.forecast = ensemble_forecast(assimilated.learned, prior);
    assimilated.scatter = scatter_of(assimilated.learned.second);
    assimilated.wall = seconds_since(began);
    return assimilated;
}

/// Measurements of the truth by the test machine.
MeasuredCurves TwinExperiment::measured() const {
    MeasuredCurves curves(truth_.curves);
    Random random(common_.seed, 999);
    for (double& q : curves[quantity::deviatoric_stress])
        q *= 1 + t_.learning.force_noise * random.normal();
    return curves;
}

/// The forecast of the ensemble members, with the recordings of the sensors extended to all rocks.
ModelRun TwinExperiment::compute_analysis_of(const ModelVariant& variant) const {
    return compute_analysis(assimilated_->forecast, assimilated_->scatter,
                            {sensor_rocks(truth_), variant.trajectories,
                             variant.corrections.position_noise,
                             variant.corrections.attitude_noise});
}

void TwinExperiment::record(const RecordingSettings& settings) const {
    const SpecimenSettings& specimen = true_.scene.specimen;
    const auto recordings =
        with_poses(record_sensors(truth_, settings, common_.seed), specimen, true_.scene.poses);
    const MeasuredCurves curves = measured();
    if (t_.record_format == RecordingFormat::csv)
        return write_recorded_test(t_.record, test_.confining_pressure, recordings, curves);
    std::vector<double> time;
    for (const double strain : curves[quantity::axial_strain])
        time.push_back(settings.rest + strain / 1e-4 * settings.stage_time);
    write_recorded_test_hdf5(t_.record, test_.confining_pressure, recordings, curves, time,
                             pi * specimen.radius * specimen.radius);
}

void TwinExperiment::run() {
    make_specimens();
    truth_ = run_all(true_, {{.name = "truth", .rocks = {test_.friction, 1}}}).front();
    if (!t_.record.empty()) {
        const RecordingSettings settings{.interval = t_.sensors.interval,
                                         .imu = t_.sensors.imu,
                                         .displacement_noise = t_.sensors.position_noise,
                                         .attitude_noise = t_.sensors.attitude_noise};
        record(settings);
    }
    observations_ = observe_sensors(truth_, t_.sensors, common_.seed);
    if (std::ranges::any_of(kinds_, is_computed)) assimilated_ = assimilate();
    std::vector<ModelVariant> to_run;
    for (const TwinVariant kind : kinds_) {
        variants_.push_back(model_variant(kind));
        if (!is_computed(kind)) to_run.push_back(variants_.back());
    }
    auto runs = run_all(model_specimen(), to_run);
    auto next = runs.begin();
    for (std::size_t k = 0; k < kinds_.size(); ++k)
        runs_.push_back(is_computed(kinds_[k]) ? compute_analysis_of(variants_[k])
                                               : std::move(*next++));
}

} // namespace bris
