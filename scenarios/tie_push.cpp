// Lateral resistance of a single tie: it is pushed along its axis through compacted ballast, with
// and without a shoulder and with several amounts of fines, on the same bed.
#include "engine/errors.hpp"
#include "engine/io/plot.hpp"
#include "engine/report.hpp"
#include "engine/run.hpp"
#include "scenarios/field_tests/bed_tests.hpp"
#include "scenarios/field_tests/tie_bed.hpp"
#include "scenarios/specimens/scene.hpp"
#include "systems/output/balance.hpp"
#include "systems/output/frames.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <memory>
#include <string_view>

namespace {

using namespace bris;
namespace fs = std::filesystem;

/// Settings that do not concern the bed: it can be tested again with others.
const std::vector<std::string_view> settings_of_tests{
    "vci_percent", "shoulders", "displacement_m", "speed_m_per_s",
    "interval_m",  "tolerance", "safety"};

constexpr std::array marks{2e-3, 10e-3, 20e-3}; // m, displacements at which forces are results

std::string name_of(const TieTest& test) {
    return fmt::format("VCI{:g}{}", test.vci, test.with_shoulder ? "" : "_no_shoulder");
}

std::vector<TieTest> tests_of(const TieBed& bed) {
    std::vector<TieTest> tests;
    for (const double vci : bed.vci)
        for (const bool with : {true, false})
            if (bed.shoulders == "both" || with == (bed.shoulders == "with"))
                tests.push_back({vci, with});
    return tests;
}

/// One test of a bed, and its results.
class PushRun {
public:
    PushRun(const TieBed& bed, const Common& common, const Archive& made, const TieTest& test,
            unsigned threads, const ReportProgress& report)
        : bed_(bed), test_(test), simulation_(make_tie_bed(bed, common.seed, threads)),
          common_(common) {
        common_.out = common.out / name_of(test);
        fs::create_directories(common_.out);
        run_ = std::make_unique<Run>(simulation_, common_, "tie_push", report);
        run_->keep(curve_);
        const auto file = checkpoint_of(common, fs::path(name_of(test)) / "tie_push");
        simulation_.restore(made); // the fields are made for this bed
        add_fines(simulation_, bed_, test_, common.seed, file.empty());
        if (!file.empty()) run_->resume(file);
    }

    void go() {
        FrameWriter frames(run_->file("tie_push", ".vtkhdf"), common_.settings,
                           bed_.written.extras());
        run_->go(push_phases(bed_, test_, curve_, [&](const World& world) { frames.add(world); }));
        curve_.write_csv(common_.out / "curve.csv");
        if (frames.frames() > 0) {
            curve_.write_track(frames.file());
            frames.file().close();
        }
        View view = view_of_bodies(
            std::as_const(simulation_).world(), frame_of_bodies(std::as_const(simulation_).world()),
            [](std::size_t k) { return rock_colour(static_cast<std::uint32_t>(k)); });
        std::erase_if(view.balls, [](const DrawnBall& ball) { return ball.centre.z() < -0.1; });
        std::erase_if(view.quads, [](const auto& quad) { return quad[0].z() > 0.9; });
        view.caption = fmt::format("{}, {:.1f} mm", name_of(test_),
                                   1e3 * curve_[&PushSample::displacement].back());
        draw_picture(common_.out / "bed.png", {&view, 1}, {.azimuth = -1.2, .elevation = 0.3});
        write_results(common_, summary());
    }

    const TieTest& test() const { return test_; }
    std::string name() const { return name_of(test_); }
    const SeriesOf<PushSample>& curve() const { return curve_; }

    /// Mean of a column over a tenth of a millimetre or more around a displacement (m).
    double near(double PushSample::*number, double displacement) const {
        const auto &x = curve_[&PushSample::displacement], &y = curve_[number];
        const double reach = std::max(0.25e-3, 1.1 * bed_.interval);
        double sum = 0, count = 0;
        for (std::size_t k = 0; k < x.size(); ++k)
            if (std::abs(x[k] - displacement) <= reach) sum += y[k], ++count;
        return sum / count;
    }

    Report summary() const {
        const World& world = simulation_.world();
        Report s;
        for (const double mark : marks) {
            if (mark > bed_.displacement * (1 + 1e-9)) continue;
            const double force = near(&PushSample::force, mark);
            const std::string at = fmt::format("_at_{:g}_mm", 1e3 * mark);
            s.add("force" + at + "_N", force);
            s.add("base_share" + at, near(&PushSample::base_force, mark) / force);
            s.add("crib_share" + at, near(&PushSample::crib_force, mark) / force);
            s.add("end_share" + at, near(&PushSample::end_force, mark) / force);
            s.add("lift" + at + "_m", near(&PushSample::lift, mark));
            s.show({"force" + at + "_N"});
        }
        const auto& force = curve_[&PushSample::force];
        const auto peak = std::ranges::max_element(force) - force.begin();
        s.add("largest_force_N", force[static_cast<std::size_t>(peak)]);
        s.add("largest_force_displacement_m",
              curve_[&PushSample::displacement][static_cast<std::size_t>(peak)]);
        s.add("largest_unbalanced_ratio", std::ranges::max(curve_[&PushSample::unbalanced_ratio]));
        // at rest the ballast carries the tie
        s.add("support_over_weight_at_start",
              curve_[&PushSample::support].front() / (9.81 * bed_.tie_mass));
        s.add("time_step_s", world.resource<Clock>().dt);
        if (test_.vci > 0 || bed_.fouling.any()) add_fouling_results(s, world);
        run_->add_to_summary(s);
        s.show({"largest_force_N", "largest_force_displacement_m", "largest_unbalanced_ratio",
                "wall_time_s"});
        return s;
    }

private:
    const TieBed& bed_;
    TieTest test_;
    Simulation simulation_;
    SeriesOf<PushSample> curve_{"push"};
    Common common_;
    std::unique_ptr<Run> run_;
};

using Runs = std::vector<std::unique_ptr<PushRun>>;

/// Loss of force without a shoulder, and by fines, at each displacement.
void add_losses(Report& summary, const Runs& runs, const TieBed& bed) {
    for (const double mark : marks) {
        if (mark > bed.displacement * (1 + 1e-9)) continue;
        const auto force = [&](const PushRun& r) { return r.near(&PushSample::force, mark); };
        for (const auto& run : runs)
            for (const auto& other : runs) {
                const TieTest &a = run->test(), &b = other->test();
                const double loss = 100 * (1 - force(*other) / force(*run));
                if (a.vci == b.vci && a.with_shoulder && !b.with_shoulder)
                    summary.add(fmt::format("VCI{:g}_loss_without_shoulder_at_{:g}_mm_percent",
                                            a.vci, 1e3 * mark),
                                loss);
                if (a.vci == bed.vci.front() && b.vci != a.vci && a.with_shoulder &&
                    b.with_shoulder)
                    summary.add(fmt::format("VCI{:g}_loss_at_{:g}_mm_percent", b.vci, 1e3 * mark),
                                loss);
            }
    }
}

void draw(const Runs& runs, const Common& common) {
    Plot force{.title = "Lateral resistance",
               .x_label = "displacement (mm)",
               .y_label = "force on the tie (kN)"},
        shares{.title = fmt::format("Parts of the force, {}", name_of(runs.front()->test())),
               .x_label = "displacement (mm)",
               .y_label = "force (kN)"};
    const auto curve = [](const PushRun& run, double PushSample::*number,
                          const std::string& label) {
        Curve c = run.curve().curve(number, label); // over the displacement, the first column
        for (double& x : c.x) x *= 1e3;
        for (double& y : c.y) y *= 1e-3;
        return c;
    };
    for (const auto& run : runs)
        force.curves.push_back(curve(*run, &PushSample::force, name_of(run->test())));
    shares.curves = {curve(*runs.front(), &PushSample::base_force, "base"),
                     curve(*runs.front(), &PushSample::crib_force, "crib"),
                     curve(*runs.front(), &PushSample::end_force, "end")};
    draw_plots(common.out / "tie_push.png", {force, shares});
}

void check_options(const TieBed& bed, const Common& common) {
    require_folder_to_resume(common);
    check_tie_bed(bed);
    say_how_read(grading_named(bed.rocks.grading));
}

void run(const TieBed& bed, const Common& common) {
    const std::vector<TieTest> tests = tests_of(bed);
    Progress progress = make_progress(common);
    Simulation making = make_tie_bed(bed, common.seed, common.threads);
    Run of_bed(making, common, "specimen", progress_slot(progress, 0));
    make_bed(of_bed, making, common, settings_of_tests);
    const Archive made = making.snapshot();
    const World& bed_world = std::as_const(making).world();
    const auto rocks = bed_world.resource<RockBed>().rocks.size();
    const double porosity = bed_world.resource<RockBedState>().porosity;
    progress.pause();
    report_news(common, fmt::format("bed of {} rocks: porosity below the tie and the crib {:.4f}",
                                    rocks, porosity));
    const Runs runs =
        run_tests(tests, 1 + bed.displacement / bed.interval, common, progress,
                  [&](const TieTest& test, unsigned threads, const ReportProgress& report) {
                      return std::make_unique<PushRun>(bed, common, made, test, threads, report);
                  });
    draw(runs, common);
    Report all;
    all.add("rocks", rocks);
    all.add("core_porosity", porosity);
    all.show({"rocks", "core_porosity"});
    add_losses(all, runs, bed);
    add_results_of_tests(all, runs);
    report_results(common, all);
}

std::string explain(const TieBed& bed, const Common& common) {
    Simulation simulation = make_tie_bed(bed, common.seed, 1);
    add_fines(simulation, bed, {.vci = bed.vci.back()}, common.seed, false);
    return simulation.schedule().explain();
}

} // namespace

int main(int argc, char** argv) {
    return run_scenario<TieBed>(argc, argv,
                                {.name = "tie_push",
                                 .description = "Lateral resistance of a single tie in ballast.",
                                 .makes_beds = true},
                                check_options, run, explain);
}
