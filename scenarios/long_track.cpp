// A train passes over a track of any length: bays of ballast side by side in one world, copies of a
// bay that was made and seated by itself, below a rail that joins their ties. The world is divided
// among ranks, each of which makes and computes a part of it only.
#include "scenarios/track/long_track.hpp"

#include "components/fouling.hpp"
#include "components/kinds.hpp"
#include "components/over_ranks.hpp"
#include "engine/errors.hpp"
#include "engine/io/csv.hpp"
#include "engine/io/plot.hpp"
#include "engine/io/series.hpp"
#include "engine/message.hpp"
#include "engine/ranks.hpp"
#include "engine/report.hpp"
#include "engine/run.hpp"
#include "scenarios/ballast_box/load_band.hpp"
#include "scenarios/monitoring/sensor_levels.hpp"
#include "scenarios/monitoring/tie_fit.hpp"
#include "scenarios/specimens/check_scene.hpp"
#include "scenarios/specimens/last_quantities.hpp"
#include "scenarios/specimens/recorded_motion.hpp"
#include "scenarios/track/tie_records.hpp"
#include "systems/fields/fouling.hpp"
#include "systems/output/frames.hpp"
#include "systems/slabs/slabs.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

namespace {

using namespace bris;

/// What the track does at a time; loads and supports are those of half ties.
struct TrackSample {
    double time, passage, deflection, support, largest_deflection, unbalanced_ratio, kinetic_energy,
        stable_step;
    static constexpr auto columns() {
        using S = TrackSample;
        return std::array{Sampled{&S::time, "time", "s"},
                          Sampled{&S::passage, "passage", ""},
                          Sampled{&S::deflection, "deflection_of_middle_tie", "m"},
                          Sampled{&S::support, "support_of_middle_tie", "N"},
                          Sampled{&S::largest_deflection, "largest_deflection", "m"},
                          Sampled{&S::unbalanced_ratio, "unbalanced_ratio", ""},
                          Sampled{&S::kinetic_energy, "kinetic_energy", "J"},
                          Sampled{&S::stable_step, "stable_step", "s"}};
    }
};

/// s: an axle moves a quarter of the distance of two ties at most.
double sample_interval(double speed) { return std::min(5e-3, tie_spacing / (4 * speed)); }

/// What the sensor on the tie alone says of its deflection and void, by the train that is known.
void add_tie_fit(Report& summary, const LongTrack& t, const Recording& of_tie) {
    const PassingTrain passing{train_named(t.train), t.speed, t.rails(), dead_load};
    const TieFit fit = fit_tie(of_tie, passing);
    if (!fit.impossible_because.empty()) {
        if (Ranks::is_first())
            say("no deflection from the sensor on the tie: " + fit.impossible_because);
        return;
    }
    const auto add = [&](const char* name, const Estimate& estimate) {
        summary.add(fmt::format("{}_by_sensor_mm", name), 1e3 * estimate.value);
        summary.add(fmt::format("{}_by_sensor_low_mm", name), 1e3 * estimate.low);
        summary.add(fmt::format("{}_by_sensor_high_mm", name), 1e3 * estimate.high);
    };
    add("deflection_of_middle_tie", fit.deflection);
    add("void_of_middle_tie", fit.gap);
    summary.add("middle_tie_is_carried_by_sensor", fit.is_carried);
    summary.add("share_left_by_sensor_fit", fit.left);
}

/// What the sensor rocks of the middle bay and the sensor on its tie recorded in the last passage.
void add_recordings(Report& summary, const LongTrack& t, const World& world, const Common& common) {
    const std::vector<Recording> recordings = recordings_of(world),
                                 exact = recordings_of(world, &InertialRecorder::exact);
    const auto& sensors = world.resource<BoxBodies>().sensors;
    const double band = load_band(t.speed, t.rails());
    summary.add("vibration_follows_load_up_to_Hz", band);
    std::string impossible; // why the levels of a sensor are missing
    for (std::size_t k = 0; k < recordings.size(); ++k) {
        const std::string name = k < sensors.size() ? sensors[k].name : "tie";
        const auto add_levels = [&](const char* prefix, const Recording& recording) {
            const std::string why =
                vibration_of(recording, VibrationQuantity::vertical, 0.1).impossible_because;
            if (why.empty())
                add_sensor_levels(summary, prefix, name, recording, band);
            else
                impossible = fmt::format("{}{}: {}", prefix, name, why);
        };
        add_levels("", recordings[k]);
        add_levels("exact_", exact[k]);
        write_sensor_info(common.out / fmt::format("rock_{:02}.txt", k + 1), recordings[k].info);
    }
    if (!impossible.empty() && Ranks::is_first()) say("no level of a sensor: " + impossible);
    add_tie_fit(summary, t, recordings.back());
    write_recordings(common.out / "recordings.csv", recordings,
                     {"Recorded by the sensor rocks of the middle bay of a track, and last by the "
                      "sensor on its tie, in the last passage; the pose in rock_NN.txt is that at "
                      "the end of the run"});
}

/// Means over the rocks.
void add_fouling_around(Report& summary, const World& world) {
    if (!world.has_resource<Fouling>()) return;
    const auto around = world.column<Bodies, FoulingAround>();
    const auto spheres = world.column<Bodies, SpheresOf>();
    const OverRanks ranks(world);
    ExactSum contaminant, saturation, rocks;
    for (Row b = 0; b < around.size(); ++b) {
        if (spheres[b].count == 0 || !ranks.counts(b)) continue;
        contaminant.add(around[b].contaminant);
        saturation.add(around[b].saturation);
        rocks.add(1);
    }
    ranks.add({&contaminant, &saturation, &rocks});
    const auto mean_percent = [&](const ExactSum& sum) {
        return 100 * sum.value() / rocks.value();
    };
    summary.add("void_contaminant_index_around_rocks_percent", mean_percent(contaminant));
    summary.add("saturation_around_rocks_percent", mean_percent(saturation));
}

/// The rocks, ties and plates of some bays around the middle; sensor rocks in red.
View view_of_middle(const World& world, unsigned bays) {
    constexpr double half = 3 * tie_spacing; // m
    const double middle = 0.5 * tie_spacing * bays;
    const auto is_near = [&](const Vec3& x) { return std::abs(x.x() - middle) < half + 1e-3; };
    const auto& sensors = world.resource<BoxBodies>().sensors;
    const auto id = world.column<Bodies, BodyId>();
    const auto position = world.column<Bodies, Position>();
    View view = view_of_grains(world, [&](Row b) -> std::optional<Colour> {
        if (!is_near(position[b])) return std::nullopt;
        const bool senses = std::ranges::count(sensors, id[b], &BoxSensor::body) > 0;
        return senses ? Colour{200, 40, 40} : rock_colour(id[b]);
    });
    std::erase_if(view.quads,
                  [&](const auto& quad) { return !std::ranges::all_of(quad, is_near); });
    view.caption = fmt::format("The middle of a track of {} bays. Red: sensor rocks.", bays);
    return view;
}

void draw(const LongTrack& t, const SeriesOf<TrackSample>& samples, const TieRecords& ties,
          const Common& common) {
    Curve deflection{.label = "largest deflection"}, settlement{.label = "settlement"},
        support{.label = "largest support"};
    for (std::size_t k = 0; k < ties.all().size(); ++k) {
        const double x = tie_spacing * (static_cast<double>(k) + 0.5);
        for (Curve* curve : {&deflection, &settlement, &support}) curve->x.push_back(x);
        deflection.y.push_back(1e3 * ties.all()[k].deflection);
        settlement.y.push_back(1e3 * ties.all()[k].now);
        support.y.push_back(1e-3 * ties.all()[k].support);
    }
    const std::string place = "place along the track (m)";
    std::vector<Plot> plots{samples.plot(&TrackSample::deflection, "Middle tie"),
                            samples.plot(&TrackSample::support, "Middle tie")};
    if (t.bays > 1)
        plots.insert(plots.begin(), {{.title = fmt::format("Ties of {} bays under the train '{}'",
                                                           t.bays, t.train),
                                      .x_label = place,
                                      .y_label = "downwards (mm)",
                                      .curves = {deflection, settlement}},
                                     {.title = "Support of the half ties by the ballast",
                                      .x_label = place,
                                      .y_label = "force (kN)",
                                      .curves = {support}}});
    draw_plots(common.out / "long_track.png", plots, 2);
}

void write_ties(const std::filesystem::path& csv, const TieRecords& ties) {
    std::vector<std::vector<double>> rows;
    for (const TieRecord& tie : ties.all())
        rows.push_back({static_cast<double>(rows.size() + 1),
                        tie_spacing * (static_cast<double>(rows.size()) + 0.5), tie.deflection,
                        tie.now, tie.load, tie.support});
    write_csv(csv,
              {"tie", "x_m", "largest_deflection_m", "settlement_m", "largest_load_of_rail_N",
               "largest_support_N"},
              rows, {"loads and supports: of half ties"});
}

Report summary_of(const LongTrack& t, Simulation& simulation, const TieRecords& ties,
                  LastQuantities& last, const Run& run, const Common& common) {
    const World& world = simulation.observed();
    const std::size_t rocks = world.resource<BoxBodies>().number_of_rocks();
    Report summary;
    summary.add("bays", t.bays);
    summary.add("rocks", rocks);
    summary.add("track_length_m", t.bays * tie_spacing);
    summary.add("time_step_s", world.resource<Clock>().dt);
    summary.add("stable_step_s", last.stable_step());
    const StepCount count = run.count();
    summary.add("rock_steps_per_s", static_cast<double>(count.steps * rocks) / count.wall_time);
    if (Ranks::size() > 1) summary.add("share_of_ghosts", share_of_ghosts(world));
    summary.add("rebuilds", world.resource<ListState>().rebuilds);
    summary.add("prunes", world.resource<ListState>().prunes);
    for (std::size_t k = 0; k < ties.passages().size(); ++k) {
        const TieRecord& largest = ties.passages()[k];
        Report passage;
        passage.add("largest_deflection_mm", 1e3 * largest.deflection);
        passage.add("largest_settlement_mm", 1e3 * largest.now);
        passage.add("largest_load_of_rail_kN", 1e-3 * largest.load);
        passage.add("largest_support_kN", 1e-3 * largest.support);
        passage.show({"largest_deflection_mm", "largest_settlement_mm", "largest_support_kN"});
        summary.add_part(fmt::format("passage_{:02}", k + 1), passage);
    }
    summary.add("deflection_of_middle_tie_mm", 1e3 * ties.middle().deflection);
    add_fouling_around(summary, world);
    add_recordings(summary, t, world, common);
    add_quantities(summary, last.quantities());
    run.add_to_summary(summary);
    summary.show({"bays", "rocks", "track_length_m", "unbalanced_ratio", "steps", "wall_time_s"});
    return summary;
}

void check_options(const LongTrack& t, const Common&) {
    say_how_read(grading_named(t.box.grading));
    say_how_read(train_named(t.train));
    if (t.settles_bay()) say_how_read(train_named(t.first_train, "--first-train"));
    const RailOnTies rails = t.rails();
    require(rails.tie_support < rails.pad,
            fmt::format("--tie-support: expected less than the {:g} N/m of --pad-stiffness, of "
                        "which it is a part, found {:g} N/m",
                        rails.pad, rails.tie_support));
}

/// What is left of a simulation when its memory is free.
struct Outcome {
    SeriesOf<TrackSample> samples{"track"};
    TieRecords ties = {};
    View view = {};
    Report summary = {};
};

/// The passages, of so many steps each, and the hanging of the ties before the last one.
std::vector<Phase> phases_of(const LongTrack& t, const Run& run, std::uint64_t steps, double dt,
                             LastQuantities& last, TieRecords& ties,
                             SeriesOf<TrackSample>& samples) {
    const auto sample = [&](Simulation& s, std::uint64_t) {
        s.observe();
        const World& world = s.observed();
        check_stable_step(world, last.stable_step());
        ties.note(world);
        samples.add({.time = world.resource<Clock>().time() - ties.began(),
                     .passage = static_cast<double>(ties.passages().size()),
                     .deflection = ties.middle().now,
                     .support = ties.middle().support_now,
                     .largest_deflection = ties.passages().back().deflection,
                     .unbalanced_ratio = last.quantities().unbalanced_ratio,
                     .kinetic_energy = last.quantities().kinetic_energy,
                     .stable_step = last.stable_step()});
        return true;
    };
    const auto wait = [&](Simulation& s, std::uint64_t) {
        s.observe();
        check_stable_step(s.observed(), last.stable_step());
        return true;
    };
    const auto every = std::max<std::uint64_t>(
        1, static_cast<std::uint64_t>(std::llround(sample_interval(t.speed) / dt)));
    std::vector<Phase> phases;
    for (unsigned number = 1; number <= t.passages; ++number) {
        if (number == t.passages && t.gap > 0)
            phases.push_back(run.timed({.name = "hang the ties up",
                                        .steps = steps_of(hanging_time, dt, "gap"),
                                        .sample_every = every,
                                        .sample = wait,
                                        .begin = [&](Simulation& s) { begin_hanging(s, t); },
                                        .looks = false}));
        phases.push_back(run.timed({.name = fmt::format("passage {}", number),
                                    .steps = steps,
                                    .sample_every = every,
                                    .sample = sample,
                                    .begin =
                                        [&](Simulation& s) {
                                            begin_passage(s, t);
                                            ties.begin(s.observed());
                                        },
                                    .looks = false}));
    }
    return phases;
}

Outcome simulate(const LongTrack& t, const Common& common) {
    Outcome found;
    const bool resumes = resumes_track(common); // before the bay's files are gone
    Simulation simulation = make_track(t, common);
    LastQuantities last(simulation);
    TieRecords& ties = found.ties;
    Run run(simulation, common, "long_track");
    run.keep(found.samples);
    run.keep(last);
    run.keep(ties);
    if (resumes)
        run.resume(common.resume, t.gap > 0
                                      ? std::vector<std::string_view>{"duration_s"}
                                      : std::vector<std::string_view>{"duration_s", "passages"});
    else
        find_step(simulation, t);
    const World& part = simulation.divide_now();
    const double dt = part.resource<Clock>().dt;
    const std::uint64_t steps = steps_of(duration_of(t, part), dt, "duration");
    const unsigned phases_of_run = t.passages + (t.gap > 0 ? 1 : 0);
    require(run.phase() < phases_of_run,
            fmt::format("--passages: expected at least the {} of the checkpoint, found {}",
                        run.phase() + 1, t.passages));
    const bool hangs_now = t.gap > 0 && run.phase() + 2 == phases_of_run;
    if (run.is_resumed() && !hangs_now) run.require_steps_left(steps, "duration");
    run.go(phases_of(t, run, steps, dt, last, ties, found.samples));
    const World& world = simulation.observed();
    found.summary = summary_of(t, simulation, ties, last, run, common);
    FrameWriter frames(common.out / "long_track.vtkhdf", common.settings);
    frames.add(world);
    frames.file().close();
    found.view = view_of_middle(world, t.bays);
    return found;
}

void run(const LongTrack& t, const Common& common) {
    Outcome found = simulate(t, common);
    gather(found.view);
    draw_picture(common.out / "middle.png", {&found.view, 1}, {.azimuth = -1.2, .elevation = 0.15});
    draw(t, found.samples, found.ties, common);
    found.samples.write_csv(common.out / "samples.csv");
    write_ties(common.out / "ties.csv", found.ties);
    report_results(common, found.summary);
}

std::string explain(const LongTrack& t, const Common& common) {
    return make_track(t, common).schedule().explain();
}

} // namespace

int main(int argc, char** argv) {
    return run_scenario<LongTrack>(
        argc, argv,
        {.name = "long_track",
         .description = "A train passes over a track of any length, on ballast below all ties.",
         .divides = true,
         .makes_beds = true},
        check_options, run, explain);
}
