// A section of ballasted track in a box: the second experiment of H. Huang, Ballast Real-time
// Information System, Rail Safety IDEA Project 30 (2019). Three lifts of ballast are poured and
// compacted on a subgrade of springs, ties are laid on them and loaded in cycles beside a shoulder
// that bladders support. Two models: `settlement` and `dynamic` (see scenarios/README.md).
#include "components/body.hpp"
#include "components/kinds.hpp"
#include "engine/errors.hpp"
#include "engine/io/csv.hpp"
#include "engine/io/plot.hpp"
#include "engine/ranks.hpp"
#include "engine/report.hpp"
#include "engine/run.hpp"
#include "scenarios/ballast_box/box_run.hpp"
#include "scenarios/ballast_box/cycles.hpp"
#include "scenarios/ballast_box/draw_box.hpp"
#include "scenarios/ballast_box/start_box.hpp"
#include "scenarios/specimens/last_quantities.hpp"
#include "scenarios/specimens/recorded_motion.hpp"
#include "scenarios/specimens/scene.hpp"
#include "systems/fields/field_set.hpp"
#include "systems/output/frames.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace {

using namespace bris;

/// Range of an actuator's load over the resilient deflection (m), N/m, in series with what the
/// model lacks; NaN without a rebound.
double stiffness_of(double resilient, const BallastBox& box) {
    if (!(resilient > 0)) return std::numeric_limits<double>::quiet_NaN();
    return 1 / (resilient / (box.peak() - box.least()) + box.series_compliance);
}

void add_bed(Report& summary, const World& world) {
    const auto& state = world.resource<BoxState>();
    for (std::size_t lift = 0; lift < state.porosity.size(); ++lift) {
        summary.add(fmt::format("lift_{}_porosity", lift + 1), state.porosity[lift]);
        summary.add(fmt::format("lift_{}_surface_m", lift + 1), state.surface[lift]);
    }
    summary.add("bed_porosity", state.bed_porosity);
    summary.add("unbalanced_ratio_before_cycles", state.seat_ratio);
    summary.add("load_carried_by_ballast_before_cycles", state.seat_support);
}

/// Results of the fields: of the whole, of each lift, and as files and a picture.
void add_fouling(Report& summary, const World& world, const Common& common) {
    add_fouling_results(summary, world);
    const Fouling present = present_fouling(world);
    double low = 0;
    std::size_t lift = 0;
    for (const double high : world.resource<BoxState>().surface) {
        const FoulingMeasures m = measure_fouling(world, present, low, high);
        const std::string name = fmt::format("lift_{}_", ++lift);
        summary.add(name + "void_contaminant_index_percent", m.contaminant_index);
        summary.add(name + "void_contamination_percent", m.void_contamination);
        summary.add(name + "saturation_percent", m.saturation);
        low = high;
    }
    const FieldSet set = fields_of(world, {});
    write_fields(set, common.out, "fields", world.resource<Clock>().time(), common.settings);
    draw_slice(set, {"porosity", "fouling", "saturation", "mean_stress"},
               common.out / "fields.png");
}

/// Largest difference between what the ballast carries and the loads and weights of the ties, over
/// the largest of the latter: what their inertia takes. Small in a quasi-static run.
double inertial_share(const SeriesOf<CycleSample>& samples) {
    const auto &load = samples[&CycleSample::tie_load],
               &support = samples[&CycleSample::tie_support];
    double most = 0;
    for (std::size_t k = 0; k < load.size(); ++k)
        most = std::max(most, std::abs(support[k] - load[k]));
    return most / std::ranges::max(load);
}

void add_cycles(Report& summary, const BallastBox& box, const std::vector<CycleResponse>& first,
                const std::vector<CycleResponse>& other) {
    if (first.empty()) return;
    const double range = box.peak() - box.least();
    summary.add("settlement_mm", 1e3 * first.back().settlement);
    summary.add("settlement_first_cycle_mm", 1e3 * first.front().settlement);
    summary.add("resilient_deflection_mm", 1e3 * first.back().resilient);
    summary.add("track_stiffness_kN_per_mm", 1e-6 * stiffness_of(first.back().resilient, box));
    summary.add("model_compliance_um_per_kN", 1e9 * first.back().resilient / range);
    if (!box.is_dynamic()) {
        const double sliding =
            first.back().resilient - first.back().of_subgrade - first.back().of_contacts;
        summary.add("subgrade_compliance_um_per_kN", 1e9 * first.back().of_subgrade / range);
        summary.add("contact_compliance_um_per_kN", 1e9 * first.back().of_contacts / range);
        summary.add("sliding_compliance_um_per_kN", 1e9 * sliding / range);
    }
    summary.add("loop_area_last_cycle_J", first.back().loop_area);
    summary.add("other_tie_settlement_mm", 1e3 * other.back().settlement);
    if (first.size() < 10) return;
    const SettlementFit logarithmic = fit_logarithmic(first), power = fit_power(first);
    summary.add("logarithmic_law_mm_per_decade", 1e3 * std::log(10) * logarithmic.slope);
    summary.add("logarithmic_law_residual_mm", 1e3 * logarithmic.residual);
    summary.add("power_law_exponent", power.slope);
    summary.add("power_law_residual_mm", 1e3 * power.residual);
}

void write_cycles(const std::filesystem::path& path, const BallastBox& box,
                  const std::vector<CycleResponse>& first) {
    std::vector<std::vector<double>> rows;
    for (const CycleResponse& c : first)
        rows.push_back({static_cast<double>(rows.size() + 1), c.settlement, c.resilient,
                        c.of_subgrade, c.of_contacts, stiffness_of(c.resilient, box), c.loop_area});
    write_csv(path,
              {"cycle", "settlement_m", "resilient_deflection_m", "subgrade_deflection_m",
               "contact_deflection_m", "track_stiffness_N_per_m", "loop_area_J"},
              rows);
}

void draw(const World& world, const BallastBox& box, const SeriesOf<CycleSample>& samples,
          const std::vector<CycleResponse>& first, const Common& common) {
    Curve loop{.label = "tie 1"}, settlement{.label = "tie 1"}, stiffness{.label = "tie 1"};
    const auto &load = samples[&CycleSample::load_1],
               &deflection = samples[&CycleSample::deflection_1];
    for (std::size_t k = 0; k < load.size(); ++k) {
        loop.x.push_back(1e3 * deflection[k]);
        loop.y.push_back(1e-3 * load[k]);
    }
    for (std::size_t n = 0; n < first.size(); ++n) {
        settlement.x.push_back(static_cast<double>(n + 1));
        settlement.y.push_back(1e3 * first[n].settlement);
        stiffness.x.push_back(static_cast<double>(n + 1));
        stiffness.y.push_back(1e-6 * stiffness_of(first[n].resilient, box));
    }
    const auto unless_empty = [](Curve& curve) {
        return curve.x.empty() ? std::vector<Curve>{} : std::vector<Curve>{std::move(curve)};
    };
    std::vector<Plot> panels{{.title = "Load and deflection",
                              .x_label = "deflection of the tie (mm)",
                              .y_label = "load on the model's tie (kN)",
                              .curves = unless_empty(loop)},
                             {.title = "Settlement",
                              .x_label = "cycle",
                              .y_label = "settlement at the least load (mm)",
                              .curves = unless_empty(settlement),
                              .x_logarithmic = first.size() >= 20},
                             {.title = "Track stiffness",
                              .x_label = "cycle",
                              .y_label = "track stiffness (kN/mm)",
                              .curves = unless_empty(stiffness),
                              .x_logarithmic = first.size() >= 20}};
    draw_plots(common.out / "ballast_box.png", panels);
    draw_box(world, common.out / "box.png",
             fmt::format("Ballast box, run {}, model {}. Red: sensor rocks.", box.run, box.model));
}

/// What the loading costs, and what 1 000 cycles would take at its speed.
void add_cost(Report& summary, const BoxTestRun& test, const StepCount& before,
              const StepCount& after) {
    const double step = (after.wall_time - before.wall_time) /
                        static_cast<double>(std::max<std::uint64_t>(1, after.steps - before.steps));
    const auto per_cycle = static_cast<double>(test.steps_per_cycle());
    summary.add("loading_time_per_step_s", step);
    summary.add("loading_steps_per_cycle", test.steps_per_cycle());
    summary.add("thousand_cycles_at_this_speed_h", 1000 * per_cycle * step / 3600);
}

/// Levels of one recording, about the mean acceleration: `prefix` tells who recorded. Nothing of a
/// recording that has hardly begun.
void add_levels(Report& summary, const Recording& r, const std::string& prefix,
                const std::string& name) {
    constexpr std::size_t fewest = 10; // samples
    if (r.size() < fewest) return;
    const auto count = static_cast<double>(r.size());
    Vec3 mean = Vec3::Zero();
    for (const Vec3& f : r.force) mean += f / count;
    double squares = 0, peak = 0, turned = 0;
    for (std::size_t k = 0; k < r.size(); ++k) {
        squares += (r.force[k] - mean).squaredNorm() / count;
        peak = std::max(peak, (r.force[k] - mean).norm());
        turned += r.rate[k].squaredNorm() / count;
    }
    summary.add(prefix + "acceleration_rms_" + name + "_m_per_s2", std::sqrt(squares));
    summary.add(prefix + "acceleration_peak_" + name + "_m_per_s2", peak);
    summary.add(prefix + "rotation_rate_rms_" + name + "_rad_per_s", std::sqrt(turned));
}

/// Writes the recordings of the sensor rocks and adds their levels, those by a device without
/// errors too.
void write_sensors(Report& summary, const World& world, const Common& common) {
    if (!world.has_resource<InertialRecorders>()) return;
    const std::vector<Recording> recordings = recordings_of(world),
                                 exact = recordings_of(world, &InertialRecorder::exact);
    for (std::size_t k = 0; k < recordings.size(); ++k) {
        const auto& s =
            *std::ranges::find(world.resource<BoxBodies>().sensors,
                               world.resource<InertialRecorders>().list[k].body, &BoxSensor::body);
        add_levels(summary, recordings[k], "", s.name);
        add_levels(summary, exact[k], "exact_", s.name);
        write_sensor_info(common.out / fmt::format("rock_{:02}.txt", k + 1), recordings[k].info);
    }
    write_recordings(common.out / "recordings.csv", recordings,
                     {"Recorded by the sensor rocks of a ballast box; the pose in rock_NN.txt is "
                      "that at the end of the run"});
}

void summarise(Report& summary, const World& world, const BallastBox& box,
               const SeriesOf<CycleSample>& samples, const Common& common) {
    const auto first = cycle_responses(samples, 1), other = cycle_responses(samples, 2);
    const std::size_t rocks = world.resource<BoxBodies>().number_of_rocks();
    summary.add("rocks", rocks);
    summary.add("cycles_done", first.size());
    summary.add("peak_load_kN", 1e-3 * box.peak());
    summary.add("load_share_of_model", box_sizes(box).share);
    summary.add("truncated_mass_fraction", world.resource<BoxBodies>().truncated_fraction);
    add_bed(summary, world);
    if (world.has_resource<Fouling>()) add_fouling(summary, world, common);
    add_cycles(summary, box, first, other);
    summary.add("inertial_share_of_load", inertial_share(samples));
    const auto &pressure = samples[&CycleSample::bladder_pressure],
               &moved = samples[&CycleSample::bladder_displacement];
    summary.add("bladder_pressure_largest_kPa", 1e-3 * std::ranges::max(pressure));
    summary.add("bladder_displacement_largest_mm", 1e3 * std::ranges::max(moved));
    summary.add("subgrade_settlement_largest_mm",
                1e3 * std::ranges::max(samples[&CycleSample::subgrade_settlement]));
    write_sensors(summary, world, common);
}

/// Settings that act after the bed was made, which serves for any of their values.
std::vector<std::string_view> settings_after_bed(const BallastBox& box, const Common& common) {
    std::vector<std::string_view> keys = settings_of_state(box, common);
    keys.insert(keys.end(),
                {"cycles", "frequency_Hz", "peak_load_N", "least_load", "steps_per_cycle",
                 "rail_bending_N_m2", "tie_support_N_per_m", "tie_level_m",
                 "series_compliance_m_per_N", "rest", "step_fraction", "imu", "sampling_rate_Hz"});
    if (!box.is_full()) keys.push_back("box_ties");
    if (box.is_dynamic()) keys.push_back("restitution"); // has no effect before
    return keys;
}

void check_options(const BallastBox& box, const Common&) {
    say_how_read(grading_named(box.grading)); // all else is checked where the scene is made
}

void run(const BallastBox& box, const Common& common) {
    Simulation simulation = make_box_simulation(box, common);
    const World& world = simulation.world();
    BoxTestRun test(simulation, box, common.seed);
    SeriesOf<CycleSample> samples("box");
    LastQuantities last(simulation);
    Run run(simulation, common, "ballast_box");
    run.keep(samples);
    run.keep(last);
    const BoxBed bed(simulation, common, settings_after_bed(box, common));
    bed.begin(run, simulation, box, {"cycles"});
    FrameWriter frames(run.file("ballast_box", ".vtkhdf"), common.settings, box.written.extras());
    std::vector<Phase> phases = test.preparation(save_bed(run, [&bed] { bed.keep(); }));
    StepCount before_loading; // of this process
    std::vector<Vec3> at_beginning;
    std::string since = "since the run was resumed";
    if (run.is_resumed()) at_beginning = positions_in_frame(world);
    Phase loading = test.loading(run, samples, [&] { frames.add(world); });
    loading.begin = [&, begin = loading.begin](Simulation& s) {
        before_loading = s.count();
        at_beginning = positions_in_frame(s.world());
        since = "since the cycles began";
        begin(s);
    };
    phases.push_back(std::move(loading));
    run.go(phases);
    const auto first = cycle_responses(samples, 1);
    draw(world, box, samples, first, common);
    if (Ranks::size() > 1) draw_ranks(world, common.out / "ranks.png");
    draw_displacements(world, at_beginning, common.out / "displacement.png", since);
    samples.write_csv(common.out / "samples.csv");
    write_cycles(common.out / "cycles.csv", box, first);
    samples.write_track(frames.file());
    frames.file().close();

    Report summary;
    summarise(summary, world, box, samples, common);
    add_cost(summary, test, before_loading, simulation.count());
    summary.add("time_step_s", world.resource<Clock>().dt);
    summary.add("stable_step_s", last.stable_step());
    add_quantities(summary, last.quantities());
    run.add_to_summary(summary);
    if (!first.empty())
        summary.show({"cycles_done", "peak_load_kN", "settlement_mm", "settlement_first_cycle_mm",
                      "resilient_deflection_mm", "track_stiffness_kN_per_mm",
                      "other_tie_settlement_mm"});
    summary.show({"rocks", "bed_porosity", "inertial_share_of_load", "bladder_pressure_largest_kPa",
                  "unbalanced_ratio", "steps", "wall_time_s", "thousand_cycles_at_this_speed_h"});
    if (world.has_resource<Fouling>())
        summary.show({"void_contaminant_index_percent", "saturation_percent"});
    report_results(common, summary);
}

} // namespace

int main(int argc, char** argv) {
    return run_scenario<BallastBox>(
        argc, argv,
        {.name = "ballast_box",
         .description = "A section of ballasted track under cyclic loads (runs of table 1).",
         .divides = true,
         .makes_beds = true},
        check_options, run, explain_box);
}
