#include "engine/run.hpp"

#include "engine/errors.hpp"
#include "engine/interrupt.hpp"
#include "engine/memory.hpp"
#include "engine/ranks.hpp"
#include "engine/resume.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

namespace bris {

namespace {

// Between two looks whether the user has asked to stop.
constexpr std::uint64_t longest_block = 100; // steps
constexpr double longest_blind = 0.5;        // s

/// Number of steps without a look. On several ranks, which look together, it is the same on all,
/// and blocks of few steps would be costly (Simulation::advance_unseen).
std::uint64_t block_of(const Simulation& simulation) {
    const StepCount& so_far = simulation.count();
    if (Ranks::size() > 1 || so_far.steps == 0) return Ranks::size() > 1 ? longest_block : 1;
    const double steps = longest_blind * static_cast<double>(so_far.steps) / so_far.wall_time;
    return steps < static_cast<double>(longest_block)
               ? std::max<std::uint64_t>(1, static_cast<std::uint64_t>(steps))
               : longest_block;
}
constexpr auto position_path = "run/position";

} // namespace

void run_loop(const LoopSteps& steps, CheckpointTimer& timer, const ReportProgress& report) {
    bool advanced = false;
    std::optional<SavesWhenInterrupted> saves;
    const std::string hint = "continue with " + steps.resume_hint;
    if (steps.save) saves.emplace(hint);
    try {
        Ranks::meet(); // whatever was written since the last message
        while (steps.advance()) {
            Ranks::meet();
            advanced = true;
            report(steps.progress());
            if (Ranks::any(interrupted())) {
                if (steps.save) steps.save();
                throw Interrupted("interrupted; " + hint);
            }
            if (steps.save && Ranks::any(timer.is_due())) {
                steps.save();
                timer.restart();
            }
        }
    } catch (...) {
        if (advanced) report({}); // the run has ended
        throw;
    }
    if (advanced) report({});
}

void run_cases(const Common& common, const std::vector<std::string>& names,
               const std::function<void(std::size_t)>& run) {
    Progress progress = make_progress(common);
    CheckpointTimer timer;
    std::size_t next = 0;
    const auto advance = [&] {
        if (next == names.size()) return false;
        progress.pause();
        run(next++);
        return next < names.size();
    };
    const auto standing = [&] {
        return PhaseProgress{common.scenario,
                             static_cast<double>(next) / static_cast<double>(names.size()),
                             names[next]};
    };
    run_loop({.advance = advance,
              .progress = standing,
              .resume_hint = "the remaining cases, one by one with --case"},
             timer, progress_slot(progress));
}

std::uint64_t steps_of(double duration, double dt, const std::string& option) {
    const double number = std::round(duration / dt);
    require(number >= 1 && number < 1e15,
            fmt::format("--{}: expected 1 to 1e15 steps of {:.3g} s, found {:.3g}", option, dt,
                        number));
    return static_cast<std::uint64_t>(number);
}

Progress make_progress(const Common& common) {
    return Progress(common.quiet ? Progress::Style::quiet : Progress::Style::automatic);
}

Run::Run(Simulation& simulation, const Common& common, const std::string& name,
         ReportProgress report)
    : simulation_(simulation), common_(common), name_(name), report_(std::move(report)),
      count_before_(simulation.count()) {}

Run::Run(Simulation& simulation, const Common& common, const std::string& name)
    : simulation_(simulation), common_(common), name_(name),
      progress_(new Progress(make_progress(common))), report_(progress_slot(*progress_)),
      count_before_(simulation.count()) {}

void Run::resume(const std::filesystem::path& path,
                 const std::vector<std::string_view>& may_differ) {
    const Archive state =
        bris::resume(simulation_, path, common_.scenario, common_.settings, may_differ).state;
    const auto position = state.get<std::uint64_t>(position_path);
    position_ = {position.at(0), position.at(1), position.at(2) != 0};
    for (const Kept& kept : kept_) kept.load(state);
    resumed_ = true;
}

void Run::go(const std::vector<Phase>& phases) {
    const std::string hint = fmt::format("--resume {}", checkpoint_file(name_).string());
    const SavesWhenInterrupted saves("continue with " + hint);
    try {
        for (; position_.phase < phases.size(); ++position_.phase, position_.begun = false) {
            const Phase& phase = phases[position_.phase];
            if (!position_.begun) {
                position_ = {position_.phase, simulation_.step(), true};
                if (phase.begin) phase.begin(simulation_);
                position_.first_step = simulation_.step();
            }
            run_loop({.advance = [&] { return phase.advance(simulation_); },
                      .progress = [&] { return phase.progress(simulation_.world()); },
                      .save = [&] { save(); },
                      .resume_hint = hint},
                     timer_, report_);
            // the last phase stays the current one, so that a longer run continues it
            if (position_.phase + 1 == phases.size()) break;
        }
    } catch (const SimulationError& error) {
        save_as(name_ + ".stopped");
        throw SimulationError(fmt::format("{} (state saved in {})", error.what(),
                                          checkpoint_file(name_ + ".stopped").string()));
    }
    save();
}

Phase Run::timed(TimedPhase phase) const {
    const auto progress = [this, phase](const World& world) {
        return PhaseProgress{
            phase.name, static_cast<double>(steps_in_phase()) / static_cast<double>(phase.steps),
            phase.status ? phase.status(world) : std::string{}};
    };
    const auto advance = [this, phase](Simulation& simulation) {
        const std::uint64_t now = steps_in_phase();
        if (now >= phase.steps) return false;
        const std::uint64_t next =
            std::min(phase.steps, (now / phase.sample_every + 1) * phase.sample_every);
        simulation.advance_unseen(std::min(next - now, block_of(simulation)));
        if (steps_in_phase() != next) return true;
        if (phase.looks) simulation.look();
        return phase.sample(simulation, next);
    };
    return {.advance = advance, .progress = progress, .begin = phase.begin};
}

void Run::require_steps_left(std::uint64_t steps, const std::string& option) const {
    const double dt = clock().dt;
    // as many are enough: the run was killed before it wrote its results
    require(steps >= steps_in_phase(),
            fmt::format("--{}: expected at least the {:.6g} s of the checkpoint, found {:.6g} s",
                        option, static_cast<double>(steps_in_phase()) * dt,
                        static_cast<double>(steps) * dt));
}

void Run::save_as(const std::string& name) const {
    const Saving saving;
    simulation_.observe();
    Checkpoint checkpoint{common_.scenario, simulation_.step(), common_.settings, {}};
    const std::array<std::uint64_t, 3> position{position_.phase, position_.first_step,
                                                position_.begun ? std::uint64_t{1} : 0};
    checkpoint.state.put(position_path, std::span<const std::uint64_t>(position));
    for (const Kept& kept : kept_) kept.save(checkpoint.state);
    const StateOfWorld state = simulation_.state();
    write_checkpoint(checkpoint_file(name), checkpoint, &state);
    return_free_memory();
    Ranks::meet();
}

std::filesystem::path Run::file(const std::string& name, const std::string& extension) const {
    return common_.out / (resumed_ && steps_in_phase() > 0
                              ? fmt::format("{}_from_{}{}", name, steps_in_phase(), extension)
                              : name + extension);
}

StepCount Run::count() const {
    const StepCount& all = simulation_.count();
    return {all.steps - count_before_.steps, all.wall_time - count_before_.wall_time};
}

void Run::add_to_summary(Summary& summary) const {
    summary.add("steps", steps_in_phase());
    summary.add("wall_time_s", seconds_since(began_));
    const StepCount run = count();
    summary.add("stepping_time_s", run.wall_time);
    summary.add("time_per_step_s",
                run.wall_time / static_cast<double>(std::max<std::uint64_t>(1, run.steps)));
    summary.add("memory_largest_MiB", static_cast<double>(largest_memory()) * 0x1p-20);
    summary.add("fingerprint", hexadecimal(fingerprint(simulation_.state())));
}

} // namespace bris
