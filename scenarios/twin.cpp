// Twin experiment: the sensor rocks of a true triaxial test are recorded, and a model of it with
// other parameters is run without and with the recordings. The experiment measures how much better
// the model then predicts the other rocks. A run with the true parameters from a start disturbed by
// less than a grain of dust gives the divergence of perturbed runs, the error below which no model
// can get. The model may also have rocks of other shapes, rocks in other positions, or another
// packing.
#include "scenarios/assimilation/twin.hpp"

#include "engine/errors.hpp"
#include "engine/io/csv.hpp"
#include "engine/io/plot.hpp"
#include "engine/random.hpp"
#include "engine/scenario.hpp"
#include "engine/signal/attitude.hpp"
#include "engine/stopwatch.hpp"
#include "engine/summary.hpp"
#include "scenarios/assimilation/checkpointed_run.hpp"
#include "scenarios/assimilation/compared_curves.hpp"
#include "scenarios/assimilation/generations.hpp"
#include "scenarios/assimilation/layouts.hpp"
#include "scenarios/assimilation/learning_results.hpp"
#include "scenarios/assimilation/model_specimen.hpp"
#include "scenarios/assimilation/run_models.hpp"
#include "scenarios/recordings/recorded_test.hpp"
#include "scenarios/triaxial/triaxial_results.hpp"
#include "scenarios/verification/names.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>
#include <optional>
#include <sstream>

namespace bris {

namespace {

constexpr std::array<std::string_view, 12> variant_names{
    "free", "perturbed", "inserted",     "spread",   "nudged",   "learned",
    "both", "load_cell", "sensors_only", "ensemble", "analysis", "null"};

struct Twin {
    Triaxial triaxial;
    RockParameters model{0.5, 1};
    ModelMismatch mismatch;
    std::string variants = "free,perturbed,learned,ensemble,analysis";
    std::filesystem::path record;
    std::string record_format = "csv";
    double disturbance = 1e-7, change = 0.03, sample_delay = 0;
    SensorSettings sensors;
    bool catch_up = true, layouts = false;
    Learning learning;
    Corrections corrections;
    std::string filter = "corrected";

    Twin() {
        triaxial.confining_pressure = {55e3};
        triaxial.test.final_axial_strain = 0.025;
        corrections.nudging = {5e6, 100, 0.01}; // force of about the contact forces at 55 kPa
        corrections.largest_shift = 1e-6;
        corrections.largest_work_share = 0.005;
        learning.specimen_scatter = -1;
    }
    void describe(auto& option) {
        option.group("Twin experiment");
        option(
            "variants", variants, "",
            "Variants of the model, separated by commas. none: run the truth only. free: no "
            "assimilation. perturbed: the true parameters from a disturbed start. inserted: "
            "direct insertion of the sensor rocks' poses, as in the SmartRock report. spread: "
            "direct insertion that also moves all other rocks. nudged: sensor rocks nudged by "
            "springs of bounded force. learned: estimated friction and stiffness. both: learned "
            "and nudged. ensemble: forecast of the ensemble members that learned. load_cell, "
            "sensors_only: the same, learned without the sensors or from them alone. analysis: "
            "ensemble, with the recordings of the sensors extended to all rocks. null: analysis "
            "with q of this specimen and sensors of another, which should bring no improvement.");
        option("model_friction", model.friction, "",
               "Friction coefficient between rocks in the model. The true one is --friction.",
               above(0, 100));
        option("model_stiffness", model.stiffness, "",
               "Contact stiffness in the model, relative to the true one.", above(0, 1e6));
        mismatch.describe(option);
        option("disturbance", disturbance, "m",
               "Random displacement of every rock at the start of the perturbed run.",
               within(0, 1));
        learning.describe(option);
        option("change", change, "",
               "Relative change of the estimated friction or stiffness from which the model takes "
               "over the new estimate.",
               above(0, 10));
        option("catch_up", catch_up, "",
               "Restart the model from the specimen with each new estimate. false: continue from "
               "the model's present state.");
        option("layouts", layouts, "",
               "Try other layouts of sensor rocks (how many, which ones, how often they are "
               "sampled) and write the error that remains in rocks without sensors (layouts.csv).");
        option("record", record, "",
               "Folder for the recordings of the truth's sensors, in the form that smart_triaxial "
               "reads. Empty: no recordings are written.");
        option("record_format", record_format, "", "Format of these recordings.", {"csv", "hdf5"});
        option("filter", filter, "",
               "Filter that turns recordings into corrections. printed: as printed in the "
               "SmartRock report. corrected: the same filter without its errors, as an error-state "
               "filter.",
               filter_names);
        option("sensor_mode", sensors.mode, "",
               "Observations by the sensors. ideal: displacement and attitude without error. "
               "tracked: displacement and attitude with noise. inertial: an inertial sensor with "
               "quality control, which observes tilt only.",
               sensor_modes);
        option("imu", sensors.imu, "",
               "Model of the inertial sensor for inertial and for --record.",
               {"lab-grade", "smartrock-like", "cheap"});
        option("interval", sensors.interval, "", "Axial strain between samples.", above(0, 1));
        option("injection_steps", corrections.injection_steps, "",
               "Number of time steps over which a correction is applied. 1: at once, as in the "
               "SmartRock report.",
               within(1, 1e6));
        option("largest_shift", corrections.largest_shift, "m",
               "Largest displacement of a sensor rock by direct insertion in a time step. 0: no "
               "limit.",
               within(0, 1));
        option("largest_work_share", corrections.largest_work_share, "",
               "Largest work of the corrections from one analysis to the next, relative to the "
               "work of platens and membrane. Corrections that cost more are reduced or refused. "
               "0: no limit.",
               within(0, 1));
        option("nudging_stiffness", corrections.nudging.stiffness, "N/m",
               "Stiffness of the critically damped springs that nudge sensor rocks.",
               above(0, 1e15));
        option("largest_nudging_force", corrections.nudging.largest_force, "N",
               "Largest force of spring and dashpot together.", within(0, 1e9));
        option("position_noise", sensors.position_noise, "m",
               "Standard deviation of tracked displacements.", above(0, 1));
        option("attitude_noise", sensors.attitude_noise, "rad",
               "Standard deviation of tracked attitudes.", above(0, 10));
        option("dropout", sensors.faults.dropout, "", "Fraction of samples that are lost.",
               within(0, 0.99));
        option("outliers", sensors.faults.outliers, "",
               "Fraction of samples that are wrong by 20 mm and half a radian.", within(0, 0.99));
        option("sample_delay", sample_delay, "", "Axial strain by which samples arrive late.",
               within(0, 1));
        option("lag", corrections.filter.lag, "",
               "Number of samples by which late ones may lag behind and still be used for an "
               "inserted or nudged sensor rock. 0: late samples are refused.",
               within(0, 1e6));
        option("drift", corrections.filter.drift, "m2",
               "Variance of the model's displacement error that accumulates in a unit of axial "
               "strain.",
               within(0, 1e6));
        option("turning", corrections.filter.turning, "rad2",
               "Variance of the model's rotation error that accumulates in a unit of axial "
               "strain.",
               within(0, 1e6));
        triaxial.describe(option);
    }
};

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

/// Settings of learning with the scatter of ln q between specimens: as given, or if none is given,
/// as measured for the mismatch of this experiment.
Learning learning_for(const Twin& t) {
    Learning learning = t.learning;
    if (learning.specimen_scatter < 0) learning.specimen_scatter = t.mismatch.specimen_scatter();
    return learning;
}

std::vector<std::string> names_of_variants(const std::string& list) {
    std::vector<std::string> names;
    if (list == "none") return names; // only the truth is run, to record it
    std::string all;
    for (const std::string_view name : variant_names)
        all += fmt::format("{}{}", all.empty() ? "" : ", ", name);
    std::istringstream text(list);
    for (std::string name; std::getline(text, name, ',');) {
        require(std::ranges::count(variant_names, name) == 1,
                fmt::format("--variants: expected {}, found '{}'", all, name));
        require(std::ranges::count(names, name) == 0,
                fmt::format("--variants: expected each variant once, found '{}' twice", name));
        names.push_back(name);
    }
    return names;
}

/// Whether a variant is computed from the ensemble members, without a run of its own.
bool is_computed(const std::string& variant) {
    return variant == "ensemble" || variant == "load_cell" || variant == "sensors_only" ||
           variant == "analysis" || variant == "null";
}

/// Whether a variant is corrected by the recordings of the sensors.
bool is_corrected(const std::string& variant) {
    constexpr std::array<std::string_view, 6> corrected{"inserted", "spread",   "nudged",
                                                        "both",     "analysis", "null"};
    return std::ranges::count(corrected, variant) > 0;
}

bool learns(const std::string& variant) {
    return variant == "learned" || variant == "both" || is_computed(variant);
}

/// Estimates from ensemble members, and their forecast.
struct Assimilated {
    Learned learned;
    ModelRun forecast = {};   // if a variant needs it
    RockScatter scatter = {}; // if a variant needs it
    std::size_t outliers = 0; // displacements that were rejected
    double wall = 0;
};

/// The pieces of one experiment.
class Experiment {
public:
    Experiment(const Twin& settings, const Common& common)
        : t_(settings), common_(common),
          learning_(learning_for(t_)), true_{make_scene(t_.triaxial, common.seed), {}},
          names_(names_of_variants(t_.variants)), test_(t_.triaxial.test),
          progress_(make_progress(common)) {
        test_.confining_pressure = t_.triaxial.confining_pressure.front();
    }
    void run();
    void report() const;

private:
    void add_variant(Summary& summary, std::size_t k, const TwinErrors* of_free) const;
    void add_properties(Summary& summary, const std::string& name, const ModelRun& run) const;
    void add_learned(Summary& summary, const std::string& name,
                     const Assimilated& assimilated) const;
    void write_smoothed() const;
    void draw() const;
    ModelVariant variant_of(const std::string& name) const;
    std::string data_set_of(const std::string& variant) const;
    Assimilated assimilate(const std::string& data_set, const SensorObservations& observations);
    ModelRun compute(const ModelVariant& variant);
    std::vector<TriaxialPoint> measured() const;
    void record(const RecordingSettings& settings) const;
    void make_specimens();
    const PreparedSpecimen& specimen_of(const std::string& variant) const {
        return model_ && variant != "truth" && variant != "perturbed" ? *model_ : true_;
    }
    /// Number of shells whose errors are reported. In another packing only the sensor rocks have
    /// the positions of the truth.
    std::size_t shells_of(const std::string& variant) const {
        return t_.mismatch.packing > 0 && variant != "perturbed" ? 1 : shell_names.size();
    }
    void add_starts(Summary& summary) const;
    std::vector<ModelRun> run_all(const std::vector<ModelVariant>& variants, double strain);
    ModelRun run_another();

    const Twin& t_;
    const Common& common_;
    Learning learning_;
    PreparedSpecimen true_;
    std::optional<PreparedSpecimen> model_; // if it differs from the truth's
    std::vector<std::string> names_;
    TriaxialSettings test_;
    Progress progress_;
    ModelRun truth_;
    std::optional<SensorObservations> observations_, observations_of_another_;
    std::optional<Ensemble> first_;                  // first generation, shared by all data sets
    std::map<std::string, Assimilated> assimilated_; // by data set; "all": all measurements
    std::vector<ModelVariant> variants_;
    std::vector<ModelRun> runs_;
};

// Name of the data set from which the ensemble members learn. Variants with the same data set share
// the result.
std::string Experiment::data_set_of(const std::string& variant) const {
    const bool sensors_uninformative = t_.sensors.mode == "inertial" || !learning_.by_sensors;
    const bool own = variant == "sensors_only" ||
                     (!sensors_uninformative && (variant == "load_cell" || variant == "null"));
    return own ? variant : "all";
}

ModelVariant Experiment::variant_of(const std::string& name) const {
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

void Experiment::make_specimens() {
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

std::vector<ModelRun> Experiment::run_all(const std::vector<ModelVariant>& variants,
                                          double strain) {
    std::vector<const PreparedSpecimen*> specimens;
    for (const ModelVariant& variant : variants) specimens.push_back(&specimen_of(variant.name));
    return run_models(specimens, test_, variants, strain, common_, progress_);
}

/// The truth of another specimen, packed around sensor rocks in the same positions.
ModelRun Experiment::run_another() {
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

Assimilated Experiment::assimilate(const std::string& data_set,
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
std::vector<TriaxialPoint> Experiment::measured() const {
    std::vector<TriaxialPoint> points = truth_.points;
    Random random(common_.seed, 999);
    for (TriaxialPoint& p : points)
        p.deviatoric_stress *= 1 + t_.learning.force_noise * random.normal();
    return points;
}

/// Forecast of a variant's ensemble members. If the variant uses sensors, the analysis that extends
/// their recordings to all rocks.
ModelRun Experiment::compute(const ModelVariant& variant) {
    const Assimilated& assimilated = assimilated_.at(data_set_of(variant.name));
    if (variant.trajectories.empty()) return assimilated.forecast;
    return compute_analysis(assimilated.forecast, assimilated.scatter,
                            {sensor_rocks(truth_), variant.trajectories,
                             variant.corrections.position_noise, variant.corrections.attitude_noise,
                             t_.sample_delay});
}

void Experiment::record(const RecordingSettings& settings) const {
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

void Experiment::run() {
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

void Experiment::add_variant(Summary& summary, std::size_t k, const TwinErrors* of_free) const {
    const std::string& name = variants_[k].name;
    const auto add = [&](const char* what, const auto& value) {
        summary.add(fmt::format("{}_{}", name, what), value);
    };
    std::map<std::string, double> free;
    if (of_free && name != "free")
        visit_errors(*of_free, shells_of("free"),
                     [&](const std::string& what, const char*, double e) { free[what] = e; });
    visit_errors(
        errors_of(runs_[k], truth_), shells_of(name),
        [&](const std::string& what, const char* unit, double e) {
            summary.add(fmt::format("{}_rmse_{}{}{}", name, what, *unit ? "_" : "", unit), e);
            if (free.contains(what))
                summary.add(fmt::format("{}_error_ratio_{}", name, what), e / free.at(what));
        });
    add("steps", runs_[k].steps);
    add("wall_time_s", runs_[k].wall_time);
    add_properties(summary, name, runs_[k]);
    if (variants_[k].trajectories.empty()) return;
    add("measurements_accepted", runs_[k].accepted);
    add("measurements_refused", runs_[k].refused);
    if (is_computed(name)) return add("sensors_inconsistent_from", runs_[k].inconsistent_from);
    add("fusion_work_over_boundary_work", runs_[k].fusion_work / runs_[k].boundary_work);
    add("samples_too_late", runs_[k].too_late);
    add("corrections_reduced", runs_[k].reduced);
    add("corrections_withheld", runs_[k].withheld);
    add("corrections_reduced_by_work", runs_[k].too_costly);
    add("corrections_withheld_by_work", runs_[k].much_too_costly);
    if (variants_[k].corrections.filter.lag == 0) return;
    const SmoothedErrors smoothed = errors_of_smoothed(runs_[k], truth_);
    add("smoothed_rmse_displacement_sensors_m", smoothed.displacement);
    add("smoothed_rmse_rotation_sensors_rad", smoothed.rotation);
    add("smoothed_squared_distance", smoothed.squared_distance);
}

void Experiment::add_properties(Summary& summary, const std::string& name,
                                const ModelRun& run) const {
    const TriaxialProperties properties = properties_of(run.points, test_.confining_pressure);
    summary.add(name + "_secant_modulus_E50_Pa", properties.secant_modulus);
    summary.add(name + "_poisson_ratio_E50", properties.poisson_ratio);
    summary.add(name + "_peak_friction_angle_deg", properties.peak_friction_angle);
}

/// Adds the differences between the specimens of model and truth at the start of shearing.
void Experiment::add_starts(Summary& summary) const {
    if (!model_) return;
    const auto put = [&](const std::string& whose, const ModelRun& run) {
        summary.add(whose + "_core_porosity", run.core_porosity);
        summary.add(whose + "_coordination_number", run.points.front().coordination);
    };
    put("truth", truth_);
    summary.add("learning_specimen_scatter", learning_.specimen_scatter);
    const ModelRun* model = first_ ? &first_->runs.front() : nullptr;
    for (std::size_t k = 0; k < variants_.size(); ++k)
        if (!is_computed(variants_[k].name) && &specimen_of(variants_[k].name) == &*model_ &&
            (model == nullptr || variants_[k].name == "free"))
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

/// Adds the estimates of a data set. Keys and files carry its name, except for the data set "all".
void Experiment::add_learned(Summary& summary, const std::string& name,
                             const Assimilated& assimilated) const {
    const std::string whose = name == "all" ? "" : name + "_";
    const auto& estimates = assimilated.learned.estimates;
    const Gaussian last =
        estimates.empty() ? prior_of(t_.model, learning_) : estimates.back().estimate;
    for (const NamedValue& v : describe(last))
        summary.add(NamedValue(whose + v.key, std::get<double>(v.value)));
    summary.add(whose + "learned_squared_distance_of_truth",
                squared_distance(last, logarithms_of({test_.friction, 1})));
    summary.add(whose + "learning_wall_time_s", assimilated.wall);
    summary.add(whose + "learning_outlying_displacements", assimilated.outliers);
    for (const auto& [what, scatter] :
         {std::pair{"displacements", &assimilated.scatter.displacement},
          std::pair{"rotations", &assimilated.scatter.rotation}}) {
        if (scatter->correlation.length <= 0) continue;
        summary.add(fmt::format("{}correlation_of_{}", whose, what), scatter->correlation.near);
        summary.add(fmt::format("{}correlation_of_{}_length_m", whose, what),
                    scatter->correlation.length);
    }
    const std::string file = name == "all" ? "" : "_" + name;
    write_estimates(common_.out / fmt::format("learned{}.csv", file), estimates);
    write_members(common_.out / fmt::format("members{}.csv", file), assimilated.learned.second);
}

/// Writes the smoothed trajectories of the sensor rocks.
void Experiment::write_smoothed() const {
    for (std::size_t k = 0; k < variants_.size(); ++k) {
        std::vector<std::vector<double>> rows;
        for (std::size_t rock = 0; rock < runs_[k].smoothed.size(); ++rock)
            for (const SmoothedPose& p : runs_[k].smoothed[rock]) {
                const Vec3 u = p.position - runs_[k].start[rock].position,
                           turn = attitude_error(p.attitude, runs_[k].start[rock].orientation);
                rows.push_back({static_cast<double>(rock + 1), p.time, u.x(), u.y(), u.z(),
                                turn.x(), turn.y(), turn.z(), p.position_deviation.norm(),
                                p.attitude_deviation.norm()});
            }
        if (!rows.empty())
            write_csv(common_.out / fmt::format("smoothed_{}.csv", variants_[k].name),
                      {"sensor", "axial_strain", "ux_m", "uy_m", "uz_m", "rotation_x_rad",
                       "rotation_y_rad", "rotation_z_rad", "deviation_m", "deviation_rad"},
                      rows, {}, 7);
    }
}

void Experiment::draw() const {
    const auto free = std::ranges::find(names_, "free");
    const auto first = static_cast<std::size_t>(free - names_.begin());
    const auto panel = [&](const char* title, double scale, double TriaxialPoint::*value) {
        // the truth takes the place of the measurements; other variants have colours of their own
        Plot plot{.title = title,
                  .x_label = "axial strain (%)",
                  .y_label = title,
                  .curves = compared_curves(
                      {&truth_.points, free != names_.end() ? &runs_[first].points : nullptr},
                      curves_of(scale, value))};
        plot.curves.front().label = "truth";
        for (std::size_t k = 0; k < variants_.size(); ++k)
            if (variants_[k].name != "free")
                plot.curves.push_back(curve_of(variants_[k].name, runs_[k].points, scale, value));
        return plot;
    };
    draw_plots(common_.out / "twin.png",
               {panel("q (kPa)", 1e-3, &TriaxialPoint::deviatoric_stress),
                panel("volumetric strain (%)", 100, &TriaxialPoint::volumetric_strain)});
}

void Experiment::report() const {
    Summary summary;
    const auto free = std::ranges::find(names_, "free");
    std::optional<TwinErrors> of_free;
    if (free != names_.end())
        of_free = errors_of(runs_[static_cast<std::size_t>(free - names_.begin())], truth_);
    for (std::size_t k = 0; k < variants_.size(); ++k)
        add_variant(summary, k, of_free ? &*of_free : nullptr);
    add_properties(summary, "truth", truth_);
    add_starts(summary);
    summary.add("sensors_refused", observations_->refused);
    for (const auto& [name, assimilated] : assimilated_) add_learned(summary, name, assimilated);
    write_smoothed();
    for (std::size_t k = 0; k < variants_.size(); ++k)
        if (!runs_[k].analyses.empty())
            write_records(common_.out / fmt::format("analyses_{}.csv", variants_[k].name),
                          runs_[k].analyses, "axial_strain");
    draw();
    if (t_.layouts && assimilated_.contains("all") &&
        !assimilated_.at("all").forecast.points.empty()) {
        const Assimilated& all_data = assimilated_.at("all");
        write_layouts(common_.out / "layouts.csv",
                      try_layouts(truth_, all_data.forecast, all_data.scatter,
                                  {.position_noise = t_.sensors.position_noise,
                                   .attitude_noise = t_.sensors.attitude_noise,
                                   .seed = common_.seed}));
    }
    report_results(common_, summary);
}

void run(const Twin& t, const Common& common) {
    require(t.triaxial.confining_pressure.size() == 1,
            "--confining-pressure: expected one pressure, found several");
    const bool faulty = t.sensors.faults.dropout > 0 || t.sensors.faults.outliers > 0;
    require(
        t.record.empty() || (!faulty && t.sample_delay == 0),
        "--record: expected no --dropout, --outliers or --sample-delay, which are not recorded");
    require(t.sensors.mode != "inertial" || !faulty,
            "--sensor-mode inertial: expected no --dropout or --outliers, which apply to tracked "
            "sensors only");
    const bool moved = t.mismatch.placement > 0 || t.mismatch.rotation > 0;
    require(
        t.mismatch.packing == 0 || !moved,
        "--model-packing: expected no --model-placement or --model-rotation, which move rocks from "
        "the positions of the truth");
    require(t.mismatch.packing == 0 || t.mismatch.packing != common.seed,
            "--model-packing: expected another seed than --seed");
    require(t.mismatch.packing == 0 || !t.layouts,
            "--layouts: expected no --model-packing, whose rocks are not the rocks of the truth");
    require(t.mismatch.spheres == 0 || t.mismatch.spheres >= 4,
            fmt::format("--model-spheres: expected 0 or 4 and more, found {}", t.mismatch.spheres));
    check_test(t.triaxial);
    require_memory_for(t.triaxial, common.threads, common.memory_limit);
    require_same_specimen(common);
    Experiment experiment(t, common);
    experiment.run();
    experiment.report();
    remove_checkpoints(common);
}

std::string explain(const Twin& t, const Common& common) {
    return explain_triaxial(t.triaxial, common);
}

} // namespace

} // namespace bris

int main(int argc, char** argv) {
    return bris::run_scenario<bris::Twin>(
        argc, argv,
        {"twin",
         "Twin experiment: records a simulated triaxial test and models it without and with the "
         "recordings."},
        bris::run, bris::explain);
}
