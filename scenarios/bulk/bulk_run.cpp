#include "scenarios/bulk/bulk_run.hpp"

#include "components/body.hpp"
#include "components/kinds.hpp"
#include "components/settings.hpp"
#include "engine/errors.hpp"
#include "engine/io/csv.hpp"
#include "engine/ordering.hpp"
#include "engine/report.hpp"
#include "engine/resume.hpp"
#include "scenarios/specimens/start.hpp"
#include "systems/broadphase/lists.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string_view>
#include <tuple>

namespace bris {

namespace {

/// Settings that have no effect on a bed.
const std::vector<std::string_view> settings_of_run_only{
    "duration_s", "step_s",    "sample_interval_s", "frames",  "reference",
    "bed",        "fill_only", "friction_factor",   "window_s"};

std::size_t free_bodies(const World& world) {
    const auto motion = world.column<Bodies, MotionOf>();
    return static_cast<std::size_t>(
        std::ranges::count(motion, static_cast<std::uint32_t>(Motion::free)));
}

std::vector<Curve> reference_in(const BulkSettings& settings) {
    if (settings.reference.empty()) return {};
    const CsvTable table = read_csv(settings.reference);
    require(table.names.size() >= 2,
            fmt::format("{}: expected two columns, time in s and value, found {}",
                        settings.reference.string(), table.names.size()));
    return {{.label = settings.reference.stem().string(),
             .x = table.column(table.names[0]),
             .y = table.column(table.names[1]),
             .style = Curve::Style::dashed}};
}

} // namespace

void check_bulk(const BulkSettings& settings, const Common& common) {
    (void)steps_of(settings.duration, settings.bed.step, "duration");
    (void)steps_of(settings.sample_interval, settings.bed.step, "sample-interval");
    (void)reference_in(settings);
    require(common.resume.empty() || settings.bed_file.empty(),
            "--bed: expected none together with --resume");
    if (!settings.bed_file.empty())
        (void)checkpoint_to_resume(settings.bed_file, common.scenario, common.settings,
                                   settings_of_run_only, "--bed");
}

double hertz_contact_time(double radius, double density, double young_modulus, double speed) {
    const double mass = density * 4 / 3 * pi * radius * radius * radius / 2,
                 e = young_modulus / (2 * (1 - 0.04));
    return 2.87 * std::pow(mass * mass / (radius / 2 * e * e * speed), 0.2);
}

Simulation start_case(World world, const Common& common) {
    return start(std::move(world),
                 {.law = LawName::hertz_mindlin_viscous, .threads = common.threads});
}

BulkRun::BulkRun(const Common& common, const BulkSettings& settings, BulkCase bulk_case,
                 Simulation& simulation)
    : common_(common), settings_(settings), case_(std::move(bulk_case)),
      total_(steps_of(settings.duration, settings.bed.step, "duration")),
      sample_every_(steps_of(settings.sample_interval, settings.bed.step, "sample-interval")),
      simulation_(simulation), maker_(simulation_, settings.bed), progress_(make_progress(common)),
      run_(simulation_, common, common.scenario, progress_slot(progress_)), last_(simulation) {
    run_.keep(case_.curve);
    run_.keep(last_);
    run_.keep(extremes_);
}

void BulkRun::Extremes::save(Archive& archive) const {
    put_fields(archive, "run/extremes", std::tie(stable_step, overlap));
}
void BulkRun::Extremes::load(const Archive& archive) {
    if (archive.find("run/extremes") != nullptr) // older checkpoints have none
        get_fields(archive, "run/extremes", std::tie(stable_step, overlap));
}

std::vector<Curve> BulkRun::reference() const { return reference_in(settings_); }

bool BulkRun::run() {
    start_from_files();
    std::vector<Phase> phases{bed_phase()};
    if (!settings_.fill_only) phases.push_back(case_phase());
    run_.go(phases);
    return !settings_.fill_only;
}

void BulkRun::start_from_files() {
    if (!common_.resume.empty()) {
        run_.resume(common_.resume,
                    {"duration_s", "frames", "reference", "window_s", "fill_only", "bed"});
        if (run_.phase() == 0) return;
        run_.require_steps_left(total_, "duration");
        open_frames();
    } else if (!settings_.bed_file.empty()) {
        resume(simulation_, settings_.bed_file, common_.scenario, common_.settings,
               settings_of_run_only, "--bed");
        require(bed().phase == BedPhase::ready,
                fmt::format("--bed: expected a finished bed, found '{}', which is unfinished; "
                            "continue it with --resume",
                            settings_.bed_file.string()));
        maker_.apply_phase();
    }
}

Phase BulkRun::bed_phase() {
    return {.advance =
                [this](Simulation&) {
                    if (bed().phase == BedPhase::ready) return false;
                    const bool goes_on = maker_.advance();
                    if (!goes_on) report_bed();
                    return goes_on;
                },
            .progress = [this](const World&) { return maker_.progress(); }};
}

void BulkRun::report_bed() {
    run_.save_as("bed");
    progress_.pause();
    report_news(
        common_,
        fmt::format("bed: {} grains, {} steps, {:.4f} s; kinetic energy / (weight x radius) "
                    "{:.2e}, unbalanced ratio {:.4f}, coordination number {:.2f}; in {}",
                    free_bodies(world()), bed().steps, bed().time, bed().kinetic_ratio,
                    bed().unbalanced_ratio, bed().coordination,
                    (common_.out / "bed.ckpt.h5").string()));
}

Phase BulkRun::case_phase() {
    return run_.timed(
        {.name = common_.scenario,
         .steps = total_,
         .sample_every = sample_every_,
         .sample = [this](Simulation&, std::uint64_t step) { return at_sample(step); },
         .status =
             [this](const World&) {
                 return fmt::format("{:.4f} s, {}", clock().time(), case_.description());
             },
         .begin = [this](Simulation&) { begin_case(); },
         .looks = false});
}

void BulkRun::begin_case() {
    start_clock(simulation_.world(), settings_.bed.step);
    case_.begin(simulation_.world());
    case_.sample(world());
    open_frames();
}

void BulkRun::open_frames() {
    frames_ = std::make_unique<FrameWriter>(run_.file(common_.scenario, ".vtkhdf"),
                                            common_.settings, settings_.written.extras());
    frames_->add(world());
    keep_view();
}

bool BulkRun::at_sample(std::uint64_t step) {
    const std::uint64_t per_frame =
        std::max<std::uint64_t>(1, total_ / sample_every_ / settings_.frames) * sample_every_;
    if (settings_.written.extras().contacts)
        simulation_.look();
    else
        simulation_.observe();
    measure_contacts();
    case_.sample(world());
    if (step % per_frame == 0 || step == total_) frames_->add(world());
    if (step == total_ / 2 / sample_every_ * sample_every_ || step == total_) keep_view();
    const bool is_over = case_.is_over && case_.is_over(world());
    edit();
    return !is_over;
}

void BulkRun::measure_contacts() {
    extremes_.overlap = std::max(extremes_.overlap, last_.quantities().largest_overlap);
    extremes_.stable_step = std::min(extremes_.stable_step, last_.stable_step());
}

// last, since it makes the contacts of the last step invalid
void BulkRun::edit() {
    if (!case_.edit) return;
    case_.edit(simulation_.divide_now());
    simulation_.prepare(); // tables may have become shorter
}

// draws only what is behind the middle plane or reaches through it, to show the inside
void BulkRun::keep_view() {
    View view = view_of_grains(world(), [&](Row row) { return case_.colour(world(), row); });
    std::erase_if(view.balls, [](const DrawnBall& ball) { return ball.centre.y() > ball.radius; });
    std::erase_if(view.quads, [](const auto& quad) { // and boundaries that were moved away
        return std::ranges::any_of(
            quad, [](const Vec3& corner) { return corner.y() > 1e-9 || corner.norm() > 1; });
    });
    view.caption = fmt::format("{:.3g} s", clock().time());
    views_.push_back(std::move(view));
}

void BulkRun::report(const Report& results, std::vector<Plot> plots) {
    Report summary = results;
    summary.add("simulated_time_s", clock().time());
    summary.add("step_s", clock().dt);
    summary.add("largest_overlap_of_all_samples_m", extremes_.overlap);
    summary.add("least_stable_step_s", extremes_.stable_step);
    summary.add("step_over_least_stable_step", clock().dt / extremes_.stable_step);
    summary.add("bed_steps", bed().steps);
    summary.add("bed_kinetic_ratio", bed().kinetic_ratio);
    summary.add("bed_unbalanced_ratio", bed().unbalanced_ratio);
    summary.add("bed_at_rest", maker_.at_rest());
    summary.add("bed_coordination", bed().coordination);
    add_quantities(summary, last_.quantities());
    summary.add("rebuilds", world().resource<ListState>().rebuilds);
    summary.add("prunes", world().resource<ListState>().prunes);
    run_.add_to_summary(summary);
    summary.show({"bed_at_rest", "simulated_time_s", "steps", "step_over_least_stable_step",
                  "largest_overlap_of_all_samples_m", "wall_time_s"});
    progress_.pause();
    case_.curve.write_csv(common_.out / "curve.csv");
    case_.curve.write_track(frames_->file());
    frames_->file().close();
    draw_plots(common_.out / "curve.png", plots);
    for (View& view : views_) gather(view);
    draw_picture(common_.out / "scene.png", views_, {.azimuth = 0, .elevation = 0}, 900);
    report_results(common_, summary);
}

void run_bulk(const Common& common, const BulkSettings& settings, BulkCase bulk_case,
              const std::function<void(BulkRun&)>& report) {
    Simulation simulation = start_case(std::move(bulk_case.world), common);
    BulkRun bulk(common, settings, std::move(bulk_case), simulation);
    if (bulk.run()) report(bulk);
}

} // namespace bris
