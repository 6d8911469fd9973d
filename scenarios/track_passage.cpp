// Trains pass over a tie of a bay of track on clean or fouled ballast; sensor rocks in the ballast
// record what SmartRocks would record. The rails push the tie as a beam on it and on springs, which
// stand for the other ties, under the static loads of the axles.
#include "components/kinds.hpp"
#include "engine/choice.hpp"
#include "engine/errors.hpp"
#include "engine/io/plot.hpp"
#include "engine/io/series.hpp"
#include "engine/report.hpp"
#include "engine/run.hpp"
#include "engine/signal/spectrum.hpp"
#include "scenarios/ballast_box/draw_box.hpp"
#include "scenarios/ballast_box/load_band.hpp"
#include "scenarios/ballast_box/passages.hpp"
#include "scenarios/ballast_box/start_box.hpp"
#include "scenarios/monitoring/passage.hpp"
#include "scenarios/monitoring/sensor_levels.hpp"
#include "scenarios/monitoring/vibration.hpp"
#include "scenarios/specimens/last_quantities.hpp"
#include "scenarios/specimens/recorded_motion.hpp"
#include "scenarios/specimens/scene.hpp"
#include "systems/output/frames.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace {

using namespace bris;

std::string folder_of(unsigned number) { return fmt::format("passage_{:02}", number); }

/// The pose of the metadata is that at the end of the passage.
void write_passage(const World& world, const TrackPassage& t, unsigned number,
                   const std::filesystem::path& out) {
    const std::string what =
        fmt::format("Passage {} of the train '{}' at {:g} m/s", number, t.train, t.train_speed());
    write_passages(out, {{folder_of(number), recordings_of(world)}}, what);
    write_passages(out / "exact",
                   {{folder_of(number), recordings_of(world, &InertialRecorder::exact)}},
                   what + ", by devices without errors");
}

Curve spectrum_of(const Recording& recording, const std::string& name) {
    const Spectrum s =
        spectrum_of_longest(vibration_of(recording, VibrationQuantity::vertical, 0.1));
    Curve curve{.label = name};
    for (std::size_t bin = 1; bin < s.density.size(); ++bin) {
        curve.x.push_back(s.frequency(bin));
        curve.y.push_back(s.density[bin]);
    }
    return curve;
}

Curve vertical_of(const Recording& recording, const std::string& name) {
    const Vibration vertical = vibration_of(recording, VibrationQuantity::vertical, 0.1);
    Curve curve{.label = name};
    for (std::size_t r = 0; r < vertical.runs.size(); ++r)
        for (std::size_t k = 0; k < vertical.runs[r].size(); ++k) {
            curve.x.push_back(vertical.begins[r] - vertical.begins.front() +
                              static_cast<double>(k) / vertical.rate);
            curve.y.push_back(vertical.runs[r][k]);
        }
    return curve;
}

void draw(const SeriesOf<PassageSample>& samples, const World& world,
          const std::vector<Recording>& last, const Common& common) {
    const auto &passage = samples[&PassageSample::passage], &time = samples[&PassageSample::time],
               &load = samples[&PassageSample::load],
               &deflection = samples[&PassageSample::deflection];
    std::vector<Curve> loads, deflections, vertical, spectra;
    for (std::size_t k = 0; k < passage.size(); ++k) {
        if (k == 0 || passage[k] != passage[k - 1]) {
            const std::string label = fmt::format("passage {:g}", passage[k]);
            deflections.push_back({.label = label});
            loads.push_back({.label = label});
        }
        loads.back().x.push_back(time[k]);
        loads.back().y.push_back(1e-3 * load[k]);
        deflections.back().x.push_back(time[k]);
        deflections.back().y.push_back(1e3 * deflection[k]);
    }
    loads.resize(1); // the same in every passage
    const auto& sensors = world.resource<BoxBodies>().sensors;
    for (std::size_t k = 0; k < sensors.size(); ++k) {
        if (sensors[k].course == 0) continue; // those near the tie
        vertical.push_back(vertical_of(last[k], sensors[k].name));
        spectra.push_back(spectrum_of(last[k], sensors[k].name));
    }
    const std::string seconds = "time since the passage began (s)";
    draw_plots(common.out / "track_passage.png",
               {{.title = "Load of the rails on the half tie",
                 .x_label = seconds,
                 .y_label = "load (kN)",
                 .curves = loads},
                {.title = "Deflection of the tie",
                 .x_label = seconds,
                 .y_label = "deflection (mm)",
                 .curves = deflections},
                {.title = "Vertical acceleration, last passage",
                 .x_label = seconds,
                 .y_label = "acceleration (m/s2)",
                 .curves = vertical},
                {.title = "Its spectrum",
                 .x_label = "frequency (Hz)",
                 .y_label = "density ((m/s2)^2/Hz)",
                 .curves = spectra,
                 .x_logarithmic = true,
                 .y_logarithmic = true}},
               2);
    draw_box(world, common.out / "bay.png", "A bay of track. Red: sensor rocks.");
}

void summarise(Report& summary, const TrackPassage& t, const Train& train,
               const SeriesOf<PassageSample>& samples, const World& world,
               const std::vector<Recording>& recordings, LastQuantities& last) {
    const std::size_t rocks = world.resource<BoxBodies>().number_of_rocks();
    summary.add("rocks", rocks);
    summary.add("axles", train.axles.size());
    summary.add("train_length_m", train.length());
    summary.add("train_speed_m_per_s", t.train_speed());
    summary.add("passage_duration_s", passing_time(train, t.train_speed(), t.rails(world)));
    summary.add("bed_porosity", world.resource<BoxState>().bed_porosity);
    summary.add("bed_stiffness_MN_per_m", 1e-6 * world.resource<BoxState>().bed_stiffness);
    summary.add("tie_support_of_rails_MN_per_m", 1e-6 * t.rails(world).tie_support);
    if (world.has_resource<Fouling>()) add_fouling_results(summary, world);
    for (unsigned number = 1; number <= t.passages; ++number) {
        const PassageResponse r = passage_response(samples, number);
        Report passage;
        passage.add("settlement_mm", 1e3 * r.settlement);
        passage.add("deflection_mm", 1e3 * r.deflection);
        passage.add("largest_load_kN", 1e-3 * r.largest_load);
        passage.add("largest_support_kN", 1e-3 * r.largest_support);
        passage.show({"settlement_mm", "deflection_mm", "largest_load_kN"});
        summary.add_part(folder_of(number), passage);
    }
    const auto& sensors = world.resource<BoxBodies>().sensors;
    const std::vector<Recording> exact = recordings_of(world, &InertialRecorder::exact);
    const double band = load_band(t.train_speed(), t.rails(world));
    summary.add("vibration_follows_load_up_to_Hz", band);
    for (std::size_t k = 0; k < sensors.size(); ++k) {
        add_sensor_levels(summary, "", sensors[k].name, recordings[k], band);
        summary.show({fmt::format("vertical_rms_{}_m_per_s2", sensors[k].name)});
        add_sensor_levels(summary, "exact_", sensors[k].name, exact[k], band);
        summary.add(fmt::format("height_{}_m", sensors[k].name),
                    world.column<Bodies, Position>()[row_of_body(world, sensors[k].body)].z());
    }
    summary.add("time_step_s", world.resource<Clock>().dt);
    summary.add("stable_step_s", last.stable_step());
    add_quantities(summary, last.quantities());
}

void check_options(const TrackPassage& t, const Common&) {
    say_how_read(grading_named(t.box.grading));
    say_how_read(train_named(t.train));
    if (t.first_train != "none") say_how_read(train_named(t.first_train, "--first-train"));
}

void run(const TrackPassage& t, const Common& common) {
    const Train train = train_named(t.train);
    Simulation simulation = make_box_simulation(t.box, common);
    const World& world = simulation.world();
    BoxTestRun test(simulation, t.box, common.seed);
    SeriesOf<PassageSample> samples("passages");
    LastQuantities last(simulation);
    Run run(simulation, common, "track_passage");
    run.keep(samples);
    run.keep(last);
    // the finished bed serves any train, and any state if it is not mixed with fines
    std::vector<std::string_view> after_bed = settings_of_state(t.box, common);
    after_bed.insert(after_bed.end(),
                     {"passages", "train", "gap_m", "sensor_density_kg_per_m3", "sensor_friction"});
    std::vector<std::string_view> of_first_train{"speed_m_per_s", "restitution", "step_fraction"};
    if (t.first_train == "none")
        after_bed.insert(after_bed.end(), of_first_train.begin(), of_first_train.end());
    const BoxBed bed(simulation, common, after_bed, of_first_train);
    bed.begin(run, simulation, t.box, {"passages"});
    FrameWriter frames(run.file("track_passage", ".vtkhdf"), common.settings,
                       t.box.written.extras());
    const PassageActions actions{
        .frame = [&] { frames.add(world); },
        .completed = [&](unsigned number) { write_passage(world, t, number, common.out); },
        .bed_saved = [&bed] { bed.keep(); }};
    std::vector<Phase> phases = test.bed_of_track();
    for (Phase& phase : passage_phases(test, run, t, train, samples, actions))
        phases.push_back(std::move(phase));
    run.go(phases);
    const std::vector<Recording> recordings = recordings_of(world);
    draw(samples, world, recordings, common);
    samples.write_csv(common.out / "samples.csv");
    samples.write_track(frames.file());
    frames.file().close();
    Report summary;
    summarise(summary, t, train, samples, world, recordings, last);
    run.add_to_summary(summary);
    summary.show({"rocks", "bed_porosity", "axles", "train_speed_m_per_s", "passage_duration_s",
                  "unbalanced_ratio", "wall_time_s"});
    report_results(common, summary);
}

std::string explain(const TrackPassage& t, const Common& common) {
    return explain_box(t.box, common);
}

} // namespace

int main(int argc, char** argv) {
    return run_scenario<TrackPassage>(
        argc, argv,
        {.name = "track_passage",
         .description = "Trains pass over a tie on clean or fouled ballast with sensor rocks.",
         .divides = true,
         .makes_beds = true},
        check_options, run, explain);
}
