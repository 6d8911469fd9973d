#include "scenarios/track/long_track.hpp"

#include "components/kinds.hpp"
#include "components/settings.hpp"
#include "components/slab.hpp"
#include "engine/errors.hpp"
#include "engine/memory.hpp"
#include "engine/ranks.hpp"
#include "scenarios/ballast_box/start_box.hpp"
#include "scenarios/specimens/facet_bodies.hpp"
#include "scenarios/specimens/memory_estimate.hpp"
#include "scenarios/specimens/scene.hpp"
#include "scenarios/specimens/start.hpp"
#include "scenarios/track/lay_bays.hpp"
#include "scenarios/track/rail_over_bays.hpp"
#include "systems/contact/stable_step.hpp"
#include "systems/fields/fouling.hpp"
#include "systems/recorder/record_motion.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <string_view>
#include <vector>

namespace bris {

namespace {

constexpr auto bay_name = "bay";

/// Whether a run was interrupted before its bay was made.
bool ends_in_bay(const std::filesystem::path& resume) {
    const auto file = fmt::format("{}.ckpt.h5", bay_name);
    if (!std::filesystem::is_directory(resume)) return resume.filename() == file;
    return std::filesystem::exists(resume / file) &&
           !std::filesystem::exists(resume / "long_track.ckpt.h5");
}

Phase the_end() {
    return {.advance = [](Simulation&) { return false; },
            .progress =
                [](const World&) {
                    return PhaseProgress{"the bay is made", 1, ""};
                }};
}

/// Settings of the passages.
const std::vector<std::string_view> of_passages{"bays",          "passages",   "train",
                                                "speed_m_per_s", "duration_s", "gap_m"};

/// Settings on which the bed does not depend.
std::vector<std::string_view> settings_after_bed(const LongTrack& t, const Common& common) {
    std::vector<std::string_view> keys = settings_of_state(t.box, common);
    keys.insert(keys.end(), of_passages.begin(), of_passages.end());
    if (!t.settles_bay())
        keys.insert(keys.end(), {"restitution", "step_fraction", "pad_stiffness_N_per_m",
                                 "rail_bending_N_m2", "tie_support_N_per_m"});
    return keys;
}

/// In the folder of results, from which the bay's files are removed once it is made.
void make_bay(Simulation& simulation, const LongTrack& t, const Common& common) {
    BoxTestRun test(simulation, t.box, common.seed);
    Run run(simulation, common, bay_name);
    const BoxBed bed(simulation, common, settings_after_bed(t, common));
    bed.begin(run, simulation, t.box, of_passages);
    std::vector<Phase> phases = test.bed_of_track();
    const TrackPassage settling{
        .box = t.box, .first_train = t.first_train, .pad_stiffness = t.pad_stiffness};
    if (t.settles_bay()) phases.push_back(first_passage(test, run, settling));
    phases.push_back(save_bed(run, [&bed] { bed.keep(); }));
    for (Phase& phase : test.changes_in_use()) phases.push_back(std::move(phase));
    phases.push_back(the_end()); // which a run that is resumed may repeat
    run.go(phases);
    const bool is_kept = common.resume.empty() && common.beds != "none";
    if (!Ranks::is_first() || !is_kept) return;
    for (const char* file : {"bed.ckpt.h5", "bay.ckpt.h5"}) // the store has it
        std::filesystem::remove(common.out / file);
}

/// Each rank makes the bays of its part and one more on either side.
OwnBays own_bays(unsigned bays) {
    const unsigned ranks = Ranks::size(), rank = Ranks::rank();
    const unsigned first = bays * rank / ranks, last = bays * (rank + 1) / ranks;
    return {rank > 0 ? first - 1 : 0, rank + 1 < ranks ? last + 1 : bays};
}

SlabPlan plan_of(const BallastBox& box, unsigned bays) {
    constexpr double highest = 0.6; // m, of ballast
    constexpr double infinity = std::numeric_limits<double>::infinity();
    SlabPlan plan{.axis = 0,
                  .low = Vec3::Zero(),
                  .high = Vec3(tie_spacing * bays, box_sizes(box).across, highest),
                  .cuts = {-infinity}};
    for (unsigned rank = 1; rank < Ranks::size(); ++rank)
        plan.cuts.push_back(tie_spacing * (bays * rank / Ranks::size()));
    plan.cuts.push_back(infinity);
    return plan;
}

/// A sensor as those of the rocks, on the middle tie.
void add_tie_sensor(World& world, std::uint64_t seed) {
    const auto& ties = world.resource<BoxBodies>().ties;
    const ImuModel& model = world.resource<InertialRecorders>().list.front().device.imu.model();
    add_recorder(world, ties[ties.size() / 2], ImuModel(model), world.resource<Gravity>().value,
                 seed);
}

/// Makes the track of a bay, and divides it.
void lay_track(Simulation& simulation, const LongTrack& t, std::uint64_t seed) {
    World& world = simulation.world();
    if (world.has_resource<Fouling>()) fix_fouling(world);
    const std::size_t most =
        nobody / std::max(world.table<Spheres>().size(), world.table<Bodies>().size());
    require(t.bays <= most,
            fmt::format("--bays: expected at most {}, whose spheres have ids of 32 bits, found {}",
                        most, t.bays));
    const EntityId once = add_ties_on_springs(world, t.rails(), t.bays);
    lay_bays(world, t.bays, own_bays(t.bays), once);
    lay_rail(world, t.rails(), once);
    add_tie_sensor(world, seed);
    if (Ranks::size() > 1) world.add_resource(plan_of(t.box, t.bays));
    simulation.prepare();
    divide_among_ranks(simulation);
}

} // namespace

bool resumes_track(const Common& common) {
    return !common.resume.empty() && !ends_in_bay(common.resume);
}

Simulation make_track(const LongTrack& t, const Common& common) {
    require(t.bays >= Ranks::size(), fmt::format("--ranks: expected at most one for each of the {} "
                                                 "bays, found {}",
                                                 t.bays, Ranks::size()));
    Simulation simulation = make_undivided_box(t.box, common);
    const std::size_t rocks = simulation.world().resource<BoxBodies>().number_of_rocks();
    const OwnBays own = own_bays(t.bays);
    const bool resumes = resumes_track(common); // then all ranks first read the whole
    const double here = static_cast<double>(rocks) * (own.last - own.first),
                 read = resumes ? 0.3 * static_cast<double>(rocks) * t.bays : 0;
    require_memory("bays", t.bays, bytes_of_rocks(here + read, 30), common.memory_limit);
    if (!resumes && !common.explain) {
        make_bay(simulation, t, common);
    } else { // the checkpoint has the State of all bodies, and a rail lies on ties that are free
        World& world = simulation.world();
        if (fouling_of(t.box).any()) add_fields(simulation, t.box);
        for (const EntityId tie : world.resource<BoxBodies>().ties)
            value_of<MotionOf>(world, tie) = static_cast<std::uint32_t>(Motion::free);
    }
    lay_track(simulation, t, common.seed);
    return simulation;
}

void find_step(Simulation& simulation, const LongTrack& t) {
    World& world = simulation.divide_now();
    set_materials(world, {.friction = friction_of_stones(world)}); // those of the passages
    simulation.advance_unseen(1);
    simulation.observe();
    const double stable = stable_step(simulation.observed());
    simulation.divide_now().resource<Clock>().change_step(t.box.step_fraction * stable);
}

void begin_hanging(Simulation& simulation, const LongTrack& t) {
    hang_ties(simulation.divide_now(), t.gap);
}

void begin_passage(Simulation& simulation, const LongTrack& t) {
    World& world = simulation.divide_now();
    begin_train(world, train_named(t.train), t.speed);
    start_recording(world);
}

double duration_of(const LongTrack& t, const World& world) {
    return t.duration > 0 ? t.duration : time_on_rail(world, train_named(t.train), t.speed);
}

} // namespace bris
