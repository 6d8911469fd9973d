#include "engine/resume.hpp"

#include "engine/errors.hpp"

#include <fmt/format.h>

namespace bris {

namespace {

bool was_stopped_by_guard(const std::filesystem::path& path) {
    return path.filename().string().find(".stopped.") != std::string::npos;
}

/// The checkpoint in a folder of results that was written last.
std::filesystem::path last_checkpoint(const std::filesystem::path& folder) {
    std::filesystem::path last;
    for (const auto& entry : std::filesystem::directory_iterator(folder)) {
        const auto& path = entry.path();
        if (!path.filename().string().ends_with(".ckpt.h5") || was_stopped_by_guard(path)) continue;
        if (last.empty() || entry.last_write_time() > std::filesystem::last_write_time(last))
            last = path;
    }
    require(!last.empty(),
            fmt::format("--resume: expected a checkpoint NAME.ckpt.h5 in '{}', found none",
                        folder.string()));
    return last;
}

} // namespace

Checkpoint resume(Simulation& simulation, const std::filesystem::path& given,
                  const std::string& scenario, const std::vector<NamedValue>& settings,
                  const std::vector<std::string_view>& may_differ) {
    const auto path = std::filesystem::is_directory(given) ? last_checkpoint(given) : given;
    require(!was_stopped_by_guard(path),
            fmt::format("--resume: expected a checkpoint of a running simulation, found '{}', the "
                        "state in which a guard stopped it, which is kept for inspection",
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
