#pragma once

#include "engine/io/checkpoint.hpp"
#include "engine/simulation.hpp"
#include "engine/stopwatch.hpp"

#include <filesystem>
#include <functional>
#include <initializer_list>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace bris {

/// Keeps a run's checkpoint: every `interval` seconds of wall time, when the user stops the run, at
/// its end, and when a guard stops it. None of it changes a bit of the run.
class CheckpointKeeper {
public:
    struct Settings {
        std::filesystem::path path; ///< NAME.ckpt.h5
        std::string scenario;
        std::vector<NamedValue> settings;
        std::function<void(Archive&)> also = {}; ///< adds what is not the world's State, as Series
        double interval = 30;                    ///< s, wall time
    };
    explicit CheckpointKeeper(Settings settings) : settings_(std::move(settings)) {}

    /// Between blocks of steps: saves if it is time. If the user has asked to stop, saves and
    /// throws Interrupted.
    void attend(const Simulation& simulation);
    void save(const Simulation& simulation);
    /// What a guard stopped at goes beside the last good checkpoint, NAME.stopped.ckpt.h5. Returns
    /// that path.
    std::filesystem::path save_stopped(const Simulation& simulation) const;
    const std::filesystem::path& path() const { return settings_.path; }

private:
    Checkpoint checkpoint_of(const Simulation& simulation) const;
    Settings settings_;
    Instant last_ = this_instant();
};

/// Reads a checkpoint, of a folder of results the one written last; refuses one of another run
/// (`may_differ` besides the settings that always may), and puts its State into the simulation.
/// Returns it, for what else was kept in it.
Checkpoint resume(Simulation& simulation, const std::filesystem::path& path,
                  const std::string& scenario, const std::vector<NamedValue>& settings,
                  std::initializer_list<std::string_view> may_differ = {});

} // namespace bris
