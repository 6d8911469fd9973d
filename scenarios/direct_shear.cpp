// Direct shear of railway ballast in a large box: the lower half moves, the upper half is fixed,
// and a plate keeps the normal stress while the ballast dilates. Several normal stresses and
// several amounts of fines are tested on the same specimens.
#include "engine/errors.hpp"
#include "engine/io/csv.hpp"
#include "engine/io/plot.hpp"
#include "engine/report.hpp"
#include "engine/run.hpp"
#include "scenarios/field_tests/bed_tests.hpp"
#include "scenarios/field_tests/grains.hpp"
#include "scenarios/field_tests/shear_box.hpp"
#include "scenarios/field_tests/shear_results.hpp"
#include "scenarios/specimens/scene.hpp"
#include "systems/output/frames.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <memory>
#include <string_view>

namespace {

using namespace bris;
namespace fs = std::filesystem;

/// Settings that do not concern the specimen: it can be tested again with others.
const std::vector<std::string_view> settings_of_tests{
    "normal_stress_Pa", "vci_percent", "speed_m_per_s", "interval_m",    "tolerance",
    "safety",           "fines",       "fines_size_m",  "fines_friction"};

/// A made specimen.
struct Packing {
    Archive state = {};
    double core_porosity = 0, poured_porosity = 0, largest_rock = 0;
    std::size_t rocks = 0;
};

std::string name_of(const ShearTest& test) {
    return fmt::format("{:g}kPa_VCI{:g}", 1e-3 * test.normal_stress, test.vci);
}

std::vector<ShearTest> tests_of(const ShearBox& box) {
    std::vector<ShearTest> tests;
    for (const double vci : box.vci)
        for (const double stress : box.normal_stress) tests.push_back({stress, vci});
    return tests;
}

Packing make_packing(const ShearBox& box, const Common& common, const ReportProgress& report) {
    Packing made;
    Simulation simulation = make_shear_box(box, common.seed, common.threads);
    const World& world = std::as_const(simulation).world();
    Run run(simulation, common, "specimen", report);
    make_bed(run, simulation, common, settings_of_tests);
    made.state = simulation.snapshot();
    made.core_porosity = world.resource<RockBedState>().porosity;
    made.poured_porosity = world.resource<RockBedState>().poured;
    made.largest_rock = world.resource<RockBed>().largest_size;
    made.rocks = world.resource<RockBed>().rocks.size();
    return made;
}

/// One test of a specimen, and its results.
class ShearRun {
public:
    ShearRun(const ShearBox& box, const Common& common, const Packing& packing,
             const ShearTest& test, unsigned threads, const ReportProgress& report)
        : box_(box), test_(test), simulation_(make_shear_box(box, common.seed, threads)),
          common_(common) {
        common_.out = common.out / name_of(test);
        fs::create_directories(common_.out);
        run_ = std::make_unique<Run>(simulation_, common_, "direct_shear", report);
        run_->keep(curve_);
        const auto file = checkpoint_of(common, fs::path(name_of(test)) / "direct_shear");
        if (file.empty()) simulation_.restore(packing.state);
        add_fines(simulation_, box_, test_, common.seed, file.empty());
        if (!file.empty()) run_->resume(file);
    }

    void go() {
        FrameWriter frames(run_->file("direct_shear", ".vtkhdf"), common_.settings,
                           box_.written.extras());
        run_->go(shear_phases(box_, test_, curve_, [&](const World& world) {
            frames.add(world);
            note_view(world);
        }));
        curve_.write_csv(common_.out / "curve.csv");
        if (frames.frames() > 0) {
            curve_.write_track(frames.file());
            frames.file().close();
        }
        if (views_.size() >= 2) {
            std::array<View, 2> shown{views_.front(), views_.back()};
            draw_picture(common_.out / "box.png", shown, {.azimuth = 0, .elevation = 0.1}, 700);
        }
        write_results(common_, summary());
    }

    const ShearTest& test() const { return test_; }
    std::string name() const { return name_of(test_); }
    const SeriesOf<ShearSample>& curve() const { return curve_; }
    ShearProperties properties() const { return properties_of(curve_); }

    Report summary() const {
        const ShearProperties p = properties();
        Report s;
        s.add("peak_shear_stress_Pa", p.peak_stress);
        s.add("peak_normal_stress_Pa", p.peak_normal);
        s.add("peak_stress_ratio", p.peak_ratio());
        s.add("peak_friction_angle_deg", p.peak_angle());
        s.add("peak_plane_normal_stress_Pa", p.peak_plane_normal);
        s.add("peak_plane_friction_angle_deg", p.peak_plane_angle());
        s.add("peak_displacement_m", p.peak_displacement);
        s.add("residual_shear_stress_Pa", p.residual_stress);
        s.add("residual_stress_ratio", p.residual_ratio());
        s.add("residual_friction_angle_deg", p.residual_angle());
        s.add("dilation_m", p.dilation);
        s.add("largest_dilation_angle_deg", p.dilation_angle);
        s.add("shear_force_imbalance", p.shear_imbalance);
        s.add("vertical_force_imbalance", p.normal_imbalance);
        s.add("relative_energy_error", p.energy_error);
        s.add("largest_inertial_number", p.inertial_number);
        const World& world = std::as_const(simulation_).world();
        const auto& state = world.resource<ShearState>();
        s.add("height_m", state.start_height);
        s.add("void_contaminant_index_at_start_percent", state.start_vci);
        s.add("time_step_s", world.resource<Clock>().dt);
        if (world.has_resource<Fouling>()) add_fouling_results(s, world);
        if (box_.fines == "grains") s.add("grains", grains_in(world));
        run_->add_to_summary(s);
        s.show({"peak_shear_stress_Pa", "peak_friction_angle_deg", "peak_displacement_m",
                "residual_friction_angle_deg", "dilation_m", "shear_force_imbalance",
                "relative_energy_error", "wall_time_s"});
        return s;
    }

private:
    /// The rocks, coloured by their displacement since the first view over that of the lower half.
    void note_view(const World& world) {
        const BodyFrame frame = frame_of_bodies(world);
        if (at_start_.empty()) at_start_ = frame.positions;
        views_.push_back(view_of_bodies(world, frame, [&](std::size_t k) {
            return scale_colour((frame.positions[k] - at_start_[k]).x() / box_.displacement);
        }));
        views_.back().caption =
            fmt::format("{:.1f} mm", 1e3 * world.resource<ShearState>().displacement);
    }

    const ShearBox& box_;
    ShearTest test_;
    Simulation simulation_;
    SeriesOf<ShearSample> curve_{"shear"};
    Common common_;
    std::unique_ptr<Run> run_;
    std::vector<View> views_;
    std::vector<Vec3> at_start_;
};

using Runs = std::vector<std::unique_ptr<ShearRun>>;

/// A value of all tests with an amount of fines, in the order of the normal stresses.
template <class Value>
std::vector<double> collect(const Runs& runs, double vci, Value&& value) {
    std::vector<double> all;
    for (const auto& run : runs)
        if (run->test().vci == vci) all.push_back(value(run->properties()));
    return all;
}

void add_fits(Report& summary, const ShearBox& box, const Runs& runs) {
    using P = ShearProperties;
    if (box.normal_stress.size() < 2) return;
    const auto add = [&](const std::string& key, const StrengthFit& fit) {
        summary.add(key + "_cohesion_Pa", fit.cohesion);
        summary.add(key + "_friction_angle_fitted_deg", fit.angle);
        summary.add(key + "_power_law_exponent", fit.exponent);
        summary.show({key + "_cohesion_Pa", key + "_friction_angle_fitted_deg"});
    };
    for (const double vci : box.vci) {
        const std::string key = fmt::format("VCI{:g}_", vci);
        add(key + "peak",
            fit_strength(collect(runs, vci, [](const P& p) { return p.peak_normal; }),
                         collect(runs, vci, [](const P& p) { return p.peak_stress; })));
        add(key + "residual",
            fit_strength(collect(runs, vci, [](const P& p) { return p.residual_normal; }),
                         collect(runs, vci, [](const P& p) { return p.residual_stress; })));
    }
}

/// Relative loss of the stress ratio at the peak and at the end against the tests of the same
/// specimen with the first amount of fines, mean over the normal stresses.
void add_losses(Report& summary, const ShearBox& box, const Runs& runs) {
    const auto peak = [](const ShearProperties& p) { return p.peak_ratio(); };
    const auto residual = [](const ShearProperties& p) { return p.residual_ratio(); };
    const auto loss = [](const std::vector<double>& clean, const std::vector<double>& fouled) {
        double sum = 0;
        for (std::size_t n = 0; n < clean.size(); ++n) sum += 1 - fouled[n] / clean[n];
        return 100 * sum / static_cast<double>(clean.size());
    };
    for (std::size_t v = 1; v < box.vci.size(); ++v) {
        const double from = box.vci.front(), to = box.vci[v];
        const std::string key = fmt::format("VCI{:g}_", to);
        summary.add(key + "peak_loss_percent",
                    loss(collect(runs, from, peak), collect(runs, to, peak)));
        summary.add(key + "residual_loss_percent",
                    loss(collect(runs, from, residual), collect(runs, to, residual)));
        summary.show({key + "peak_loss_percent", key + "residual_loss_percent"});
    }
}

void write_table(const fs::path& path, const Runs& runs) {
    std::vector<std::vector<double>> rows;
    for (const auto& run : runs) {
        const ShearProperties p = run->properties();
        rows.push_back({run->test().normal_stress, run->test().vci, p.peak_stress, p.peak_normal,
                        p.peak_angle(), p.peak_displacement, p.residual_stress, p.residual_angle(),
                        p.dilation, p.dilation_angle, p.shear_imbalance, p.normal_imbalance,
                        p.energy_error});
    }
    write_csv(path,
              {"normal_stress_Pa", "vci_percent", "peak_shear_stress_Pa", "peak_normal_stress_Pa",
               "peak_friction_angle_deg", "peak_displacement_m", "residual_shear_stress_Pa",
               "residual_friction_angle_deg", "dilation_m", "largest_dilation_angle_deg",
               "shear_force_imbalance", "vertical_force_imbalance", "relative_energy_error"},
              rows);
}

void draw(const ShearBox& box, const Runs& runs, const Common& common) {
    Plot shear{
        .title = "Shear stress", .x_label = "displacement (mm)", .y_label = "shear stress (kPa)"},
        dilation{.title = "Dilation",
                 .x_label = "displacement (mm)",
                 .y_label = "rise of the plate (mm)"},
        strength{.title = "Peak strength",
                 .x_label = "normal stress (kPa)",
                 .y_label = "peak shear stress (kPa)"};
    for (const auto& run : runs) {
        const auto& t = run->test();
        Curve a{.label = fmt::format("{:g} kPa, VCI {:g} %", 1e-3 * t.normal_stress, t.vci)}, b;
        const auto& c = run->curve();
        for (std::size_t k = 0; k < c.rows(); ++k) {
            a.x.push_back(1e3 * c[&ShearSample::displacement][k]);
            a.y.push_back(1e-3 * c[&ShearSample::shear_stress][k]);
            b.y.push_back(1e3 * c[&ShearSample::dilation][k]);
        }
        b.x = a.x;
        b.label = a.label;
        shear.curves.push_back(a);
        dilation.curves.push_back(b);
    }
    for (const double vci : box.vci) {
        Curve points{.label = fmt::format("VCI {:g} %", vci), .style = Curve::Style::points};
        points.x =
            collect(runs, vci, [](const ShearProperties& p) { return 1e-3 * p.peak_normal; });
        points.y =
            collect(runs, vci, [](const ShearProperties& p) { return 1e-3 * p.peak_stress; });
        strength.curves.push_back(points);
    }
    std::vector<Plot> panels{shear, dilation};
    if (box.normal_stress.size() > 1) panels.push_back(strength);
    draw_plots(common.out / "direct_shear.png", panels);
}

void check_options(const ShearBox& box, const Common& common) {
    require_folder_to_resume(common);
    check_shear_box(box);
    say_how_read(grading_named(box.rocks.grading));
}

void run(const ShearBox& box, const Common& common) {
    const std::vector<ShearTest> tests = tests_of(box);
    Progress progress = make_progress(common);
    const Packing packing = make_packing(box, common, progress_slot(progress, 0));
    progress.pause();
    report_news(common, fmt::format("specimen of {} rocks: core porosity {:.4f}, as poured {:.4f}",
                                    packing.rocks, packing.core_porosity, packing.poured_porosity));
    const Runs runs = run_tests(
        tests, 1 + box.displacement / box.interval, common, progress,
        [&](const ShearTest& test, unsigned threads, const ReportProgress& report) {
            return std::make_unique<ShearRun>(box, common, packing, test, threads, report);
        });
    draw(box, runs, common);
    write_table(common.out / "tests.csv", runs);
    Report all;
    all.add("rocks", packing.rocks);
    all.add("box_over_largest_rock", std::min(box.length, box.width) / packing.largest_rock);
    all.add("core_porosity", packing.core_porosity);
    all.add("poured_porosity", packing.poured_porosity);
    all.show({"rocks", "box_over_largest_rock", "core_porosity"});
    add_fits(all, box, runs);
    add_losses(all, box, runs);
    add_results_of_tests(all, runs);
    report_results(common, all);
}

std::string explain(const ShearBox& box, const Common& common) {
    Simulation simulation = make_shear_box(box, common.seed, 1);
    add_fines(simulation, box, {.vci = box.vci.back()}, common.seed, false);
    return simulation.schedule().explain();
}

} // namespace

int main(int argc, char** argv) {
    return run_scenario<ShearBox>(argc, argv,
                                  {.name = "direct_shear",
                                   .description = "Direct shear of railway ballast in a large box.",
                                   .makes_beds = true},
                                  check_options, run, explain);
}
