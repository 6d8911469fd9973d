// Forecast of how far ballast is deflected under the next train. An ensemble of sites, each with a
// packing and parameters of its own, is passed by a train whose passage was recorded on the real
// site by sensor rocks. From there the next train passes over the members, and what the recordings
// say of the site turns their movements into the probability that a threshold will be exceeded
// there.
#include "engine/errors.hpp"
#include "engine/interrupt.hpp"
#include "engine/report.hpp"
#include "engine/stopwatch.hpp"
#include "scenarios/ballast_box/start_box.hpp"
#include "scenarios/forecast/forecast_results.hpp"
#include "scenarios/forecast/site_ensemble.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

namespace {

using namespace bris;

struct Forecast {
    SiteDesign design{
        .box = {.steps_per_cycle = 8000, .width = 0.25, .rock_scale = 1.6, .porosity = 0.41}};
    std::string train = "inspection", next_train = "freight", sensor = "rail_seat_5cm";
    std::filesystem::path recordings = {}, ensemble = {};
    double threshold = 1e-3, speed = 20;
    RecordingErrors errors;
    std::uint64_t site_seed = 1;
    unsigned run_in = 2;

    void declare_options(auto& option) {
        option.group("Forecast");
        option("ensemble", ensemble, "",
               "Folder of results of a run that has made the ensemble. Default: it is made again.");
        option("members", design.members, "", "Number of members of the ensemble.", within(6, 200));
        option("train", train, "",
               "Train whose passage was recorded: inspection, passenger, freight (assets/trains), "
               "or the path of a CSV file with the columns position_m and axle_load_kN.");
        option("run_in", run_in, "",
               "Number of passages of that train before the recorded one, in which the new bed "
               "settles.",
               within(0, 100));
        option("next_train", next_train, "", "Train that comes next, in the same form.");
        option(
            "recordings", recordings, "",
            "Folder with the recordings of the passage, whose sensors 1 to 6 are those of "
            "--sensor in their order, or a CSV file of compliances (displacement of the rock over "
            "load of the rails on a tie) with the columns sensor, compliance_um_per_kN and "
            "deviation_um_per_kN. Default: a site is simulated that no member knows, "
            "recorded, and compared with its forecast.");
        option("speed", speed, "m/s",
               "Speed of the train in a folder of recordings, to 5 %. A recording is used only if "
               "it fits the train at such a speed better than 99 of 100 trains of shuffled axles.",
               within(5, 120));
        option("sensor", sensor, "", "Sensor rock whose deflection is judged.",
               {"rail_seat_25cm", "rail_seat_5cm", "middle_25cm", "middle_5cm", "end_25cm",
                "end_5cm"});
        option("threshold", threshold, "m", "Deflection of that rock that is judged unsafe.",
               within(1e-5, 0.05));
        option.group("Simulated site");
        option("site_seed", site_seed, "", "Seed of parameters, packing and errors of the site.",
               within(0, 1e9));
        option("recording_error", errors.relative, "",
               "Standard deviation of a recorded compliance's error, over the compliance.",
               within(0, 0.5));
        option("recording_noise", errors.noise, "m/N",
               "Standard deviation of what noise adds to a recorded compliance.", within(0, 1e-8));
        design.spread.declare_options(option);
        BallastBox& box = design.box;
        option.group("Ballast");
        option("run", box.run, "",
               "State of the ballast, as in the runs of table 1 of the report: I.2 clean, I.4 "
               "without shoulder, II.2 fouled and dry, II.3 fouled and wet, II.4 fouled, wet and "
               "without shoulder.",
               {"I.2", "I.4", "II.2", "II.3", "II.4"});
        option("width", box.width, "m", "Width of the slice along the track.", within(0.1, 0.61));
        option("rock_scale", box.rock_scale, "", "Factor on all sizes of rocks.", within(1, 4));
        box.declare_ballast_options(option);
        box.fouling.declare_options(option);
        option.group("Track");
        box.declare_track_options(option);
        option.group("Simulation");
        option("rest", box.rest, "",
               "Unbalanced force ratio at which a bed is at rest before trains pass.",
               within(1e-6, 0.1));
        option("steps_per_cycle", box.steps_per_cycle, "", "Time steps of a load cycle.",
               within(200, 1e6));
    }
};

/// Settings that do not change the members of an ensemble.
const MayDiffer of_members{"ensemble",     "members",         "next_train",
                           "recordings",   "sensor",          "threshold_m",
                           "site_seed",    "recording_error", "recording_noise_m_per_N",
                           "speed_m_per_s"};
const MayDiffer of_site{"ensemble", "members", "sensor", "threshold_m", "speed_m_per_s"};

std::vector<std::string> sensors_of(const Forecast& f, const Common& common) {
    const World world = make_box_world(f.design.box, common.seed);
    std::vector<std::string> names;
    for (const BoxSensor& s : world.resource<BoxBodies>().sensors) names.push_back(s.name);
    return names;
}

FolderOfMovements given_movements(const Forecast& f, const Train& train,
                                  const std::vector<std::string>& names) {
    if (!std::filesystem::is_directory(f.recordings))
        return {read_movements(f.recordings, names), {}};
    const RailOnTies rails = TrackSlice{f.design.box}.rails();
    FolderOfMovements given = movements_in(f.recordings, {train, f.speed, rails, dead_load}, names);
    require(!given.movements.empty(),
            fmt::format("--recordings: expected at least one recording of the train '{}' at {:g} "
                        "m/s in '{}', found none of {}: no forecast",
                        f.train, f.speed, f.recordings.string(), given.recordings.size()));
    return given;
}

/// With --resume, checkpoints of the folder are taken over into that of the results.
void take_over(const Common& common) {
    if (common.resume.empty()) return;
    if (std::filesystem::equivalent(common.resume, common.out)) return;
    for (const char* part : {"members", "site"})
        if (std::filesystem::exists(common.resume / part))
            std::filesystem::copy(common.resume / part, common.out / part,
                                  std::filesystem::copy_options::recursive |
                                      std::filesystem::copy_options::overwrite_existing);
}

std::string resumed_by(const Common& common) { return common.resume.empty() ? "" : "--resume"; }

std::vector<Site> members_of(const Forecast& f, const std::vector<Train>& trains,
                             const Common& common) {
    if (f.ensemble.empty())
        return make_members(f.design, trains, common, common.out / "members",
                            {resumed_by(common), of_members});
    return make_members(f.design, trains, common, f.ensemble / "members",
                        {"--ensemble", of_members});
}

/// The part that has to end before the next train comes.
void forecast(ForecastResults& results, const std::vector<Site>& members,
              const std::vector<Train>& trains, const std::vector<RecordedMovement>& recorded,
              const Forecast& f, const Common& common) {
    const auto next = pass_members(members, trains, common, of_members);
    for (std::size_t k = 0; k < members.size(); ++k)
        results.members.push_back({members[k].passages.back(), next[k]});
    results.forecast = forecast_passage(results.members, recorded);
    results.left_out = forecasts_of_members(results.members, results.rock, f.errors.relative);
}

void run_forecast(const Forecast& f, const Common& common) {
    const std::vector<std::string> names = sensors_of(f, common);
    const std::vector<Train> before(f.run_in + 1, train_named(f.train));
    std::vector<Train> trains = before;
    trains.push_back(train_named(f.next_train, "--next-train"));
    const bool simulated = f.recordings.empty();
    FolderOfMovements given;
    if (!simulated) given = given_movements(f, before.back(), names);
    for (const JudgedRecording& r : given.recordings)
        report_news(common, sentence_of(r, names[r.sensor]));
    take_over(common);
    ForecastResults results{
        .names = names,
        .rock = static_cast<std::size_t>(std::ranges::find(names, f.sensor) - names.begin()),
        .threshold = f.threshold,
        .recordings = given.recordings};
    const RailOnTies rails = TrackSlice{f.design.box}.rails();
    results.last_turns = load_turns(trains.front(), rails, dead_load);
    results.next_turns = load_turns(trains.back(), rails, dead_load);

    const std::vector<Site> members = members_of(f, before, common);
    unsigned redrawn = 0;
    for (const Site& member : members) redrawn += member.redrawn;
    Site site;
    if (simulated) {
        site = make_site(f.design, f.site_seed, before, common, {resumed_by(common), of_site});
        given.movements = recorded(site.passages.back(), f.errors, f.site_seed);
        write_movements(common.out / "movements.csv", given.movements, names);
    }
    const Instant began = this_instant();
    forecast(results, members, trains, given.movements, f, common);
    const double wall_time = seconds_since(began);
    report_news(common, sentence_of(results));
    if (simulated)
        results.found =
            make_site(f.design, f.site_seed, trains, common, {"--resume", of_site}).passages.back();
    write_probabilities(common.out / "probabilities.csv", results);
    draw_forecast(common.out / "forecast.png", results);
    Report summary;
    add_forecast(summary, results);
    summary.add("packings_redrawn", redrawn);
    summary.add("forecast_wall_time_s", wall_time);
    for (const int headway : {10, 30, 60})
        summary.add(fmt::format("in_time_for_headway_of_{}_min", headway),
                    wall_time < 60 * headway);
    summary.show({"forecast_wall_time_s"});
    for (const JudgedRecording& r : given.recordings)
        summary.show_sentence(sentence_of(r, names[r.sensor]));
    summary.show_sentence(sentence_of(results));
    report_results(common, summary);
}

void check_options(const Forecast& f, const Common& common) {
    const std::vector<std::string> names = sensors_of(f, common);
    const Train train = train_named(f.train);
    say_how_read(grading_named(f.design.box.grading));
    say_how_read(train);
    say_how_read(train_named(f.next_train, "--next-train"));
    if (!f.recordings.empty()) (void)given_movements(f, train, names);
    require(
        common.resume.empty() || std::filesystem::is_directory(common.resume),
        fmt::format("--resume: expected a folder of results, found '{}'", common.resume.string()));
    require(f.ensemble.empty() || std::filesystem::is_directory(f.ensemble / "members"),
            fmt::format("--ensemble: expected the folder of an ensemble, with a folder members, "
                        "found '{}'",
                        f.ensemble.string()));
}

void run(const Forecast& f, const Common& common) {
    const SavesWhenInterrupted saves("continue with --resume " + common.out.string());
    run_forecast(f, common);
}

std::string explain(const Forecast& f, const Common& common) {
    return explain_box(f.design.box, common);
}

} // namespace

int main(int argc, char** argv) {
    return run_scenario<Forecast>(argc, argv,
                                  {"forecast", "Forecasts from recordings of one train the "
                                               "deflection of the ballast under the next one."},
                                  check_options, run, explain);
}
