// A stretch of track with a mud spot settles under its axles: gaps below the ties emerge from the
// rail over beds that settle at different rates, and change the loads of the ties.
#include "engine/ensemble.hpp"
#include "engine/errors.hpp"
#include "engine/io/csv.hpp"
#include "engine/io/plot.hpp"
#include "engine/report.hpp"
#include "engine/run.hpp"
#include "engine/scenario.hpp"
#include "engine/signal/median.hpp"
#include "scenarios/track/coupled_track.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <functional>

namespace {

using namespace bris;

struct TrackRun {
    StretchSettings stretch = {};
    SettlementLaw law = {};
    double block = 0.1, settlement = 4e-3, tamping = 0;
    unsigned tracks = 20, records = 8;
    unsigned bays = 0, cycles = 100;
    double pad_stiffness = 120e6;
    std::string mud_run = "II.3";
    BallastBox box = {.width = tie_spacing};

    void declare_options(auto& option) {
        option.group("Mud");
        option("ratio", law.ratio, "",
               "Settlement of a mud tie over that of a good one, under the same load, where no "
               "ballast is computed. Nobody knows it to better than a factor of five: try several.",
               within(0.05, 100).usually(0.5, 10));
        option("mud_ties", stretch.mud_ties, "", "Ties of mud in the middle of the stretch.",
               within(0, 41));
        declare_law(option);
        declare_track(option);
        declare_bays(option);
    }
    void declare_law(auto& option) {
        option.group("Settlement");
        option("settlement", settlement, "m",
               "Settlement of a good track without mud, with which the run ends (without --bays).",
               within(1e-5, 0.1).usually(1e-4, 0.02));
        option("tamping", tamping, "m",
               "Settlement of a good track from one tamping to the next (without --bays): all ties "
               "are lifted to one level. What that loosens is not modelled. 0: never.",
               within(0, 0.1));
        option("exponent", law.exponent, "",
               "Power of a tie's load with which its bed settles; laboratories found 1.6 to 5.",
               within(0, 10));
        option("scatter", law.scatter, "",
               "Standard deviation of the logarithm of the settlement from tie to tie.",
               within(0, 2));
        option("tracks", tracks, "",
               "Number of stretches with other random numbers, from which medians and 95 % bands "
               "follow. Bays of ballast belong to one stretch.",
               within(1, 10000));
        option("records", records, "", "Number of times at which results are written.",
               within(1, 1000));
        option("block", block, "",
               "Largest change of the level of a tie before its load is computed again, over the "
               "deflection of an even track.",
               within(1e-3, 1));
    }
    void declare_track(auto& option) {
        option.group("Track");
        option("ties", stretch.ties, "", "Ties of the stretch; beyond it all are even and good.",
               within(5, 400));
        option("axle_load", stretch.axle_load, "N", "Load of an axle, of both wheels.",
               within(1e3, 5e5).usually(1e4, 4e5));
        option("tie_support", stretch.tie_support, "N/m",
               "Stiffness of pad, bed and subgrade of a tie in series; with --bays until the first "
               "axle has measured it.",
               within(1e5, 1e10).usually(1e6, 1e9));
        option("rail_bending", stretch.rail_bending, "N m2",
               "Bending stiffness E I of both rails together.", within(1e4, 1e9));
        option("weight", stretch.weight, "N", "Weight of rails, fastenings and a tie, at each tie.",
               within(0, 1e5).usually(1e3, 2e4));
    }
    void declare_bays(auto& option) {
        option.group("Bays of ballast");
        option(
            "bays", bays, "",
            "Ties in the middle that lie on computed ballast, each on a bay of its own. 0: none.",
            within(0, 41));
        option("cycles", cycles, "", "Axles that pass.", within(1, 1e6));
        option("mud_run", mud_run, "",
               "Run of table 1 of the report (ballast_box --run) to which mud bays belong; the "
               "options of fouling are theirs.");
        box.declare_fines_option(option);
        option("pad_stiffness", pad_stiffness, "N/m", "Of both pads of a tie.", within(1e6, 1e10));
        option("steps_per_cycle", box.steps_per_cycle, "", "Time steps for each axle.",
               within(200, 1e6));
        option("rock_scale", box.rock_scale, "", "Factor on all sizes of rocks. 0: 1.3.",
               within(0, 4));
        box.declare_ballast_options(option);
        box.fouling.declare_options(option);
    }

    CoupledTrack coupled() const {
        BallastBox clean = box, mud = box;
        clean.fouling = BallastBox{}.fouling;
        mud.run = mud_run;
        return {stretch, law, clean, mud, bays, cycles, pad_stiffness, block};
    }
};

using History = std::vector<StretchState>; // of one stretch

/// Of one number over all stretches.
struct Band {
    double low, median, high;
};

Band band_of(const std::vector<double>& values) {
    return {quantile(values, 0.025), quantile(values, 0.5), quantile(values, 0.975)};
}

Band band_over(const std::vector<History>& all, std::size_t record,
               const std::function<double(const StretchState&)>& number) {
    std::vector<double> values;
    for (const History& history : all) values.push_back(number(history[record]));
    return band_of(values);
}

/// What is asked of a stretch.
struct Quantity {
    std::string key;
    std::function<double(const StretchState&)> of;
};

std::vector<Quantity> quantities_of(const StretchSettings& t) {
    const std::size_t middle = t.ties / 2, neighbour = (t.ties - t.mud_ties) / 2 - 1;
    const auto hanging = [t](const StretchState& s) {
        double ties = 0, hang = 0;
        for (std::size_t i = 0; i < t.ties; ++i)
            if (!t.is_mud(i)) {
                ++ties;
                hang += s.voids[i] > 0 ? 1 : 0;
            }
        return hang / ties;
    };
    std::vector<Quantity> all;
    if (t.mud_ties > 0 && t.mud_ties < t.ties) {
        all.push_back({"void_of_middle_mud_tie_mm",
                       [=](const StretchState& s) { return 1e3 * s.voids[middle]; }});
        all.push_back({"load_of_middle_mud_tie_over_even",
                       [=](const StretchState& s) { return s.loads[middle]; }});
        all.push_back({"load_of_first_good_tie_over_even",
                       [=](const StretchState& s) { return s.loads[neighbour]; }});
    }
    if (t.mud_ties < t.ties) all.push_back({"share_of_good_ties_that_hang", hanging});
    all.push_back(
        {"largest_void_mm", [](const StretchState& s) { return 1e3 * std::ranges::max(s.voids); }});
    for (const auto& [name, chord] : {std::pair{"10m", 10.0}, std::pair{"62ft", 62 * 0.3048}})
        if (chord <= t.spacing * (t.ties - 1))
            all.push_back({fmt::format("dip_over_{}_mm", name), [=](const StretchState& s) {
                               return 1e3 * dip_over_chord(s.profile, t.spacing, chord);
                           }});
    return all;
}

void write_ties(const std::filesystem::path& csv, const StretchSettings& t,
                const std::vector<History>& all) {
    std::vector<std::vector<double>> rows;
    for (std::size_t k = 0; k < all.size(); ++k)
        for (const StretchState& s : all[k])
            for (std::size_t i = 0; i < t.ties; ++i)
                rows.push_back({static_cast<double>(k + 1), s.cycles, s.settled,
                                static_cast<double>(i + 1), t.is_mud(i) ? 1.0 : 0.0,
                                s.settlements[i], s.voids[i], s.loads[i], s.profile[i]});
    write_csv(csv,
              {"stretch", "axles", "settlement_of_good_track_m", "tie", "mud", "settlement_m",
               "void_m", "load_over_even", "profile_m"},
              rows,
              {"axles: 0 where no ballast was computed; void: between tie and bed without a train; "
               "load: largest force of the bed on the "
               "tie over that of an even track;",
               "profile: of the rail below an axle at each tie, downwards"},
              6);
}

void draw(const std::filesystem::path& png, const StretchSettings& t,
          const std::vector<History>& all) {
    const std::size_t records = all.front().size();
    Plot voids{.title = "Void below the ties, median of stretches",
               .x_label = "place along the track (m)",
               .y_label = "void (mm)"},
        loads{.title = "Load of the ties over that of an even track",
              .x_label = "place along the track (m)",
              .y_label = "load over even (-)"},
        history{.title = "As the track settles, medians",
                .x_label = "settlement of a good track (mm)",
                .y_label = "mm, or over even"};
    for (const std::size_t record : {records / 4, records / 2, records - 1}) {
        const std::string label =
            fmt::format("good track settled by {:.3g} mm", 1e3 * all.front()[record].settled);
        Curve of_voids{.label = label}, of_loads{.label = label};
        for (std::size_t i = 0; i < t.ties; ++i) {
            const double x = t.spacing * (static_cast<double>(i) - 0.5 * (t.ties - 1));
            of_voids.x.push_back(x);
            of_loads.x.push_back(x);
            of_voids.y.push_back(band_over(all, record, [i](const StretchState& s) {
                                     return 1e3 * s.voids[i];
                                 }).median);
            of_loads.y.push_back(
                band_over(all, record, [i](const StretchState& s) { return s.loads[i]; }).median);
        }
        voids.curves.push_back(std::move(of_voids));
        loads.curves.push_back(std::move(of_loads));
    }
    for (const Quantity& q : quantities_of(t)) {
        Curve curve{.label = q.key};
        std::ranges::replace(curve.label, '_', ' ');
        for (std::size_t record = 0; record < records; ++record) {
            curve.x.push_back(1e3 * all.front()[record].settled);
            curve.y.push_back(band_over(all, record, q.of).median);
        }
        history.curves.push_back(std::move(curve));
    }
    draw_plots(png, {voids, loads, history}, 3);
}

/// Stretches that settle by the law alone, at these settlements of a good track.
std::vector<History> settle_tracks(const TrackRun& given, const SettlementLaw& law,
                                   const std::vector<double>& settlements, const Common& common) {
    std::vector<History> all(given.tracks);
    Progress progress = make_progress(common);
    std::atomic<std::size_t> done = 0;
    run_ensemble(all.size(), common.threads, [&](std::size_t k) {
        all[k] = settle_track({given.stretch, law, given.block, given.tamping}, settlements,
                              1000 * common.seed + k);
        const std::size_t now = ++done;
        progress.report(0, {"settle", static_cast<double>(now) / static_cast<double>(all.size()),
                            fmt::format("stretch {} of {}", now, all.size())});
    });
    progress.report(0, {});
    return all;
}

/// The last record of all stretches: medians, and bands where there are several.
void add_last(Report& summary, const StretchSettings& t, const std::vector<History>& all,
              const std::string& when = "") {
    for (const Quantity& q : quantities_of(t)) {
        const Band band = band_over(all, all.front().size() - 1, q.of);
        const std::string unit = q.key.ends_with("_mm") ? "_mm" : "";
        const std::string name = q.key.substr(0, q.key.size() - unit.size()) + when;
        summary.add(name + unit, band.median);
        if (all.size() > 1) {
            summary.add(name + "_low" + unit, band.low);
            summary.add(name + "_high" + unit, band.high);
        }
        summary.show({name + unit});
    }
}

void write_bays(const std::filesystem::path& csv, const StretchSettings& t,
                const CoupledHistory& history) {
    std::vector<std::vector<double>> rows;
    for (const BayBlock& b : history.blocks)
        rows.push_back({static_cast<double>(b.tie + 1), t.is_mud(b.tie) ? 1.0 : 0.0, b.cycles,
                        b.load, b.settlement, b.stiffness});
    write_csv(csv, {"tie", "mud", "axles", "load_N", "settlement_m", "stiffness_N_per_m"}, rows,
              {"load: largest force of the bed on the tie; stiffness: of bed and subgrade under a "
               "whole tie, as the last axle left it"},
              6);
}

/// Ten times the axles, by the law, with the ratio that the bays have shown. Nothing of a track
/// that has hardly begun to settle.
void add_extrapolation(Report& summary, const TrackRun& given, const CoupledHistory& history,
                       double ratio, const Common& common) {
    constexpr double fewest = 10; // axles
    const StretchState &last = history.states.back(),
                       &half = history.states[history.states.size() / 2];
    const double power =
        std::log(last.settled / half.settled) / std::log(last.cycles / half.cycles);
    if (last.cycles < fewest || !(ratio > 0) || !(power > 0) || !std::isfinite(power)) return;
    SettlementLaw law = given.law;
    law.ratio = ratio;
    const double settled = last.settled * std::pow(10, power);
    summary.add("settlement_of_good_track_after_ten_times_the_axles_mm", 1e3 * settled);
    add_last(summary, given.stretch, settle_tracks(given, law, {settled}, common),
             "_after_ten_times_the_axles");
    summary.show_sentence(fmt::format(
        "What comes after ten times the axles follows from the law with the ratio of these bays, "
        "and its bands from {} stretches with scatter.",
        given.tracks));
}

void run_bays(const TrackRun& given, const Common& common) {
    const CoupledTrack track = given.coupled();
    const CoupledHistory history = couple_bays(track, common, {"cycles", "tracks"});
    const std::vector<History> all{history.states};
    const double ratio = ratio_of_bays(track, history);
    Report summary;
    summary.add("axles", given.cycles);
    summary.add("settlement_of_good_track_mm", 1e3 * history.states.back().settled);
    summary.show({"settlement_of_good_track_mm"});
    if (given.stretch.mud_ties > 0) {
        summary.add("ratio_of_mud_over_good_bays", ratio);
        summary.show({"ratio_of_mud_over_good_bays"});
    }
    add_last(summary, given.stretch, all);
    add_extrapolation(summary, given, history, ratio, common);
    summary.show_sentence(fmt::format(
        "One stretch with {} bays of ballast, of which {} are mud: other packings differ.",
        given.bays, given.stretch.mud_ties));
    write_ties(common.out / "ties.csv", given.stretch, all);
    write_bays(common.out / "bays.csv", given.stretch, history);
    draw(common.out / "track.png", given.stretch, all);
    report_results(common, summary);
}

void run(const TrackRun& given, const Common& common) {
    if (given.bays > 0) return run_bays(given, common);
    std::vector<double> settlements;
    for (unsigned k = 1; k <= given.records; ++k)
        settlements.push_back(given.settlement * k / given.records);
    const std::vector<History> all = settle_tracks(given, given.law, settlements, common);
    Report summary;
    summary.add("settlement_of_good_track_mm", 1e3 * given.settlement);
    summary.show({"settlement_of_good_track_mm"});
    add_last(summary, given.stretch, all);
    summary.show_sentence(fmt::format(
        "Bands hold 95 % of {} stretches. No ballast was computed: the ratio of settlements, {:g}, "
        "is assumed, and nothing is said of the time that the track needs.",
        given.tracks, given.law.ratio));
    write_ties(common.out / "ties.csv", given.stretch, all);
    draw(common.out / "track.png", given.stretch, all);
    report_results(common, summary);
}

void check(const TrackRun& given, const Common& common) {
    const StretchSettings& t = given.stretch;
    require(
        t.mud_ties <= t.ties,
        fmt::format("--mud-ties: expected at most the {} of --ties, found {}", t.ties, t.mud_ties));
    require(given.bays == 0 || given.tamping == 0,
            "--tamping: expected none with --bays, whose beds it would loosen");
    if (given.bays > 0) return check_coupled(given.coupled());
    require(common.resume.empty(),
            "--resume: expected none without --bays, since a stretch then settles in seconds");
}

} // namespace

int main(int argc, char** argv) {
    return run_scenario<TrackRun>(
        argc, argv,
        {.name = "track",
         .description = "A stretch of track with a mud spot settles: gaps and loads of its ties.",
         .cannot_explain = "its worlds are those of the bays: see ballast_box --explain",
         .makes_beds = true},
        check, run, [](const TrackRun&, const Common&) { return std::string(); });
}
