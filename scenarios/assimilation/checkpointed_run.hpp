#pragma once

#include "engine/archive.hpp"
#include "engine/run.hpp"
#include "scenarios/assimilation/model_run.hpp"

#include <filesystem>
#include <optional>

namespace bris {

void save_poses(Archive& archive, const std::string& path, const std::vector<RockPose>& poses);
std::vector<RockPose> load_poses(const Archive& archive, const std::string& path);
void save_run(Archive& archive, const ModelRun& run);
ModelRun load_run(const Archive& archive);

/// Where the run of an arm is kept, while it goes on and when it is done: a stopped campaign of
/// runs goes on where it was. Files are named by all that the run depends on, so another run is
/// never taken for it.
class CheckpointedRun {
public:
    CheckpointedRun() = default; ///< keeps nothing
    /// In the folder `runs` of the results; `--resume FOLDER` looks there too.
    CheckpointedRun(const Common& common, const TriaxialSettings& settings, const Archive& specimen,
                    const ModelVariant& variant);
    CheckpointTimer& timer() { return timer_; }

    /// What was kept of it; nothing: nothing was, or this is no run that goes on.
    std::optional<Archive> resume() const;
    void save(const Archive& archive);

private:
    std::filesystem::path file_, before_;
    std::string name_;
    CheckpointTimer timer_;
};

/// Runs that are kept are of no use when all is done.
void remove_checkpoints(const Common& common);

} // namespace bris
