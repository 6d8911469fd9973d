#pragma once

#include "engine/archive.hpp"
#include "engine/run.hpp"
#include "scenarios/ensemble/model_run.hpp"

#include <filesystem>
#include <optional>

namespace bris {

void save_poses(Archive& archive, const std::string& path, const std::vector<RockPose>& poses);
std::vector<RockPose> load_poses(const Archive& archive, const std::string& path);
void save_run(Archive& archive, const ModelRun& run);
ModelRun load_run(const Archive& archive);

/// The checkpoint file of one model run, written while it runs and when it is done, so that an
/// interrupted campaign of runs resumes where it was. The file name is a fingerprint of everything
/// that the run depends on, so no other run is mistaken for it.
class CheckpointedRun {
public:
    CheckpointedRun() = default; ///< saves nothing
    /// The file is in the folder `runs` of the results; with `--resume FOLDER` a checkpoint is read
    /// from there.
    CheckpointedRun(const Common& common, const TriaxialSettings& settings, const Archive& specimen,
                    const ModelVariant& variant);
    CheckpointTimer& timer() { return timer_; }

    /// The last checkpoint of this run; nothing if there is none or the run does not resume.
    std::optional<Archive> resume() const;
    void save(const Archive& archive);

private:
    std::filesystem::path file_, before_;
    std::string name_;
    CheckpointTimer timer_;
};

/// Removes the checkpoints of all runs, which are of no use once a campaign is complete.
void remove_checkpoints(const Common& common);

} // namespace bris
