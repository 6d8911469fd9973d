#include "scenarios/ballast_box/track_slice.hpp"

#include "components/kinds.hpp"
#include "engine/errors.hpp"
#include "scenarios/ballast_box/load_turns.hpp"
#include "scenarios/ballast_box/start_box.hpp"
#include "scenarios/ballast_box/tie_under_rails.hpp"
#include "scenarios/specimens/check_scene.hpp"
#include "scenarios/specimens/scene.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace bris {

namespace {

constexpr auto record_path = "passages/movements", begin_path = "passages/at_begin",
               valley_path = "passages/at_valley", turn_path = "passages/at_turn";
constexpr std::uint64_t samples_per_turn = 25;

/// m, of the sensor rocks and the tie.
std::vector<double> heights_of(const World& world) {
    const auto& bodies = world.resource<BoxBodies>();
    const auto& positions = world.column<Bodies, Position>();
    std::vector<double> heights;
    for (const BoxSensor& sensor : bodies.sensors)
        heights.push_back(positions[row_of_body(world, sensor.body)].z());
    heights.push_back(height_of_tie(world));
    return heights;
}

/// Calls visit(number, movement) for the sensor rocks and the tie in the present passage.
template <class Visit>
void for_each_body(PassageRecord& record, Visit&& visit) {
    for (std::size_t k = 0; k < record.now.rocks.size(); ++k) visit(k, record.now.rocks[k]);
    visit(record.now.rocks.size(), record.now.tie);
}

void follow(PassageRecord& record, const std::vector<double>& heights) {
    for_each_body(record, [&](std::size_t k, Movement& m) {
        m.settlement = record.at_begin[k] - heights[k];
        m.deflection = std::max(m.deflection, record.at_valley[k] - heights[k]);
    });
}

/// At extreme number `turn` of the load, from 1.
void note_turn(PassageRecord& record, const std::vector<double>& heights,
               const std::vector<double>& turns, std::size_t turn) {
    double squares = 0;
    for (std::size_t k = 1; k < turns.size(); ++k) squares += std::pow(turns[k] - turns[k - 1], 2);
    const double change = turns[turn] - turns[turn - 1];
    for_each_body(record, [&](std::size_t k, Movement& m) {
        m.compliance += change * (record.at_turn[k] - heights[k]) / squares;
    });
    record.at_turn = heights;
    if (turn % 2 == 0) record.at_valley = heights;
}

Phase passage(const BoxTestRun& test, const TrackSlice& slice, const Train& train,
              std::size_t number, PassageRecord& record, const Run& run) {
    const std::vector<double> turns = load_turns(train, slice.rails(), dead_load);
    const std::uint64_t per_turn = slice.box.steps_per_cycle / 2,
                        steps = per_turn * (turns.size() - 1),
                        block_steps = std::max<std::uint64_t>(1, per_turn / samples_per_turn);
    return {.advance =
                [=, &record, &run](Simulation& s) {
                    const std::uint64_t done = run.steps_in_phase();
                    if (done >= steps) return false;
                    const std::uint64_t turn_ends = (done / per_turn + 1) * per_turn;
                    s.advance(std::min(block_steps, turn_ends - done));
                    check_stable_step(s.world());
                    const std::uint64_t now = run.steps_in_phase();
                    const std::vector<double> heights = heights_of(s.world());
                    follow(record, heights);
                    if (now % per_turn == 0) note_turn(record, heights, turns, now / per_turn);
                    if (now % (2 * per_turn) == 0) raise_masses(s.world());
                    if (now < steps) return true;
                    record.passages.push_back(record.now);
                    return false;
                },
            .progress =
                [=, &run](const World&) {
                    const auto done = static_cast<double>(run.steps_in_phase());
                    return PhaseProgress{
                        fmt::format("passage {}", number), done / static_cast<double>(steps),
                        fmt::format("cycle {:.1f} of {}", done / static_cast<double>(2 * per_turn),
                                    cycles_of(turns))};
                },
            .begin =
                [=, &test, &record](Simulation& s) {
                    if (record.passages.empty()) test.note_bed(s.world());
                    record.at_begin = record.at_valley = record.at_turn = heights_of(s.world());
                    record.now = {.rocks = std::vector<Movement>(record.at_begin.size() - 1)};
                    const double dt = s.world().resource<Clock>().dt;
                    test.begin_passage(s.world(),
                                       load_through(turns, dt * static_cast<double>(per_turn)));
                }};
}

} // namespace

BallastBox seated_by_rails(BallastBox box) {
    require(box.model == "settlement", "slice of track: expected the settlement model of the box");
    box.peak_load = 100 * dead_load; // any; the trains' loads are their own
    box.least_load = 0.01;
    return box;
}

void PassageRecord::save(Archive& archive) const {
    std::vector<double> numbers;
    const auto add = [&](const Movement& m) {
        numbers.insert(numbers.end(), {m.deflection, m.settlement, m.compliance});
    };
    std::vector<PassageMovements> all = passages;
    if (!at_begin.empty()) all.push_back(now);
    for (const PassageMovements& p : all) {
        std::ranges::for_each(p.rocks, add);
        add(p.tie);
    }
    archive.put(record_path, std::span<const double>(numbers));
    archive.put(begin_path, std::span<const double>(at_begin));
    archive.put(valley_path, std::span<const double>(at_valley));
    archive.put(turn_path, std::span<const double>(at_turn));
}

void PassageRecord::load(const Archive& archive) {
    at_begin = archive.get<double>(begin_path);
    at_valley = archive.get<double>(valley_path);
    at_turn = archive.get<double>(turn_path);
    passages.clear();
    const auto numbers = archive.get<double>(record_path);
    for (auto next = numbers.begin(); next != numbers.end();) {
        PassageMovements& p = passages.emplace_back();
        for (std::size_t k = 1; k < at_begin.size(); ++k, next += 3)
            p.rocks.push_back({next[0], next[1], next[2]});
        p.tie = {next[0], next[1], next[2]};
        next += 3;
    }
    if (passages.empty()) return; // no train has come yet
    now = passages.back();
    passages.pop_back();
}

PassageRecord run_trains(const TrackSlice& slice, const std::vector<Train>& trains,
                         const Common& common, const std::string& name,
                         const std::filesystem::path& from,
                         const std::vector<std::string_view>& may_differ,
                         const ReportProgress& report) {
    const BallastBox box = seated_by_rails(slice.box);
    Common own = common;
    own.seed = slice.seed;
    own.resume = from;
    Simulation simulation = make_box_simulation(box, own);
    BoxTestRun test(simulation, box, slice.seed);
    PassageRecord record;
    Run run(simulation, own, name, report);
    run.keep(record);
    resume_box(run, simulation, box, own, may_differ);
    std::vector<Phase> phases = test.preparation();
    for (std::size_t k = 0; k < trains.size(); ++k)
        phases.push_back(passage(test, slice, trains[k], k + 1, record, run));
    run.go(phases);
    return record;
}

} // namespace bris
