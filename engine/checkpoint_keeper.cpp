#include "engine/checkpoint_keeper.hpp"

#include "engine/clock.hpp"
#include "engine/errors.hpp"
#include "engine/interrupt.hpp"

#include <fmt/format.h>

namespace bris {

Checkpoint CheckpointKeeper::checkpoint_of(const Simulation& simulation) const {
    Checkpoint checkpoint{settings_.scenario, simulation.world().resource<Clock>().step,
                          settings_.settings, simulation.snapshot()};
    if (settings_.also) settings_.also(checkpoint.state);
    return checkpoint;
}

void CheckpointKeeper::attend(const Simulation& simulation) {
    if (interrupted()) {
        save(simulation);
        throw Interrupted(fmt::format("interrupted at step {}; go on with --resume {}",
                                      simulation.world().resource<Clock>().step,
                                      settings_.path.string()));
    }
    if (seconds_since(last_) >= settings_.interval) save(simulation);
}

void CheckpointKeeper::save(const Simulation& simulation) {
    write_checkpoint(settings_.path, checkpoint_of(simulation));
    last_ = this_instant(); // after the writing: a slow disk gets its rest
}

std::filesystem::path CheckpointKeeper::save_stopped(const Simulation& simulation) const {
    std::string name = settings_.path.filename().string();
    const std::string end = ".ckpt.h5";
    if (name.ends_with(end)) name.resize(name.size() - end.size());
    const auto path = settings_.path.parent_path() / (name + ".stopped" + end);
    write_checkpoint(path, checkpoint_of(simulation));
    return path;
}

namespace {

/// Of a folder of results, the checkpoint that was written last.
std::filesystem::path last_checkpoint(const std::filesystem::path& folder) {
    std::filesystem::path last;
    for (const auto& entry : std::filesystem::directory_iterator(folder)) {
        const std::string name = entry.path().filename().string();
        if (!name.ends_with(".ckpt.h5") || name.find(".stopped.") != std::string::npos) continue;
        if (last.empty() || entry.last_write_time() > std::filesystem::last_write_time(last))
            last = entry.path();
    }
    require(!last.empty(),
            fmt::format("--resume: expected a checkpoint NAME.ckpt.h5 in '{}', found none",
                        folder.string()));
    return last;
}

} // namespace

Checkpoint resume(Simulation& simulation, const std::filesystem::path& given,
                  const std::string& scenario, const std::vector<NamedValue>& settings,
                  std::initializer_list<std::string_view> may_differ) {
    const std::filesystem::path path =
        std::filesystem::is_directory(given) ? last_checkpoint(given) : given;
    require(path.filename().string().find(".stopped.") == std::string::npos,
            fmt::format("--resume: expected a checkpoint to go on from, found '{}', the state in "
                        "which a run was stopped; "
                        "it is there to be looked at",
                        path.string()));
    Checkpoint checkpoint = read_checkpoint(path);
    const auto always = settings_that_may_differ();
    std::vector<std::string_view> keys(always.begin(), always.end());
    keys.insert(keys.end(), may_differ.begin(), may_differ.end());
    require_same_run(path, checkpoint, scenario, settings, keys);
    simulation.restore(checkpoint.state);
    return checkpoint;
}

} // namespace bris
