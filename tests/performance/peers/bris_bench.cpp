// One run of a scene of the comparison with other codes, on the bed that all codes read: first the
// steps after which the codes are compared, then the timed steps. The result is one line of
// key=value. With --make it makes the bed instead.
#include "components/force_sums.hpp"
#include "components/kinds.hpp"
#include "components/slab.hpp"
#include "engine/ensemble.hpp"
#include "engine/errors.hpp"
#include "engine/loop_times.hpp"
#include "engine/memory.hpp"
#include "engine/ranks.hpp"
#include "engine/scenario.hpp"
#include "engine/signal/median.hpp"
#include "engine/simulation.hpp"
#include "engine/stopwatch.hpp"
#include "scenarios/specimens/start.hpp"
#include "systems/broadphase/lists.hpp"
#include "systems/contact/stable_step.hpp"
#include "systems/output/quantities.hpp"
#include "systems/sleep/sleep.hpp"
#include "systems/steps.hpp"
#include "tests/performance/machine.hpp"
#include "tests/performance/peers/make_bed.hpp"
#include "tests/performance/peers/moving_walls.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <numeric>
#include <ranges>
#include <sys/prctl.h>
#include <tuple>

namespace {

using namespace bris;

struct Benchmark {
    std::string scene = "settle", law = "linear";
    std::filesystem::path bed, positions;
    bool make = false, profile = false, sleep = false, one_pass = true, combined = true,
         huge_pages = true, overlap = false;
    double skin = 0, outer = 3, widest_ratio = ListSettings{}.widest_ratio;
    unsigned sort_every = ListSettings{}.sort_every;
    std::uint64_t least_rows = ScheduleSettings{}.least_rows;
    unsigned spheres = 2000, threads = 1, worlds = 1;
    bool loops = false;
    double step = 0, low = -1e9, high = 1e9, speed = 0, strain = 0;
    std::uint64_t check_steps = 200, steps = 1000;
    unsigned samples = 0;

    void declare_options(auto& option) {
        option("scene", scene, "", "Scene, which determines stiffness, time step and gravity.",
               {"settle", "fall", "shear", "quiet", "poly", "poly5", "clumps", "drop", "triaxial",
                "triaxial_spheres"});
        option("low", low, "m", "Spheres whose centres start below this height are held.");
        option("high", high, "m",
               "Spheres whose centres start above this height move along x at --speed.");
        option("speed", speed, "m/s", "Speed of the spheres above --high.", at_least(0));
        option("strain", strain, "",
               "Axial strain to which a bed under pressure is compressed in --check-steps.",
               within(0, 0.1));
        option("law", law, "", "Contact law.", {"linear", "hertz"});
        option("bed", bed, "", "File of the bed.");
        option("positions", positions, "",
               "File to which the spheres are written after --check-steps.");
        option("make", make, "", "Make the bed and end.");
        option("spheres", spheres, "", "Number of spheres of the bed to make (settle, quiet).",
               within(1, 50e6));
        option("sleep", sleep, "", "Let bodies at rest sleep.");
        option("skin", skin, "",
               "Skin of the neighbour lists, relative to the mean radius. 0: automatic.",
               at_least(0));
        option("outer", outer, "",
               "Skin of the outer neighbour lists, relative to --skin. 1: inner lists only.",
               at_least(1));
        option("sort_every", sort_every, "",
               "Number of rebuilds of the neighbour lists between sorts of the rows. 0: never.");
        option("widest_ratio", widest_ratio, "",
               "Largest ratio of radii in one grid of the neighbour search.", above(1));
        option("one_pass", one_pass, "",
               "Run systems that work row by row in one pass over the rows.");
        option("combined", combined, "",
               "Let one system take the place of several that run in one pass.");
        option("overlap", overlap, "",
               "Run systems that share no data at once, as a task graph, instead of one after "
               "another.");
        option("least_rows", least_rows, "",
               "Number of rows of all tables from which on several threads are used.");
        option("huge_pages", huge_pages, "", "Allow huge pages for large columns.");
        option("worlds", worlds, "",
               "Number of copies of the scene. Several copies run at once, each on one thread, and "
               "the result describes the first one.",
               within(1, 10000));
        option("threads", threads, "", "Number of threads.", within(1, 4096));
        option("step", step, "s", "Time step. 0: the time step of the scene.", at_least(0));
        option("check_steps", check_steps, "",
               "Number of time steps before the physics is compared.", within(1, 1e9));
        option("steps", steps, "", "Number of timed steps.", within(1, 1e9));
        option("loops", loops, "",
               "Print what a timed step would take if each thread had a processor, from the times "
               "of chunks on one of them.");
        option("samples", samples, "",
               "Number of samples, each after twenty more steps, of which the times are printed.");
        option("profile", profile, "", "Print the time of each system in the timed steps.");
    }
};

/// Kinetic energy (J) of the centres of mass, which all codes report.
double translational_energy(const World& world) {
    const auto motion = world.column<Bodies, MotionOf>();
    const auto velocity = world.column<Bodies, Velocity>();
    const auto acceleration = world.column<Bodies, Acceleration>();
    const auto mass = world.column<Bodies, Mass>();
    const double half_step = 0.5 * world.resource<Clock>().dt;
    double sum = 0;
    for (Row r = 0; r < mass.size(); ++r)
        if (motion[r] == static_cast<std::uint32_t>(Motion::free))
            sum += 0.5 * mass[r] * (velocity[r] + half_step * acceleration[r]).squaredNorm();
    return sum;
}

ListSettings lists_of(const Benchmark& s, const peers::Bed& bed) {
    ListSettings lists{.widest_ratio = s.widest_ratio, .sort_every = s.sort_every};
    if (s.skin == 0) return lists;
    double radius = 0;
    for (const Ball& b : bed.balls) radius += b.radius / static_cast<double>(bed.balls.size());
    constexpr double just_outside = 1 + 1e-9;
    lists.inner_skin = s.skin * radius;
    lists.outer_skin = lists.largest_skin = std::max(s.outer, just_outside) * lists.inner_skin;
    lists.tune = false;
    return lists;
}

/// The share of parts or steps that nothing else on the machine disturbs.
constexpr double undisturbed_share = 0.1;

/// A step, if each of its threads had a processor and nothing disturbed the machine.
struct OnThreads {
    double loops = 0;               ///< of several chunks
    double outside = 0, chunks = 0; ///< s on one thread, outside of these loops and in their chunks
    double longest = 0; ///< s, of the loops one after another, until the last thread ends
};

/// s, undisturbed: of a step, and what a sample adds to it, namely that the step is observed, its
/// stable step, and the sums over bodies and contacts.
struct SampleTimes {
    double step = 0, observing = 0, stable_step = 0, quantities = 0;
};

/// Results of the run of one scene.
struct Outcome {
    std::vector<Vec3> pressures;     ///< Pa, on the moving planes of a bed under pressure
    double check_wall = 0, wall = 0; ///< s, wall time of the check steps and of the timed steps
    /// s, wall time of a timed step when nothing else disturbs the machine: the tenth percentile of
    /// the means over parts of them.
    double undisturbed = 0;
    /// J, s, number of spheres in contact with a sphere, MB.
    double energy = 0, stable_step = 0, coordination = 0, peak_memory = 0;
    Quantities quantities;
    std::uint64_t fingerprint = 0, rebuilds = 0, prunes = 0;
    std::size_t sleepers = 0;
    OnThreads on_threads;
    SampleTimes sample;
    std::size_t bodies = 0;
    std::size_t near_chunks = 0;           ///< of the near rows of spheres
    std::size_t rows_of_others = 0;        ///< of ForceSums, in which other chunks push a body
    std::map<std::string, double> seconds; ///< s, of each system in the timed steps
    Ranks::Traffic sent;                   ///< by this rank, in the timed steps
    double ghost_share = 0; ///< largest of the ranks: ghosts relative to bodies that it computes
};

Ranks::Traffic operator-(const Ranks::Traffic& a, const Ranks::Traffic& b) {
    return {a.messages - b.messages, a.bytes - b.bytes, a.reductions - b.reductions};
}

/// Ghosts relative to bodies that this rank computes.
double ghost_share(const World& part) {
    const auto ghost = part.column<Bodies, Ghost>();
    const auto ghosts = static_cast<double>(std::ranges::count(ghost, 1u));
    return ghosts / (static_cast<double>(ghost.size()) - ghosts);
}

/// Calls advance(count) for up to forty parts of the steps.
template <class Advance>
void for_parts(std::uint64_t steps, Advance&& advance) {
    // the last step of a part is observed: so few that it does not count
    const std::uint64_t parts = std::clamp<std::uint64_t>(steps / 100, 1, 40);
    for (std::uint64_t k = 1; k <= parts; ++k) advance(steps * k / parts - steps * (k - 1) / parts);
}

/// Mean wall times of a step (s) in the parts of the steps.
std::vector<double> advance_in_parts(Simulation& simulation, std::uint64_t steps) {
    std::vector<double> step_times;
    for_parts(steps, [&](std::uint64_t count) {
        const auto began = this_instant();
        simulation.advance_unseen(count);
        step_times.push_back(seconds_since(began) / static_cast<double>(count));
    });
    return step_times;
}

/// Times of the chunks of the loops of steps that run the same loops.
class LoopsOfSteps {
public:
    /// `loops`: of a number of steps, of which only the last may run others.
    void add(const std::vector<std::vector<double>>& loops, std::size_t steps) {
        const std::size_t per_step = loops.size() / steps;
        if (of_chunk_.empty())
            for (std::size_t k = 0; k < per_step; ++k) of_chunk_.emplace_back(loops[k].size());
        const auto has_same_chunks = [&](std::size_t k) {
            return loops[k].size() == of_chunk_[k % per_step].size();
        };
        const std::size_t last = per_step * (steps - 1);
        if (per_step != of_chunk_.size() ||
            !std::ranges::all_of(std::views::iota(std::size_t{0}, last), has_same_chunks))
            return; // lists have been made in between
        for (std::size_t k = 0; k < last; ++k)
            for (std::size_t c = 0; c < loops[k].size(); ++c)
                of_chunk_[k % per_step][c].push_back(loops[k][c]);
        steps_ += steps - 1;
    }
    std::size_t steps() const { return steps_; }
    /// Each chunk takes the tenth percentile of its times, as if nothing disturbed the machine.
    void give(OnThreads& to, unsigned threads) const {
        for (const auto& loop : of_chunk_) {
            std::vector<double> seconds;
            for (const auto& times : loop) seconds.push_back(quantile(times, undisturbed_share));
            to.chunks += std::reduce(seconds.begin(), seconds.end());
            to.longest += time_on_threads(seconds, threads);
        }
    }

private:
    std::vector<std::vector<std::vector<double>>> of_chunk_; ///< s, by loop, chunk and step
    std::size_t steps_ = 0;
};

/// Advances by the steps twice: in long parts, of which the observed last step counts little, for
/// what lies outside of loops; and ten at a time for the chunks, without those that make lists.
OnThreads loops_of_steps(Simulation& simulation, std::uint64_t steps, unsigned threads) {
    std::vector<double> loops, outside;
    for_parts(steps, [&](std::uint64_t count) {
        const LoopTimes times;
        simulation.advance_unseen(count);
        loops.push_back(static_cast<double>(times.loops().size()) / static_cast<double>(count));
        outside.push_back(times.outside() / static_cast<double>(count));
    });
    OnThreads found{.loops = quantile(loops, undisturbed_share),
                    .outside = quantile(outside, undisturbed_share)};
    LoopsOfSteps chunks;
    const auto& lists = simulation.world().resource<ListState>();
    for (std::uint64_t k = 0; k < steps; k += 10) {
        const std::uint64_t prunes = lists.prunes;
        const LoopTimes times;
        simulation.advance_unseen(10);
        if (lists.prunes == prunes) chunks.add(times.loops(), 10);
    }
    require(chunks.steps() > 0, "--loops: expected ten --steps in a row that make no lists, "
                                "found none");
    chunks.give(found, threads);
    return found;
}

SampleTimes times_of_samples(Simulation& simulation, unsigned samples) {
    std::vector<double> step, observed, stable, quantities;
    const auto seconds_of = [](auto&& call) {
        const auto began = this_instant();
        call();
        return seconds_since(began);
    };
    for (unsigned k = 0; k < samples; ++k) {
        constexpr unsigned steps = 20;
        step.push_back(seconds_of([&] { simulation.advance_unseen(steps); }) / steps);
        observed.push_back(seconds_of([&] {
            simulation.advance_unseen(1);
            simulation.observe();
        }));
        const World& world = simulation.observed();
        stable.push_back(seconds_of([&] { (void)stable_step(world); }));
        quantities.push_back(seconds_of([&] { (void)compute_quantities(world); }));
    }
    const double plain = quantile(step, undisturbed_share);
    return {plain, quantile(observed, undisturbed_share) - plain,
            quantile(stable, undisturbed_share), quantile(quantities, undisturbed_share)};
}

Outcome run_world(const Benchmark& s, const peers::Scene& scene, const peers::Bed& bed,
                  unsigned threads) {
    const LawName law = peers::law_named(s.law);
    World scene_world = make_scene(bed, scene, law);
    add_lists(scene_world, law, lists_of(s, bed));
    if (s.sleep) add_sleep(scene_world, {});
    Simulation simulation(std::move(scene_world), steps(law), threads,
                          {.overlap = s.overlap,
                           .fused = s.one_pass,
                           .combined = s.combined,
                           .timed = s.profile,
                           .least_rows = s.least_rows});
    divide_among_ranks(simulation);
    const World& world = simulation.world();

    Outcome o;
    const auto start = this_instant();
    if (s.strain > 0)
        o.pressures = peers::compress(simulation, s.strain, s.check_steps);
    else
        simulation.advance(s.check_steps);
    o.check_wall = seconds_since(start);
    if (!s.positions.empty())
        peers::write_bed(s.positions, {bed.box, peers::balls_now(world), bed.rocks});
    o.energy = translational_energy(world);
    simulation.advance(1); // contacts and forces belong to the beginning of this step
    o.quantities = compute_quantities(world);
    o.stable_step = stable_step(world);
    std::size_t touching = 0;
    world.resource<NearIndex<SpherePairs>>().for_touching([&](Row) { ++touching; });
    o.coordination = 2 * static_cast<double>(touching) / static_cast<double>(bed.balls.size());
    const ListState before = world.resource<ListState>();
    const std::map<std::string, double> seconds_before = simulation.seconds();

    const Ranks::Traffic sent = Ranks::traffic();
    const auto began = this_instant();
    const std::vector<double> step_times = advance_in_parts(simulation, s.steps);
    if (const World* part = simulation.part()) {
        o.sent = Ranks::traffic() - sent;
        o.ghost_share = Ranks::largest(ghost_share(*part));
    }
    simulation.look();
    o.wall = seconds_since(began);
    o.undisturbed = quantile(step_times, undisturbed_share);

    o.near_chunks = world.resource<NearIndex<SpherePairs>>().chunks.size();
    o.bodies = world.table<Bodies>().size();
    o.rows_of_others = world.table<ForceSums>().size() - o.bodies;
    o.peak_memory = static_cast<double>(largest_memory()) / 1e6; // MB
    o.rebuilds = world.resource<ListState>().rebuilds - before.rebuilds;
    o.prunes = world.resource<ListState>().prunes - before.prunes;
    o.fingerprint = fingerprint(simulation.snapshot());
    o.sleepers = sleepers(world);
    o.seconds = simulation.seconds();
    for (const auto& [name, seconds] : seconds_before) o.seconds[name] -= seconds;
    if (s.samples > 0) o.sample = times_of_samples(simulation, s.samples);
    if (s.loops) o.on_threads = loops_of_steps(simulation, s.steps, threads);
    return o;
}

void report(const Benchmark& s, const peers::Bed& bed, const Outcome& o) {
    if (!Ranks::is_first()) return;
    const auto spheres = static_cast<double>(bed.balls.size() * s.worlds);
    for (const Vec3& p : o.pressures)
        fmt::print("pressure {:.9g} {:.9g} {:.9g}\n", p.x(), p.y(), p.z());
    fmt::print("code=bris scene={} law={} spheres={} threads={} worlds={} check_steps={} steps={} "
               "wall_s={:.6g} particle_steps_per_s={:.5g} check_wall_s={:.6g} "
               "undisturbed_step_s={:.5g} line_round_trip_ns={:.0f} ",
               s.scene, s.law, bed.balls.size(), s.threads, s.worlds, s.check_steps, s.steps,
               o.wall, spheres * static_cast<double>(s.steps) / o.wall, o.check_wall, o.undisturbed,
               s.threads > 1 ? 1e9 * line_round_trip() : 0.0);
    const Quantities& q = o.quantities;
    fmt::print("kinetic_energy_J={:.8g} coordination={:.6g} wall_force_over_weight={:.8g} ",
               o.energy, o.coordination, q.boundary_force.z() / q.weight.z());
    fmt::print("fingerprint={} peak_memory_MB={:.1f} mean_overlap_m={:.6g} ",
               hexadecimal(o.fingerprint), o.peak_memory, q.mean_overlap);
    const auto per_step = [&](std::uint64_t n) {
        return static_cast<double>(n) / static_cast<double>(s.steps);
    };
    fmt::print("ranks={} ghost_share={:.4g} messages_per_step={:.4g} bytes_per_step={:.5g} "
               "reductions_per_step={:.4g} ",
               Ranks::size(), o.ghost_share, per_step(o.sent.messages), per_step(o.sent.bytes),
               per_step(o.sent.reductions));
    fmt::print("sleepers={} stable_step_s={:.4g} contacts={} rebuilds={} prunes={}\n", o.sleepers,
               o.stable_step, q.contacts, o.rebuilds, o.prunes);
    if (s.samples > 0)
        fmt::print("sample_step_s={:.4g} observing_s={:.4g} stable_step_time_s={:.4g} "
                   "quantities_s={:.4g}\n",
                   o.sample.step, o.sample.observing, o.sample.stable_step, o.sample.quantities);
    if (s.loops)
        fmt::print("loops_per_step={:.4g} outside_s={:.5g} chunks_s={:.5g} longest_s={:.5g} "
                   "balance={:.4f} near_chunks={} rows_of_others={} bodies={}\n",
                   o.on_threads.loops, o.on_threads.outside, o.on_threads.chunks,
                   o.on_threads.longest, o.on_threads.chunks / (s.threads * o.on_threads.longest),
                   o.near_chunks, o.rows_of_others, o.bodies);
    if (!s.profile) return;
    for (const auto& [name, seconds] : o.seconds) fmt::print("  {:10.6f} s  {}\n", seconds, name);
}

void run(const Benchmark& s) {
    peers::Scene scene = peers::scene_named(s.scene);
    require(!s.bed.empty(), "--bed: expected a file, found none");
    if (s.make) return write_bed(s.bed, make_bed(scene, s.spheres, s.threads));
    require(s.strain == 0 || (scene.pressed && s.check_steps % peers::path_parts == 0),
            fmt::format("--strain: expected triaxial or triaxial_spheres and --check-steps as a "
                        "multiple of {}, found {} and {}",
                        peers::path_parts, s.scene, s.check_steps));
    if (s.step > 0) scene.step = s.step;
    std::tie(scene.low, scene.high, scene.speed) = std::tuple(s.low, s.high, s.speed);
    if (!s.huge_pages) prctl(PR_SET_THP_DISABLE, 1, 0, 0, 0);
    const peers::Bed bed = peers::read_bed(s.bed);
    if (s.worlds == 1) return report(s, bed, run_world(s, scene, bed, s.threads));
    std::vector<Outcome> outcomes(s.worlds);
    run_ensemble(s.worlds, s.threads,
                 [&](std::size_t k) { outcomes[k] = run_world(s, scene, bed, 1); });
    // each thread runs its share of the copies in sequence
    double wall = 0;
    for (const Outcome& o : outcomes) wall += o.wall / s.threads;
    outcomes[0].wall = wall;
    report(s, bed, outcomes[0]);
}

} // namespace

int main(int argc, char** argv) {
    return detail::exit_code_of("peers_bench", [&] {
        Benchmark settings;
        Options options;
        settings.declare_options(options);
        if (detail::parse_or_answer(options, {argv + 1, argv + argc}, "peers_bench",
                                    "Runs a scene of the comparison with other codes, or makes its "
                                    "bed."))
            run(settings);
    });
}
