#include "scenarios/bulk/bulk_run.hpp"

#include "components/body.hpp"
#include "components/kinds.hpp"
#include "components/settings.hpp"
#include "engine/errors.hpp"
#include "engine/io/csv.hpp"
#include "engine/ordering.hpp"
#include "engine/state.hpp"
#include "engine/stopwatch.hpp"
#include "systems/broadphase/lists.hpp"
#include "systems/contact/stable_step.hpp"
#include "systems/steps.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string_view>

namespace bris {

namespace {

constexpr std::uint64_t longest_block = 100; // steps between looks at the clock on the wall

/// Settings that a bed does not know yet.
const std::initializer_list<std::string_view> of_the_run_alone{
    "duration_s", "step_s",    "sample_interval_s", "frames",  "reference",
    "bed",        "fill_only", "friction_factor",   "window_s"};

std::uint64_t steps_of(double time, double step, const char* option) {
    const double number = std::round(time / step);
    require(number >= 1 && number < 1e15,
            fmt::format("--{}: expected 1 to 1e15 steps of {:.3g} s, found {:.3g}", option, step,
                        number));
    return static_cast<std::uint64_t>(number);
}

std::size_t free_bodies(const World& world) {
    const auto motion = world.column<Bodies, MotionOf>();
    return static_cast<std::size_t>(
        std::ranges::count(motion, static_cast<std::uint32_t>(Motion::free)));
}

std::vector<RunFile::Column> with_common_columns(std::vector<RunFile::Column> columns) {
    columns.insert(columns.begin(), {"time", "s"});
    return columns;
}

} // namespace

double hertz_contact_time(double radius, double density, double young_modulus, double speed) {
    const double mass = density * 4 / 3 * pi * radius * radius * radius / 2,
                 e = young_modulus / (2 * (1 - 0.04));
    return 2.87 * std::pow(mass * mass / (radius / 2 * e * e * speed), 0.2);
}

BulkRun::BulkRun(const Common& common, const BulkSettings& settings, BulkCase bulk_case)
    : common_(common), settings_(settings), case_(std::move(bulk_case)),
      total_(steps_of(settings.duration, settings.bed.step, "duration")),
      sample_every_(steps_of(settings.sample_interval, settings.bed.step, "sample-interval")),
      simulation_(std::move(case_.world), steps(LawName::hertz_mindlin_viscous), common.threads,
                  {.serial = common.serial}),
      series_("curve", with_common_columns(case_.columns)), maker_(simulation_, settings.bed),
      keeper_({common.out / (common.scenario + ".ckpt.h5"), common.scenario, common.settings,
               [this](Archive& archive) { series_.save(archive); }}),
      progress_(1, common.quiet ? Progress::Style::quiet : Progress::Style::automatic),
      least_stable_step_(std::numeric_limits<double>::infinity()) {
    simulation_.on_restore(forget_lists);
}

std::vector<Curve> BulkRun::reference() const {
    if (settings_.reference.empty()) return {};
    const CsvTable table = read_csv(settings_.reference);
    require(table.names.size() >= 2,
            fmt::format("{}: expected two columns, time in s and value, found {}",
                        settings_.reference.string(), table.names.size()));
    return {{.label = settings_.reference.stem().string(),
             .x = table.column(table.names[0]),
             .y = table.column(table.names[1]),
             .style = Curve::Style::dashed}};
}

bool BulkRun::run() {
    (void)reference(); // a file that cannot be read is better known now
    start_from_files();
    guarded([&] { make_bed(); });
    if (settings_.fill_only) return false;
    guarded([&] {
        begin_run();
        go();
    });
    keeper_.save(simulation_);
    return true;
}

template <class Work>
void BulkRun::guarded(Work&& work) {
    try {
        work();
    } catch (const SimulationError& error) {
        throw SimulationError(fmt::format("{} (state in {})", error.what(),
                                          keeper_.save_stopped(simulation_).string()));
    }
}

void BulkRun::start_from_files() {
    require(common_.resume.empty() || settings_.bed_file.empty(),
            "--bed: expected none together with --resume");
    if (!common_.resume.empty()) {
        series_.load(resume(simulation_, common_.resume, common_.scenario, common_.settings,
                            {"duration_s", "frames", "reference", "window_s", "fill_only", "bed"})
                         .state);
        resumed_ = bed().phase == BedPhase::ready;
    } else if (!settings_.bed_file.empty()) {
        resume(simulation_, settings_.bed_file, common_.scenario, common_.settings,
               of_the_run_alone);
        require(bed().phase == BedPhase::ready,
                fmt::format("--bed: expected a finished bed, found '{}', one in the making; go on "
                            "with --resume",
                            settings_.bed_file.string()));
        maker_.apply_phase();
    }
}

void BulkRun::make_bed() {
    if (bed().phase == BedPhase::ready) return;
    while (maker_.advance()) {
        progress_.report(0, maker_.fraction(), maker_.description());
        keeper_.attend(simulation_);
    }
    const auto path = common_.out / "bed.ckpt.h5";
    CheckpointKeeper({path, common_.scenario, common_.settings}).save(simulation_);
    progress_.pause();
    fmt::print("bed: {} grains, {} steps, {:.4f} s; kinetic energy / (weight x radius) {:.2e}, "
               "unbalanced ratio "
               "{:.4f}, coordination {:.2f}; in {}\n",
               free_bodies(world()), bed().steps, bed().time, bed().kinetic_ratio,
               bed().unbalanced_ratio, bed().coordination, path.string());
}

void BulkRun::begin_run() {
    std::string name = common_.scenario;
    if (!resumed_) {
        start_clock(simulation_.world(), settings_.bed.step);
        case_.begin(simulation_.world());
    } else {
        require(run_step() < total_,
                fmt::format(
                    "--duration: expected more than the {:.6g} s of the checkpoint, found {:.6g} s",
                    clock().time(), settings_.duration));
        name += fmt::format("_from_{}", run_step()); // the frames until then are in a file already
    }
    first_step_ = run_step();
    frames_ = std::make_unique<FrameWriter>(common_.out / (name + ".vtkhdf"), common_.settings);
    if (!resumed_) sample();
    frames_->add(world());
    keep_view();
}

void BulkRun::go() {
    const std::uint64_t per_frame =
        std::max<std::uint64_t>(1, total_ / sample_every_ / settings_.frames) * sample_every_;
    while (run_step() < total_) {
        const std::uint64_t next =
                                std::min(total_, (run_step() / sample_every_ + 1) * sample_every_),
                            before = run_step();
        const auto began = this_instant();
        simulation_.advance(std::min(next - before, longest_block));
        stepping_ += seconds_since(began);
        body_steps_ += static_cast<double>((run_step() - before) * free_bodies(world()));
        const double fraction = static_cast<double>(run_step()) / static_cast<double>(total_);
        progress_.report(0, fraction,
                         fmt::format("{} {:.4f} s, step {}, {}", common_.scenario, clock().time(),
                                     run_step(), case_.description(series_)));
        if (run_step() == next) {
            look();
            sample();
            if (next % per_frame == 0 || next == total_) frames_->add(world());
            if (next == total_ / 2 / sample_every_ * sample_every_ || next == total_) keep_view();
            if (case_.is_over && case_.is_over(world())) break;
        }
        keeper_.attend(simulation_);
    }
}

// before the case may edit the scene: contacts are known only until then
void BulkRun::look() {
    last_ = measure(world());
    deepest_ = std::max(deepest_, last_.largest_overlap);
    least_stable_step_ = std::min(least_stable_step_, stable_step(world()));
}

void BulkRun::sample() {
    case_.sample(simulation_.world(), series_);
    simulation_.prepare(); // tables may have become shorter
}

// what is behind the middle plane, or reaches through it: what goes on inside
void BulkRun::keep_view() {
    const BodyFrame frame = frame_of_bodies(world());
    const auto rows = rows_by_id(world().column<Bodies, BodyId>());
    View view = view_of_bodies(world(), frame, [&](std::size_t place) {
        return case_.colour(world(), rows[static_cast<std::size_t>(frame.ids[place])]);
    });
    std::erase_if(view.balls, [](const DrawnBall& ball) { return ball.centre.y() > ball.radius; });
    std::erase_if(view.quads, [](const auto& quad) { // and what was taken away
        return std::ranges::any_of(
            quad, [](const Vec3& corner) { return corner.y() > 1e-9 || corner.norm() > 1; });
    });
    view.caption = fmt::format("{:.3g} s", clock().time());
    views_.push_back(std::move(view));
}

void BulkRun::report(const Summary& results, std::vector<Plot> plots) {
    Summary summary = results;
    summary.add("simulated_time_s", clock().time());
    summary.add("steps", run_step());
    summary.add("step_s", clock().dt);
    summary.add("largest_overlap_of_all_samples_m", deepest_);
    summary.add("least_stable_step_s", least_stable_step_);
    summary.add("step_over_least_stable_step", clock().dt / least_stable_step_);
    summary.add("bed_steps", bed().steps);
    summary.add("bed_kinetic_ratio", bed().kinetic_ratio);
    summary.add("bed_unbalanced_ratio", bed().unbalanced_ratio);
    summary.add("bed_at_rest", maker_.at_rest());
    summary.add("bed_coordination", bed().coordination);
    add_quantities(summary, last_);
    summary.add("refreshes", world().resource<ListState>().refreshes);
    summary.add("prunes", world().resource<ListState>().prunes);
    summary.add("stepping_s", stepping_);
    summary.add("particle_steps_per_s", stepping_ > 0 ? body_steps_ / stepping_ : 0);
    summary.add("fingerprint", hexadecimal(fingerprint(simulation_.snapshot())));
    progress_.pause();
    report_results(common_, summary);
    series_.write_csv(common_.out / "curve.csv");
    series_.write_track(frames_->file());
    frames_->file().close();
    draw_plots(common_.out / "curve.png", plots);
    draw_picture(common_.out / "scene.png", views_, {.azimuth = 0, .elevation = 0}, 900);
    fmt::print("results in {}\n", common_.out.string());
}

void run_bulk(const Common& common, const BulkSettings& settings, BulkCase bulk_case,
              const std::function<void(BulkRun&)>& report) {
    BulkRun bulk(common, settings, std::move(bulk_case));
    if (common.explain)
        fmt::print("{}\n", bulk.explain());
    else if (bulk.run())
        report(bulk);
}

} // namespace bris
