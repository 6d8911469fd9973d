// SMART computing while the test goes on: records of a test machine and of SmartRocks come in as a
// stream, and at every stage the model says what friction and stiffness are and where all rocks
// have gone.
#include "engine/assets.hpp"
#include "engine/errors.hpp"
#include "engine/io/csv.hpp"
#include "engine/io/plot.hpp"
#include "engine/io/whole_file.hpp"
#include "engine/scenario.hpp"
#include "engine/signal/attitude.hpp"
#include "engine/stopwatch.hpp"
#include "engine/summary.hpp"
#include "scenarios/assimilation/checkpointed_run.hpp"
#include "scenarios/assimilation/learning_results.hpp"
#include "scenarios/assimilation/live_model.hpp"
#include "scenarios/assimilation/live_test.hpp"
#include "scenarios/assimilation/misfit.hpp"
#include "scenarios/assimilation/run_models.hpp"
#include "scenarios/recordings/recorded_stream.hpp"
#include "scenarios/triaxial/triaxial_results.hpp"
#include "systems/output/frames.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

namespace bris {

namespace {

struct Live {
    Triaxial triaxial;
    std::filesystem::path recordings = assets_folder() / "smartrock";
    std::filesystem::path stream = assets_folder() / "smartrock" / "55kPa";
    RockParameters model{0.5, 1};
    Learning learning{.specimen_scatter = 0.35, .by_volume = true};
    LiveSettings live;
    double stage_time = 1.2;
    bool compare = true;
    unsigned catch_up = 3;

    Live() {
        triaxial.confining_pressure = {55e3};
        triaxial.test.final_axial_strain = 0.025;
    }
    void describe(auto& option) {
        option.group("stream");
        option("stream", stream, "",
               "records as they come, JSON objects or CSV, a line each: -, a file that grows, a "
               "pipe, or a folder with recordings.csv and test.csv to be replayed");
        option("recordings", recordings, "",
               "a folder with rock_NN.txt and sensor_poses.csv: what is known of the sensor rocks "
               "beforehand");
        option("timeout", live.timeout, "s",
               "without a record of the test machine, after which the stream has ended and the "
               "model goes on alone",
               above(0));
        option("lateness", live.lateness, "",
               "axial strain, by which the model waits for records that come late", at_least(0));
        option("speed", live.speed, "",
               "of a replay by the records' times; 1: as it was, 0: as fast as can be",
               at_least(0));
        option("stage_time", stage_time, "s",
               "that the test took for 0.01 % of strain, in a folder to be replayed whose test.csv "
               "has no t",
               above(0));
        option("rest", live.quality_control.rest, "s",
               "at the beginning, in which the rocks lie still", above(0));
        option("interval", live.quality_control.interval, "",
               "axial strain between samples that are used", above(0));
        option("use_displacement", live.quality_control.displacement, "", "ux uy uz, where sent");
        option("use_attitude", live.quality_control.attitude, "",
               "qw qx qy qz, where sent, else tilt by gravity");
        option.group("model");
        option("model_friction", model.friction, "", "of rocks, before anything is measured",
               above(0));
        option("model_stiffness", model.stiffness, "",
               "of contacts, of --clump-stiffness, likewise", above(0));
        option("compare", compare, "", "with the model alone, which is run after the test");
        option("catch_up", catch_up, "",
               "stages that the second generation goes on for each one of the test, until it is "
               "where the test is",
               within(2, 10000));
        learning.describe(option);
        triaxial.describe(option);
    }
};

constexpr auto log_name = "stream.ndjson";

/// Where the lines come from, and the log in the folder of the results.
std::filesystem::path prepare_stream(const Live& s, const Common& common) {
    const auto log = common.out / log_name;
    const bool goes_on = !common.resume.empty() && std::filesystem::is_directory(common.resume);
    if (!goes_on && std::filesystem::exists(log)) { // it may be all that is left of a test
        auto kept = log.string() + ".before";
        for (int k = 2; std::filesystem::exists(kept); ++k)
            kept = fmt::format("{}.before.{}", log.string(), k);
        std::filesystem::rename(log, kept);
    }
    if (goes_on && !std::filesystem::equivalent(common.resume, common.out) &&
        std::filesystem::exists(common.resume / log_name))
        std::filesystem::copy_file(common.resume / log_name, log,
                                   std::filesystem::copy_options::overwrite_existing);
    if (!std::filesystem::is_directory(s.stream)) return s.stream;
    std::string text;
    for (const std::string& line : stream_of(s.stream, s.stage_time, s.live.quality_control.rest))
        text += line + "\n";
    write_whole(common.out / "replay.ndjson", text);
    return common.out / "replay.ndjson";
}

class LiveRun {
public:
    LiveRun(const Live& settings, const Common& common)
        : s_(settings), common_(common), scene_(make_scene(s_.triaxial, common.seed)),
          test_settings_(s_.triaxial.test), progress_(progress_of_models(common)) {
        test_settings_.confining_pressure = s_.triaxial.confining_pressure.front();
        infos_ = infos_of_test(s_.recordings, test_settings_.confining_pressure,
                               read_sensor_infos(s_.recordings));
        require(infos_.size() == scene_.poses.size(),
                fmt::format("--recordings: expected files rock_NN.txt of as many sensor rocks as "
                            "the model has, {}, found {}",
                            scene_.poses.size(), infos_.size()));
        if (s_.stream != "-" && !std::filesystem::exists(s_.stream))
            throw OutputError(fmt::format("cannot read '{}'", s_.stream.string()));
        source_ = prepare_stream(s_, common);
    }
    void run();
    void report();

private:
    void prepare();
    void follow();
    void record_stage(double latest);
    void write_frame();
    void draw(const RecordedTest& measured) const;

    const Live& s_;
    const Common& common_;
    TriaxialScene scene_;
    TriaxialSettings test_settings_;
    std::vector<SensorInfo> infos_;
    std::filesystem::path source_;
    Progress progress_;
    std::optional<LiveModel> model_;
    std::optional<LiveTest> test_;
    std::optional<ModelRun> free_;
    Archive specimen_;
    BodyFrame first_frame_;
    std::optional<FrameWriter> frames_;
    std::vector<std::vector<double>> rows_;
    std::vector<double> latencies_; // s, of the answers
    std::size_t records_ = 0;
};

const std::vector<RunFile::Column> columns{
    {"axial_strain"},       {"q", "Pa"},         {"volumetric_strain"},        {"friction"},
    {"friction_deviation"}, {"stiffness_ratio"}, {"stiffness_ratio_deviation"}};

/// A row of the run file for each stage; every 0.1 % of strain: a line, and the table of all stages
/// so far.
void LiveRun::record_stage(double latest) {
    const TriaxialPoint& now = model_->state().points.back();
    rows_.push_back({now.axial_strain, now.deviatoric_stress, now.volumetric_strain});
    for (const NamedValue& v : describe(model_->estimate()))
        rows_.back().push_back(std::get<double>(v.value));
    frames_->file().add_row("stages", rows_.back());
    rows_.back().push_back(latest); // not of the test: no two runs have the same
    const auto every =
        static_cast<std::size_t>(std::llround(std::max(1.0, 1e-3 / test_settings_.stage_strain)));
    if ((rows_.size() - 1) % every != 0 && !model_->done()) return;
    write_csv(common_.out / "live.csv",
              {"axial_strain", "q_Pa", "volumetric_strain", "friction", "friction_deviation",
               "stiffness_ratio", "stiffness_ratio_deviation", "latency_s"},
              rows_, {}, 6);
    if (common_.quiet) return;
    progress_.pause();
    fmt::print(
        "{:6.2f} %  q {:6.1f} kPa  friction {:.3f} +- {:.3f}  stiffness {:.2f} +- {:.2f}{}\n",
        100 * now.axial_strain, 1e-3 * now.deviatoric_stress, rows_.back()[3], rows_.back()[4],
        rows_.back()[5], rows_.back()[6],
        std::isnan(latest) ? "  (nothing heard)" : fmt::format("  {:.3f} s behind", latest));
    std::fflush(stdout);
}

/// All rocks where the model says they are; on disk then, with all rows so far.
void LiveRun::write_frame() {
    const ModelRun& run = model_->state();
    if ((run.points.size() - 1) % s_.triaxial.frame_stages != 0 && !model_->done()) return;
    std::map<std::int64_t, std::size_t> index_of;
    for (std::size_t k = 0; k < run.rocks.size(); ++k)
        index_of[static_cast<std::int64_t>(run.rocks[k])] = k;
    BodyFrame frame = first_frame_;
    frame.time = run.points.back().axial_strain;
    for (std::size_t b = 0; b < frame.ids.size(); ++b) {
        const auto found = index_of.find(frame.ids[b]);
        if (found == index_of.end()) continue;
        const RockPose& start = run.start[found->second];
        frame.positions[b] = start.position + run.displacement.back()[found->second];
        const Quat q = exponential_map(run.rotation.back()[found->second]) * start.orientation;
        const double numbers[] = {q.w(), q.x(), q.y(), q.z()};
        for (std::size_t i = 0; i < 4; ++i)
            frame.orientations[4 * b + i] = static_cast<float>(numbers[i]);
    }
    frames_->add(frame);
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
            latencies_.push_back(ages.back()); // the machine's record that the answer waited for
        record_stage(ages.empty() ? std::nan("") : ages.back());
        write_frame();
        model_->advance_members(); // the stage that the test is in now, while nobody waits
    }
}

/// All that needs no record: the specimen, and the first worlds.
void LiveRun::prepare() {
    specimen_ = make_specimen(scene_, test_settings_, common_, progress_slot(progress_)).state;
    progress_.pause();
    Simulation at_start = make_simulation(scene_, 1, common_.serial);
    at_start.restore(specimen_);
    first_frame_ = frame_of_bodies(at_start.world());
    first_frame_.corners.clear(); // the membrane of the test is not known rock by rock
    frames_.emplace(common_.out / "live_triaxial.vtkhdf",
                    common_.settings); // a run that goes on takes its log first, and writes it anew
    frames_->file().add_track("stages", columns);
    frames_->file().flush(); // can be read from now on
    model_.emplace(LiveModelSettings{s_.model, s_.learning, test_settings_.stage_strain,
                                     test_settings_.final_axial_strain, s_.catch_up},
                   [this](const std::vector<ModelVariant>& variants) {
                       return begin_models(scene_, test_settings_, specimen_, variants, common_,
                                           progress_);
                   });
}

void LiveRun::run() {
    prepare();
    LiveSettings live = s_.live;
    live.pressure = test_settings_.confining_pressure;
    live.quality_control.interval =
        std::max(live.quality_control.interval, test_settings_.stage_strain);
    test_.emplace(source_, common_.out / log_name, infos_, live);
    progress_.pause();
    if (!common_.quiet)
        fmt::print("ready; {}\n",
                   s_.stream == "-" ? "listening" : "following " + s_.stream.string());
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
    fmt::print("not compared: {}\n", free_->stopped);
    free_.reset();
}

void LiveRun::draw(const RecordedTest& measured) const {
    std::vector<Plot> panels;
    const auto panel = [&](const char* title, const char* label, double scale,
                           double TriaxialPoint::*value) {
        Plot plot{
            .title = title,
            .x_label = "axial strain (%)",
            .y_label = label,
            .curves = {curve_of("measured", measured.measured, scale, value, Curve::Style::points),
                       curve_of("analysis", model_->state().points, scale, value)}};
        if (free_)
            plot.curves.push_back(
                curve_of("DEM only", free_->points, scale, value, Curve::Style::dashed));
        panels.push_back(std::move(plot));
    };
    panel("Deviatoric stress", "q (kPa)", 1e-3, &TriaxialPoint::deviatoric_stress);
    panel("Volumetric strain", "volumetric strain (%)", 100, &TriaxialPoint::volumetric_strain);
    Plot friction{.title = "What the test tells of its rocks",
                  .x_label = "axial strain (%)",
                  .y_label = "friction"};
    for (const auto& [label, sign] :
         {std::pair{"friction", 0.0}, std::pair{"one deviation", 1.0}, std::pair{"", -1.0}}) {
        Curve curve{.label = label, .style = sign == 0 ? Curve::Style::line : Curve::Style::dashed};
        for (const auto& row : rows_) {
            curve.x.push_back(100 * row[0]);
            curve.y.push_back(row[3] + sign * row[4]);
        }
        friction.curves.push_back(std::move(curve));
    }
    panels.push_back(std::move(friction));
    draw_plots(common_.out / "live_triaxial.png", panels, 3);
}

void LiveRun::report() {
    const RecordedTest measured = test_->so_far();
    constexpr double drift = 1e-3, turn = 0.1; // m and rad, that rocks of the model may be off by
    const std::string found = fmt::format(
        "{}\n{}", test_->report(),
        observability(measured.recordings, test_settings_.final_axial_strain / 1e-4 * s_.stage_time,
                      drift, turn));
    write_whole(common_.out / "quality_control.txt", found);
    frames_->file().add_meta({{"quality_control", found}});
    frames_->file().close();
    write_estimates(common_.out / "learned.csv", model_->estimates());
    draw(measured);
    Summary summary;
    summary.add(describe(model_->estimate()));
    const auto add = [&](const char* name, const ModelRun& run) {
        const Misfit m = misfit_of(run, measured);
        summary.add(fmt::format("{}_rmse_q_Pa", name), m.q);
        summary.add(fmt::format("{}_rmse_volumetric_strain", name), m.volumetric_strain);
        summary.add(fmt::format("{}_rmse_ring_strain", name), m.ring_strain);
        summary.add(fmt::format("{}_rmse_sensor_displacement_m", name), m.sensor_displacement);
    };
    add("analysis", model_->state());
    add("forecast", model_->forecast());
    if (free_) add("DEM_only", *free_);
    summary.add("caught_up_at_axial_strain", model_->caught_up_at());
    if (model_->lost_second_at() > 0)
        summary.add("second_generation_lost_at_axial_strain", model_->lost_second_at());
    summary.add("sensors_refused", measured.refused());
    summary.add("records", records_);
    std::ranges::sort(latencies_);
    const auto latency = [&](double share) {
        return latencies_.empty() ? std::nan("")
                                  : latencies_[static_cast<std::size_t>(
                                        share * static_cast<double>(latencies_.size() - 1))];
    };
    summary.add("latency_median_s", latency(0.5));
    summary.add("latency_95_percent_s", latency(0.95));
    summary.add("latency_largest_s", latency(1));
    report_results(common_, summary);
    fmt::print("{}results in {}\n", found, common_.out.string());
}

/// Both generations stand side by side until the second one has caught up; each world's motions are
/// kept twice, by the run and by who learns from it, and those of the answers are two runs more.
void require_memory_for_members(const Live& s, std::uint64_t limit) {
    const unsigned members = 2 * s.learning.members;
    const double stages = 1 + s.triaxial.test.final_axial_strain / s.triaxial.test.stage_strain;
    const double first = s.learning.first_strain / s.triaxial.test.stage_strain,
                 side_by_side = std::min(stages, 2 + first * s.catch_up / (s.catch_up - 1.0));
    require_memory_for(s.triaxial, members, limit,
                       2 * s.learning.members * (stages + side_by_side) + 2 * stages);
}

/// With the poses of the sensor rocks that the recordings came with, unless others are given.
Live with_poses(Live s) {
    const auto poses = s.recordings / "sensor_poses.csv";
    if (s.triaxial.sensor_poses.empty() && std::filesystem::exists(poses))
        s.triaxial.sensor_poses = poses;
    return s;
}

std::string explain(const Live& given, const Common& common) {
    return explain_triaxial(with_poses(given).triaxial, common);
}

void run(const Live& given, const Common& common) {
    const Live s = with_poses(given);
    require(s.triaxial.confining_pressure.size() == 1,
            "--confining-pressure: expected one, found several");
    const std::string folder = folder_of(s.triaxial.confining_pressure.front());
    const bool is_replay =
        std::filesystem::is_directory(s.stream) && s.stream.filename().string().ends_with("kPa");
    require(!is_replay || s.stream.filename() == folder,
            fmt::format("--stream: expected a test at {}, as --confining-pressure says, found '{}'",
                        folder, s.stream.string()));
    check_test(s.triaxial);
    require_memory_for_members(s, common.memory_limit);
    LiveRun live(s, common);
    live.run();
    live.report();
    remove_checkpoints(common);
}

} // namespace

} // namespace bris

int main(int argc, char** argv) {
    return bris::run_scenario<bris::Live>(argc, argv,
                                          {"live_triaxial",
                                           "a triaxial test and its SmartRocks followed as their "
                                           "records come in, and what they tell of all rocks"},
                                          bris::run, bris::explain);
}
