// A train passes over a track of any length: bays of ballast side by side in one world, copies of a
// bay that was made and seated by itself, below a rail that joins their ties. The world is divided
// among ranks, each of which makes and computes a part of it only.
#include "components/kinds.hpp"
#include "components/over_ranks.hpp"
#include "components/slab.hpp"
#include "engine/errors.hpp"
#include "engine/io/csv.hpp"
#include "engine/io/plot.hpp"
#include "engine/io/series.hpp"
#include "engine/memory.hpp"
#include "engine/ordering.hpp"
#include "engine/report.hpp"
#include "engine/run.hpp"
#include "scenarios/ballast_box/passages.hpp"
#include "scenarios/ballast_box/start_box.hpp"
#include "scenarios/monitoring/vibration.hpp"
#include "scenarios/specimens/check_scene.hpp"
#include "scenarios/specimens/facet_bodies.hpp"
#include "scenarios/specimens/last_quantities.hpp"
#include "scenarios/specimens/memory_estimate.hpp"
#include "scenarios/specimens/recorded_motion.hpp"
#include "scenarios/specimens/scene.hpp"
#include "scenarios/specimens/start.hpp"
#include "scenarios/track/lay_bays.hpp"
#include "scenarios/track/rail_over_bays.hpp"
#include "scenarios/track/tie_records.hpp"
#include "systems/contact/stable_step.hpp"
#include "systems/output/frames.hpp"
#include "systems/slabs/slabs.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace {

using namespace bris;

struct LongTrack {
    BallastBox box = {.model = "bay", .tie_support = 0, .porosity = 0.42};
    unsigned bays = 3;
    std::string train = "passenger";
    double speed = 31.3, duration = 0, pad_stiffness = 120e6;

    void declare_options(auto& option) {
        option.group("Track");
        option("bays", bays, "",
               "Bays of ballast, each with a tie and 0.61 m of track: copies of one bay, every "
               "second one its mirror image.",
               within(1, 20000).usually(1, 2000));
        option("pad_stiffness", pad_stiffness, "N/m",
               "Stiffness of the pads between the rails and a tie, those of both rails together.",
               within(1e6, 1e10).usually(5e7, 5e8));
        box.declare_track_options(option);
        option.group("Train");
        option("train", train, "",
               "Train: passenger, freight, inspection, locomotive (assets/trains), or the path of "
               "a CSV file with the columns position_m and axle_load_kN.");
        option("speed", speed, "m/s", "Speed of the train.", within(0.1, 120));
        option("duration", duration, "s",
               "Simulated time from the first axle on the rail on, which begins 20 ties before the "
               "ballast. 0: until the last axle has left it.",
               within(0, 1e4));
        option.group("Ballast");
        option("rock_scale", box.rock_scale, "", "Factor on all sizes of rocks. 0: 1.7.",
               within(0, 4));
        box.declare_ballast_options(option);
        option.group("Simulation");
        box.declare_simulation_options(option);
    }

    /// Of the ties on springs beyond the ballast.
    RailOnTies rails() const {
        constexpr double usual_bed = 80e6; // N/m, of clean beds of this model
        return {.bending = box.rail_bending,
                .tie_support =
                    box.tie_support > 0 ? box.tie_support : in_series(pad_stiffness, usual_bed),
                .spacing = tie_spacing,
                .tie_weight = weight_of_tie,
                .pad = pad_stiffness};
    }
};

/// What the track does at a time; loads and supports are those of half ties.
struct TrackSample {
    double time, deflection, support, largest_deflection, unbalanced_ratio, kinetic_energy,
        stable_step;
    static constexpr auto columns() {
        using S = TrackSample;
        return std::array{Sampled{&S::time, "time", "s"},
                          Sampled{&S::deflection, "deflection_of_middle_tie", "m"},
                          Sampled{&S::support, "support_of_middle_tie", "N"},
                          Sampled{&S::largest_deflection, "largest_deflection", "m"},
                          Sampled{&S::unbalanced_ratio, "unbalanced_ratio", ""},
                          Sampled{&S::kinetic_energy, "kinetic_energy", "J"},
                          Sampled{&S::stable_step, "stable_step", "s"}};
    }
};

constexpr double sample_interval = 5e-3; // s
constexpr auto bay_name = "bay";

/// Whether a run was interrupted before its bay was made.
bool ends_in_bay(const std::filesystem::path& resume) {
    const auto file = fmt::format("{}.ckpt.h5", bay_name);
    return std::filesystem::is_directory(resume) ? std::filesystem::exists(resume / file)
                                                 : resume.filename() == file;
}
bool resumes_track(const Common& common) {
    return !common.resume.empty() && !ends_in_bay(common.resume);
}

/// In the folder of results, from which the bay's files are removed once it is made.
void make_bay(Simulation& simulation, const LongTrack& t, const Common& common) {
    BoxTestRun test(simulation, t.box, common.seed);
    const std::vector<std::string_view> after_bed{"bays",
                                                  "train",
                                                  "speed_m_per_s",
                                                  "duration_s",
                                                  "pad_stiffness_N_per_m",
                                                  "restitution",
                                                  "step_fraction",
                                                  "rail_bending_N_m2",
                                                  "tie_support_N_per_m"};
    Run run(simulation, common, bay_name);
    const BoxBed bed(simulation, common, after_bed);
    bed.begin(run, simulation, t.box, after_bed);
    std::vector<Phase> phases = test.making_of_bed();
    phases.push_back(test.seat());
    phases.push_back(save_bed(run, [&bed] { bed.keep(); }));
    run.go(phases);
    if (!Ranks::is_first()) return;
    for (const char* file : {"bed.ckpt.h5", "bay.ckpt.h5"}) // whoever wants them asks the store
        std::filesystem::remove(common.out / file);
}

/// Each rank makes the bays of its part and one more on either side.
OwnBays own_bays(unsigned bays) {
    const unsigned ranks = Ranks::size(), rank = Ranks::rank();
    const unsigned first = bays * rank / ranks, last = bays * (rank + 1) / ranks;
    return {rank > 0 ? first - 1 : 0, rank + 1 < ranks ? last + 1 : bays};
}

SlabPlan plan_of(const World& world, unsigned bays) {
    constexpr double infinity = std::numeric_limits<double>::infinity();
    const Limits& limits = world.resource<Limits>();
    SlabPlan plan{.axis = 0, .low = limits.low, .high = limits.high, .cuts = {-infinity}};
    for (unsigned rank = 1; rank < Ranks::size(); ++rank)
        plan.cuts.push_back(tie_spacing * (bays * rank / Ranks::size()));
    plan.cuts.push_back(infinity);
    return plan;
}

/// Makes the track of a bay, and divides it.
void lay_track(Simulation& simulation, const LongTrack& t) {
    World& world = simulation.world();
    const EntityId once = add_ties_on_springs(world, t.rails(), t.bays);
    lay_bays(world, t.bays, own_bays(t.bays), once);
    lay_rail(world, t.rails(), once);
    auto& limits = world.resource<Limits>();
    const double beyond = tie_spacing * static_cast<double>(t.rails().ties_on_each_side() + 1);
    limits.low.x() -= beyond;
    limits.high.x() += beyond;
    if (Ranks::size() > 1) world.add_resource(plan_of(world, t.bays));
    simulation.prepare();
    divide_among_ranks(simulation);
}

Simulation make_track(const LongTrack& t, const Common& common) {
    require(t.bays >= Ranks::size(), fmt::format("--ranks: expected at most one for each of the {} "
                                                 "bays, found {}",
                                                 t.bays, Ranks::size()));
    Simulation simulation = make_undivided_box(t.box, common);
    std::size_t rocks = 0;
    for (const auto& course : simulation.world().resource<BoxBodies>().rocks)
        rocks += course.size();
    const double all = static_cast<double>(rocks) * t.bays;
    require_memory("bays", t.bays, bytes_of_rocks(all / Ranks::size(), 30), common.memory_limit);
    if (!resumes_track(common) && !common.explain) {
        make_bay(simulation, t, common);
    } else { // the checkpoint has the State of all bodies, and a rail lies on ties that are free
        World& world = simulation.world();
        for (const EntityId tie : world.resource<BoxBodies>().ties)
            value_of<MotionOf>(world, tie) = static_cast<std::uint32_t>(Motion::free);
    }
    lay_track(simulation, t);
    return simulation;
}

/// The train comes, once the contacts between the bays are known, from which the step follows.
void begin_passage(Simulation& simulation, const LongTrack& t) {
    simulation.divide_now();
    simulation.advance_unseen(1);
    simulation.observe();
    const double stable = stable_step(simulation.observed());
    World& world = simulation.divide_now();
    set_materials(world);
    world.resource<Clock>().change_step(t.box.step_fraction * stable);
    begin_train(world, train_named(t.train), t.speed);
    start_recording(world);
}

void add_recordings(Report& summary, const World& world, const Common& common) {
    const std::vector<Recording> recordings = recordings_of(world);
    const auto& sensors = world.resource<BoxBodies>().sensors;
    for (std::size_t k = 0; k < sensors.size(); ++k) {
        const Vibration vertical = vibration_of(recordings[k], VibrationQuantity::vertical, 0.1);
        if (vertical.impossible_because.empty())
            summary.add(fmt::format("vertical_rms_{}_m_per_s2", sensors[k].name), vertical.rms);
        if (Ranks::is_first())
            write_sensor_info(common.out / fmt::format("rock_{:02}.txt", k + 1),
                              recordings[k].info);
    }
    if (Ranks::is_first())
        write_recordings(common.out / "recordings.csv", recordings,
                         {"Recorded by the sensor rocks of the middle bay of a track; the pose in "
                          "rock_NN.txt is that at the end of the run"});
}

/// The rocks, ties and plates of some bays around the middle; sensor rocks in red.
View view_of_middle(const World& world, const BodyFrame& frame, unsigned bays) {
    constexpr double half = 3 * tie_spacing; // m
    const double middle = 0.5 * tie_spacing * bays;
    const auto& sensors = world.resource<BoxBodies>().sensors;
    const OverRanks ranks(world);
    const auto id = world.column<Bodies, BodyId>();
    const auto position = world.column<Bodies, Position>();
    const auto orientation = world.column<Bodies, Orientation>();
    const auto run = world.column<Bodies, SpheresOf>();
    const auto ball = world.column<Spheres, LocalBall>();
    View view;
    for (Row b = 0; b < id.size(); ++b) {
        if (!ranks.counts(b) || std::abs(position[b].x() - middle) > half) continue;
        const bool senses = std::ranges::count(sensors, id[b], &BoxSensor::body) > 0;
        for (Row k = run[b].first; k < run[b].first + run[b].count; ++k)
            view.balls.push_back({position[b] + orientation[b] * ball[k].centre, ball[k].radius,
                                  senses ? Colour{200, 40, 40} : rock_colour(id[b])});
    }
    const auto is_near = [&](const Vec3& corner) {
        return std::abs(corner.x() - middle) < half + 1e-3;
    };
    for (std::size_t q = 0; q < frame.quads(); ++q) {
        const std::array<Vec3, 4> quad{frame.corners[4 * q], frame.corners[4 * q + 1],
                                       frame.corners[4 * q + 2], frame.corners[4 * q + 3]};
        if (std::ranges::all_of(quad, is_near)) view.quads.push_back(quad);
    }
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
        settlement.y.push_back(1e3 * ties.all()[k].settlement);
        support.y.push_back(1e-3 * ties.all()[k].support);
    }
    const std::string place = "place along the track (m)";
    draw_plots(common.out / "long_track.png",
               {{.title = fmt::format("Ties of {} bays under the train '{}'", t.bays, t.train),
                 .x_label = place,
                 .y_label = "downwards (mm)",
                 .curves = {deflection, settlement}},
                {.title = "Support of the half ties by the ballast",
                 .x_label = place,
                 .y_label = "force (kN)",
                 .curves = {support}},
                samples.plot(&TrackSample::deflection, "Middle tie"),
                samples.plot(&TrackSample::support, "Middle tie")},
               2);
}

void write_ties(const std::filesystem::path& csv, const TieRecords& ties) {
    std::vector<std::vector<double>> rows;
    for (const TieRecord& tie : ties.all())
        rows.push_back({static_cast<double>(rows.size() + 1),
                        tie_spacing * (static_cast<double>(rows.size()) + 0.5), tie.deflection,
                        tie.settlement, tie.load, tie.support});
    write_csv(csv,
              {"tie", "x_m", "largest_deflection_m", "settlement_m", "largest_load_of_rail_N",
               "largest_support_N"},
              rows, {"loads and supports: of half ties"});
}

Report summary_of(const LongTrack& t, Simulation& simulation, const TieRecords& ties,
                  LastQuantities& last, const Run& run, const Common& common) {
    const World& world = simulation.observed();
    std::size_t rocks = 0;
    for (const auto& course : world.resource<BoxBodies>().rocks) rocks += course.size();
    const StepCount& count = simulation.count();
    Report summary;
    summary.add("bays", t.bays);
    summary.add("rocks", rocks);
    summary.add("track_length_m", t.bays * tie_spacing);
    summary.add("time_step_s", world.resource<Clock>().dt);
    summary.add("stable_step_s", last.stable_step());
    summary.add("rock_steps_per_s", static_cast<double>(count.steps * rocks) / count.wall_time);
    if (Ranks::size() > 1) summary.add("share_of_ghosts", share_of_ghosts(world));
    const TieRecord largest = ties.largest();
    summary.add("largest_deflection_mm", 1e3 * largest.deflection);
    summary.add("largest_settlement_mm", 1e3 * largest.settlement);
    summary.add("largest_load_of_rail_kN", 1e-3 * largest.load);
    summary.add("largest_support_kN", 1e-3 * largest.support);
    add_recordings(summary, world, common);
    add_quantities(summary, last.quantities());
    run.add_to_summary(summary);
    summary.show({"bays", "rocks", "track_length_m", "largest_deflection_mm",
                  "largest_settlement_mm", "largest_support_kN", "unbalanced_ratio", "steps",
                  "wall_time_s"});
    return summary;
}

void check_options(const LongTrack& t, const Common&) {
    say_how_read(grading_named(t.box.grading));
    say_how_read(train_named(t.train));
    const RailOnTies rails = t.rails();
    require(rails.tie_support < rails.pad,
            fmt::format("--tie-support: expected less than the {:g} N/m of --pad-stiffness, of "
                        "which it is a part, found {:g} N/m",
                        rails.pad, rails.tie_support));
}

void run(const LongTrack& t, const Common& common) {
    Simulation simulation = make_track(t, common);
    SeriesOf<TrackSample> samples("track");
    LastQuantities last(simulation);
    TieRecords ties;
    Run run(simulation, common, "long_track");
    run.keep(samples);
    run.keep(last);
    run.keep(ties);
    if (!resumes_track(common)) {
        begin_passage(simulation, t);
        ties.begin(simulation.observed());
    } else {
        run.resume(common.resume, {"duration_s"});
    }
    const double dt = simulation.divide_now().resource<Clock>().dt,
                 duration = t.duration > 0 ? t.duration
                                           : time_on_rail(simulation.divide_now(),
                                                          train_named(t.train), t.speed);
    const std::uint64_t steps = steps_of(duration, dt, "duration");
    if (run.is_resumed()) run.require_steps_left(steps, "duration");
    const auto sample = [&](Simulation& s, std::uint64_t) {
        s.observe();
        const World& world = s.observed();
        check_stable_step(world, last.stable_step());
        ties.note(world);
        const Quantities& q = last.quantities();
        samples.add({.time = world.resource<Clock>().time() - ties.began(),
                     .deflection = ties.middle().now,
                     .support = ties.middle().support_now,
                     .largest_deflection = ties.largest().deflection,
                     .unbalanced_ratio = q.unbalanced_ratio,
                     .kinetic_energy = q.kinetic_energy,
                     .stable_step = last.stable_step()});
        return true;
    };
    run.go({run.timed({.name = "pass",
                       .steps = steps,
                       .sample_every = std::max<std::uint64_t>(
                           1, static_cast<std::uint64_t>(std::llround(sample_interval / dt))),
                       .sample = sample,
                       .looks = false})});
    Report summary = summary_of(t, simulation, ties, last, run, common);
    FrameWriter frames(common.out / "long_track.vtkhdf", common.settings);
    const BodyFrame frame = frame_of_bodies(simulation.observed());
    frames.add(simulation.observed(), frame);
    frames.file().close();
    View view = view_of_middle(simulation.observed(), frame, t.bays);
    gather(view);
    draw_picture(common.out / "middle.png", {&view, 1}, {.azimuth = -1.2, .elevation = 0.15});
    draw(t, samples, ties, common);
    samples.write_csv(common.out / "samples.csv");
    write_ties(common.out / "ties.csv", ties);
    report_results(common, summary);
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
