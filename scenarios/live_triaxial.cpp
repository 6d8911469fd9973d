// SMART computing during a test: records of a test machine and of SmartRocks arrive as a stream,
// and at every stage the model estimates friction, stiffness and the displacements of all rocks.
#include "engine/assets.hpp"
#include "engine/errors.hpp"
#include "engine/interrupt.hpp"
#include "engine/io/csv.hpp"
#include "engine/io/plot.hpp"
#include "engine/io/whole_file.hpp"
#include "engine/message.hpp"
#include "engine/report.hpp"
#include "engine/signal/median.hpp"
#include "engine/stopwatch.hpp"
#include "scenarios/ensemble/checkpointed_run.hpp"
#include "scenarios/ensemble/compared_curves.hpp"
#include "scenarios/ensemble/learning_results.hpp"
#include "scenarios/ensemble/live_model.hpp"
#include "scenarios/ensemble/live_test.hpp"
#include "scenarios/ensemble/misfit.hpp"
#include "scenarios/ensemble/run_models.hpp"
#include "scenarios/library/live_prediction.hpp"
#include "scenarios/library/live_results.hpp"
#include "scenarios/monitoring/preparation_time.hpp"
#include "scenarios/monitoring/test_report.hpp"
#include "scenarios/records/quality_control_report.hpp"
#include "scenarios/specimens/write_option.hpp"
#include "scenarios/stream/recorded_stream.hpp"
#include "scenarios/stream/run_broker.hpp"
#include "scenarios/triaxial/triaxial_results.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>

namespace bris {

namespace {

struct Live {
    Triaxial triaxial{.test = {.preparation = "report"}}; // as the example's specimen
    std::filesystem::path recordings = assets_folder() / "smartrock";
    std::filesystem::path stream;
    RunBrokerSettings broker;
    std::filesystem::path library = assets_folder() / "libraries";
    RockParameters model{0.5, 1};
    Learning learning{.specimen_scatter = 0.35, .by_volume = true};
    LiveSettings live;
    double stage_time = 1.2;
    WriteOption written;
    bool compare = true;
    unsigned catch_up = 3;

    Live() {
        triaxial.confining_pressure = {55e3};
        triaxial.test.final_axial_strain = 0.025;
    }
    void declare_options(auto& option) {
        option.group("Stream");
        option("stream", stream, "",
               "Source of the records, one JSON object or CSV line each: - (standard input), a "
               "growing file, a pipe, or a folder with recordings.csv and test.csv to replay; or "
               "stream.ndjson, the log of an earlier run. Default: the broker, or else the example "
               "at 55 kPa.");
        option("recordings", recordings, "",
               "Folder with a file rock_NN.txt for each sensor, which describes the sensor rock "
               "before the test.");
        option("timeout", live.timeout, "s",
               "Time without a record of the test machine after which the stream counts as ended "
               "and the model continues alone.",
               above(0, 1e7));
        option(
            "analysis_delay", live.analysis_delay, "",
            "Axial strain by which the analysis stays behind the test, to wait for late records.",
            within(0, 1));
        option("speed", live.speed, "",
               "Speed of a replay relative to the times of the records. 1: real time. 0: as fast "
               "as possible.",
               within(0, 1e6));
        option("stage_time", stage_time, "s",
               "Time that the test took for 0.01 % of axial strain. It applies to a replayed "
               "folder whose test.csv has no column t.",
               above(0, 1e6));
        option("rest", live.quality_control.rest, "s",
               "Time at the beginning during which the rocks are at rest.", above(0, 1e6));
        option("interval", live.quality_control.interval, "",
               "Axial strain between the samples that are used.", above(0, 1));
        option("use_displacement", live.quality_control.displacement, "",
               "Use the displacements ux, uy, uz where records contain them.");
        option("use_attitude", live.quality_control.attitude, "",
               "Use the attitudes qw, qx, qy, qz where records contain them. Otherwise only the "
               "tilt relative to gravity is used.");
        option.group("Broker");
        broker.declare_options(option);
        option.group("Model");
        option("model_friction", model.friction, "",
               "Friction coefficient between rocks in the prior (the median).", above(0, 100));
        option("model_stiffness", model.stiffness, "",
               "Contact stiffness in the prior (the median), relative to --clump-stiffness.",
               above(0, 1e6));
        option("compare", compare, "",
               "Compare the analysis with the model alone, which is run after the test.");
        option("catch_up", catch_up, "",
               "Number of stages that the second generation of ensemble members advances for each "
               "stage of the test until it has caught up.",
               within(2, 10000));
        learning.declare_options(option);
        option(
            "library", library, "",
            "Library of specimens (specimen_library), from which the measurements so far predict "
            "the rest of the test, if the library fits the model: a file, a folder of libraries, "
            "of which the one is used that fits, or none.");
        triaxial.declare_options(option);
        option.group("Files");
        written.declare_options(option, write_of_estimate);
    }
};

/// The path from which lines are read; a folder is written as lines first.
std::filesystem::path prepare_stream(const Live& s, const Common& common) {
    if (!std::filesystem::is_directory(s.stream)) return s.stream;
    std::string text;
    for (const std::string& line : stream_of(s.stream, s.stage_time, s.live.quality_control.rest))
        text += line + "\n";
    write_whole(common.out / "replay.ndjson", text);
    return common.out / "replay.ndjson";
}

std::vector<SensorInfo> infos_of(const Live& s) {
    return infos_of_test(s.recordings, s.triaxial.confining_pressure.front(),
                         read_sensor_infos(s.recordings));
}

class LiveRun {
public:
    LiveRun(const Live& settings, const Common& common)
        : s_(settings), common_(common), scene_(make_scene(s_.triaxial, common.seed)),
          test_settings_(s_.triaxial.test), progress_(make_progress(common)) {
        test_settings_.confining_pressure = s_.triaxial.confining_pressure.front();
        infos_ = infos_of(s_);
        go_on_with_arrivals(common_);
        if (RunBroker::is_needed(s_.broker, s_.stream)) {
            // before the specimen is made: what arrives until then waits in the queue of the client
            broker_.emplace(s_.broker, s_.stream, 0.0, common_);
            publish_unknown(broker_->link(), broker_->name(), infos_);
        }
        log_ = begin_log(s_.broker,
                         broker_ && broker_->gives_records() ? LoggedRecords::messages
                                                             : LoggedRecords::lines,
                         s_.stream, common);
        if (broker_ && log_) broker_->keep_in(log_);
        source_ = prepare_stream(s_, common);
    }
    void run();
    void show_answers(Report& summary, const RecordedTest& measured) const;
    void report();

private:
    void prepare();
    std::unique_ptr<Lines> lines();
    void follow();
    void record_stage(const RecordedTest& so_far, double latest);
    void predict(const RecordedTest& so_far);
    void write_frame();

    const Live& s_;
    const Common& common_;
    TriaxialScene scene_;
    TriaxialSettings test_settings_;
    std::vector<SensorInfo> infos_;
    std::filesystem::path source_;
    Progress progress_;
    std::optional<FrameWriter> frames_;
    std::shared_ptr<StreamLog> log_;  // null: none is kept
    std::optional<RunBroker> broker_; // none: no broker
    std::optional<Publisher> publisher_;
    const BrokerLines* from_broker_ = nullptr; // of test_
    std::optional<LivePrediction> prediction_;
    std::optional<PreparationTime> preparation_;
    std::optional<LiveModel> model_;
    std::optional<LiveTest> test_;
    std::optional<ModelRun> free_;
    Archive specimen_;
    std::optional<Simulation> at_start_; // has the shapes of the rocks
    BodyFrame first_frame_;
    std::vector<std::vector<double>> rows_;
    std::string verdict_;           // of quality control, as reported last
    std::string not_compared_;      // why there is no comparison with the model alone
    std::vector<double> latencies_; // s, from the machine's record to the analysis
    std::size_t records_ = 0;
};

const std::vector<RunFile::Column> columns{
    {"axial_strain"},       {"q", "Pa"},         {"volumetric_strain"},        {"friction"},
    {"friction_deviation"}, {"stiffness_ratio"}, {"stiffness_ratio_deviation"}};

/// Adds a row to the run file for each stage. Every 0.1 % of strain it reports a line, and the
/// verdict on the recordings if it has changed, and writes the table of all stages so far.
void LiveRun::record_stage(const RecordedTest& so_far, double latest) {
    const TestCurves& curves = model_->state().curves;
    const double strain = curves[quantity::axial_strain].back(),
                 q = curves[quantity::deviatoric_stress].back();
    rows_.push_back({strain, q, curves[quantity::volumetric_strain].back()});
    for (const NamedValue& v : named_values_of(model_->estimate()))
        rows_.back().push_back(std::get<double>(v.value));
    frames_->file().add_row("stages", rows_.back());
    rows_.back().push_back(latest); // kept out of the run file, since it differs from run to run
    const auto every =
        static_cast<std::size_t>(std::llround(std::max(1.0, 1e-3 / test_settings_.stage_strain)));
    if ((rows_.size() - 1) % every != 0 && !model_->done()) return;
    write_csv(common_.out / "live.csv",
              {"axial_strain", "q_Pa", "volumetric_strain", "friction", "friction_deviation",
               "stiffness_ratio", "stiffness_ratio_deviation", "latency_s"},
              rows_, {}, 6);
    progress_.pause();
    if (std::string verdict = verdict_on(so_far); verdict != verdict_) {
        report_news(common_, fmt::format("{:6.2f} %  {}", 100 * strain, verdict));
        verdict_ = std::move(verdict);
    }
    report_news(
        common_,
        fmt::format(
            "{:6.2f} %  q {:6.1f} kPa  friction {:.3f} +- {:.3f}  stiffness {:.2f} +- {:.2f}{}",
            100 * strain, 1e-3 * q, rows_.back()[3], rows_.back()[4], rows_.back()[5],
            rows_.back()[6],
            std::isnan(latest) ? "  (no new record)" : fmt::format("  latency {:.3f} s", latest)));
}

/// Predicts the rest of the test by the library at each of its strains.
void LiveRun::predict(const RecordedTest& so_far) {
    const double before = prediction_->rings().strain;
    if (!prediction_->update(model_->strain(), so_far)) return;
    prediction_->write(common_.out);
    progress_.pause();
    report_news(common_, "          " + sentence_of(prediction_->last()));
    if (prediction_->rings().strain > before)
        report_news(common_, "          " + sentence_of(prediction_->rings()));
}

/// Writes the positions of all rocks in the analysis, and flushes them to disk with all rows so
/// far.
void LiveRun::write_frame() {
    if ((model_->state().curves.size() - 1) % s_.triaxial.frame_stages != 0 && !model_->done())
        return;
    frames_->add(at_start_->world(), frame_of_model(first_frame_, model_->state()));
}

void LiveRun::follow() {
    RecordedTest so_far;
    std::uint64_t looked_at = 0;
    while (!model_->done()) {
        (void)test_->follow_to(model_->next_strain());
        if (looked_at == 0 || test_->lines_taken() != looked_at) so_far = test_->so_far();
        looked_at = test_->lines_taken();
        model_->next_stage(so_far);
        const auto ages = test_->ages();
        records_ += ages.size();
        if (!ages.empty())
            latencies_.push_back(ages.back()); // of the machine's record that was waited for
        const double latest = ages.empty() ? std::nan("") : ages.back();
        if (publisher_) {
            publish_stage(*publisher_, frame_of_model(first_frame_, model_->state()), *model_,
                          so_far, latest);
            broker_->report_doing(fmt::format("following the test, at {:.2f} of {:.2f} % of strain",
                                              100 * model_->strain(),
                                              100 * test_settings_.final_axial_strain));
        }
        record_stage(so_far, latest);
        write_frame();
        predict(so_far);
        model_->advance_members(); // compute the test's present stage before its record arrives
    }
}

/// Prepares what needs no record: the library, the specimen and the first ensemble members.
void LiveRun::prepare() {
    prediction_.emplace(s_.library, common_.settings, test_settings_.core_porosity(),
                        test_settings_.confining_pressure);
    if (!prediction_->reason().empty()) report_news(common_, sentence_of(prediction_->last()));
    preparation_.emplace(
        [this](const std::string& doing, double left) {
            if (broker_) broker_->report_doing(doing, left);
        },
        s_.learning.members, s_.learning.first_strain, test_settings_.final_axial_strain);
    specimen_ = make_specimen(scene_, test_settings_, common_,
                              [&, show = progress_slot(progress_)](const PhaseProgress& now) {
                                  show(now);
                                  preparation_->specimen_reached(now);
                              })
                    .state;
    progress_.pause();
    at_start_.emplace(make_simulation(scene_, 1));
    restore_specimen(*at_start_, scene_, specimen_);
    first_frame_ = frame_of_bodies(at_start_->world());
    first_frame_.corners.clear(); // the analysis has no shape of the membrane
    constexpr auto run_file = "live_triaxial.vtkhdf";
    frames_.emplace(common_.out / run_file,
                    common_.settings, // a resumed run reads its log first and rewrites this file
                    s_.written.extras());
    frames_->file().add_track("stages", columns);
    frames_->file().flush(); // the file is readable from now on
    model_.emplace(LiveModelSettings{s_.model, s_.learning, test_settings_.stage_strain,
                                     test_settings_.final_axial_strain, s_.catch_up},
                   [this](const std::vector<ModelVariant>& variants) {
                       return begin_models(scene_, test_settings_, specimen_, variants, common_,
                                           progress_, [this](std::size_t k, const auto& now) {
                                               preparation_->member_reached(k, now);
                                           });
                   });
    preparation_->end();
    if (!broker_) return;
    publisher_.emplace(broker_->link(), broker_->name());
    publish_start(*publisher_, at_start_->world(), first_frame_, model_->state(), infos_);
}

/// The records of the test, logged.
std::unique_ptr<Lines> LiveRun::lines() {
    if (broker_ && broker_->gives_records()) {
        auto lines = broker_->lines(infos_);
        from_broker_ = lines.get();
        return lines;
    }
    if (!log_) return open_lines(source_);
    return std::make_unique<LoggedLines>(open_lines(source_), log_);
}

void LiveRun::run() {
    prepare();
    LiveSettings live = s_.live;
    live.pressure = test_settings_.confining_pressure;
    live.quality_control.interval =
        std::max(live.quality_control.interval, test_settings_.stage_strain);
    test_.emplace(lines(), infos_, live);
    progress_.pause();
    if (broker_) broker_->report_doing("ready, waiting for the first record of the test machine");
    report_news(common_, "ready, reading records from " +
                             (s_.stream == "-"    ? "standard input"
                              : s_.stream.empty() ? "the broker " + s_.broker.client.address
                                                  : s_.stream.string()));
    const SavesWhenInterrupted saves("continue with --resume " + common_.out.string());
    try {
        follow();
    } catch (const Interrupted&) {
        model_->save_checkpoint();
        throw;
    }
    if (s_.compare)
        free_ =
            try_models(scene_, test_settings_, specimen_, {{.name = "DEM only", .rocks = s_.model}},
                       test_settings_.final_axial_strain, common_, progress_)
                .front();
    progress_.pause();
    if (!free_ || free_->stopped.empty()) return;
    not_compared_ = free_->stopped;
    free_.reset();
}

/// Shows what was learned, what the sensors contributed, and how far to trust it.
void LiveRun::show_answers(Report& summary, const RecordedTest& measured) const {
    summary.show({"learned_friction", "learned_friction_deviation", "learned_stiffness_ratio",
                  "learned_stiffness_ratio_deviation", "analysis_rmse_q_Pa", "forecast_rmse_q_Pa"});
    if (free_) summary.show({"DEM_only_rmse_q_Pa"});
    summary.show({"records", "latency_median_s", "latency_largest_s"});
    if (prediction_->last().not_used.empty())
        summary.show({"library_friction", "library_distance"});
    summary.show_sentence(sentence_of(prediction_->last()));
    summary.show_sentence(verdict_on(measured));
    if (!not_compared_.empty())
        summary.show_sentence("no comparison with the model alone: " + not_compared_);
    summary.show_sentence("What each sensor observes is in quality_control.txt.");
}

void LiveRun::report() {
    const RecordedTest measured = test_->so_far();
    constexpr double drift = 1e-3, turn = 0.1; // m and rad, model errors at the end of the test
    const std::string found = fmt::format(
        "{}{}{}\n{}", from_broker_ != nullptr ? from_broker_->report() : "",
        report_on_log(log_.get(), s_.broker), test_->report(),
        observability_report(measured, test_settings_.final_axial_strain / 1e-4 * s_.stage_time,
                             drift, turn));
    write_whole(common_.out / "quality_control.txt", found);
    frames_->file().add_meta({{"quality_control", found}});
    if (broker_) broker_->finish();
    frames_->file().close();
    write_estimates(common_.out / "learned.csv", model_->estimates());
    draw_live(common_.out / "live_triaxial.png",
              {&measured.curves, free_ ? &free_->curves : nullptr, &model_->state().curves}, rows_,
              *prediction_, s_.learning.final_strain);
    Report summary;
    summary.add(named_values_of(model_->estimate()));
    const auto add = [&](const char* name, const ModelRun& run) {
        const Misfit m = misfit_of(measured, run);
        summary.add(fmt::format("{}_rmse_q_Pa", name), m.q);
        summary.add(fmt::format("{}_rmse_volumetric_strain", name), m.volumetric_strain);
        summary.add(fmt::format("{}_rmse_ring_strain", name), m.ring_strain);
        summary.add(fmt::format("{}_rmse_sensor_displacement_m", name), m.sensor_displacement);
    };
    add("analysis", model_->state());
    add("forecast", model_->forecast());
    if (free_) add("DEM_only", *free_);
    if (model_->caught_up_at() > 0)
        summary.add("caught_up_at_axial_strain", model_->caught_up_at());
    if (model_->lost_second_at() > 0)
        summary.add("second_generation_lost_at_axial_strain", model_->lost_second_at());
    summary.add("sensors_accepted", measured.recordings.size() - measured.refused());
    summary.add("sensors_refused", measured.refused());
    summary.add("machine_channels_refused", refused_channels(measured));
    summary.add("records", records_);
    if (records_ == 0)
        say("live_triaxial: warning: no record of the stream could be used; quality_control.txt "
            "says why");
    const auto quantile_of = [](const std::vector<double>& times, double share) {
        return times.empty() ? std::nan("") : quantile(times, share);
    };
    summary.add("latency_median_s", quantile_of(latencies_, 0.5));
    summary.add("latency_95_percent_s", quantile_of(latencies_, 0.95));
    summary.add("latency_largest_s", quantile_of(latencies_, 1));
    if (const TestPrediction& last = prediction_->last(); last.not_used.empty()) {
        summary.add("library_friction", last.predicted.friction.value);
        summary.add("library_friction_low", last.predicted.friction.low);
        summary.add("library_friction_high", last.predicted.friction.high);
        summary.add("library_distance", last.predicted.distance);
        if (const RingEstimate& rings = prediction_->rings(); rings.not_made.empty()) {
            const auto there = ring_strains(measured.curves, rings.strain);
            summary.add("estimated_rings_strain", rings.strain);
            summary.add("estimated_rings_rmse", ring_difference(rings.mean, there));
            summary.add("estimated_rings_over_mean_profile",
                        ring_difference(rings.mean, there) /
                            ring_difference(rings.scaled_mean, there));
        }
        summary.add("library_update_median_s", quantile_of(prediction_->times(), 0.5));
        summary.add("library_update_largest_s", quantile_of(prediction_->times(), 1));
    }
    show_answers(summary, measured);
    report_results(common_, summary);
}

/// Refuses more ensemble members than fit in memory. Both generations are in memory until the
/// second one has caught up. The motions of each member are kept twice, by the run and by the
/// estimation, and forecast and analysis need as much as two more runs.
void require_memory_for_members(const Live& s, std::uint64_t limit) {
    const unsigned members = 2 * s.learning.members;
    const double stages = 1 + s.triaxial.test.final_axial_strain / s.triaxial.test.stage_strain;
    const double first = s.learning.first_strain / s.triaxial.test.stage_strain,
                 side_by_side = std::min(stages, 2 + first * s.catch_up / (s.catch_up - 1.0));
    require_memory_for(s.triaxial, members, limit,
                       2 * s.learning.members * (stages + side_by_side) + 2 * stages);
}

std::string explain(const Live& given, const Common& common) {
    return explain_triaxial(with_recorded_poses(given.triaxial, given.recordings), common);
}

/// With the poses that the recordings give, and the stream that is the default.
Live completed(Live s) {
    s.triaxial = with_recorded_poses(s.triaxial, s.recordings);
    if (s.stream.empty() && s.broker.client.address.empty())
        s.stream = assets_folder() / "smartrock" / "55kPa";
    return s;
}

void check_options(const Live& given, const Common& common) {
    const Live s = completed(given);
    require(s.triaxial.confining_pressure.size() == 1,
            "--confining-pressure: expected one pressure, found several");
    const std::string folder = folder_of(s.triaxial.confining_pressure.front());
    const bool is_replay =
        std::filesystem::is_directory(s.stream) && s.stream.filename().string().ends_with("kPa");
    require(!is_replay || s.stream.filename() == folder,
            fmt::format("--stream, --confining-pressure: expected a test at {}, found '{}'{}",
                        folder, s.stream.string(),
                        hint_at_pressure(s.triaxial.confining_pressure.front(),
                                         {s.stream.filename().string()})));
    check_test(s.triaxial);
    refuse_friction(s.triaxial);
    require_memory_for_members(s, common.memory_limit);
    require_same_specimen(common);
    say_how_read(grading_named(s.triaxial.grading));
    require_sensor_for_each(make_scene(s.triaxial, common.seed).poses, infos_of(s));
    if (!s.stream.empty() && s.stream != "-" && !std::filesystem::exists(s.stream))
        throw OutputError(fmt::format("--stream: cannot read '{}'", s.stream.string()));
    if (is_replay) (void)stream_of(s.stream, s.stage_time, s.live.quality_control.rest);
}

void run(const Live& given, const Common& common) {
    const Live s = completed(given);
    LiveRun live(s, common);
    live.run();
    live.report();
    remove_checkpoints(common);
}

} // namespace

} // namespace bris

int main(int argc, char** argv) {
    return bris::run_scenario<bris::Live>(argc, argv,
                                          {.name = "live_triaxial",
                                           .description = "Follows a running triaxial test with "
                                                          "SmartRocks and estimates the motion of "
                                                          "all rocks while records arrive.",
                                           .makes_beds = true},
                                          bris::check_options, bris::run, bris::explain);
}
