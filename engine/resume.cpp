#include "engine/resume.hpp"

#include "engine/errors.hpp"

#include <fmt/format.h>

namespace bris {

namespace {

bool was_stopped_by_guard(const std::filesystem::path& path) {
    return path.filename().string().find(".stopped.") != std::string::npos;
}

/// The checkpoint in a folder of results that was written last.
std::filesystem::path last_checkpoint(const std::filesystem::path& folder,
                                      const std::string& option) {
    std::filesystem::path last;
    for (const auto& entry : std::filesystem::directory_iterator(folder)) {
        const auto& path = entry.path();
        if (!path.filename().string().ends_with(".ckpt.h5") || was_stopped_by_guard(path)) continue;
        if (last.empty() || entry.last_write_time() > std::filesystem::last_write_time(last))
            last = path;
    }
    require(!last.empty(), fmt::format("{}: expected a checkpoint NAME.ckpt.h5 in '{}', found none",
                                       option, folder.string()));
    return last;
}

} // namespace

Checkpoint checkpoint_to_resume(const std::filesystem::path& given, const std::string& scenario,
                                const std::vector<NamedValue>& settings,
                                const std::vector<std::string_view>& may_differ,
                                const std::string& option) {
    const auto path = std::filesystem::is_directory(given) ? last_checkpoint(given, option) : given;
    require(!was_stopped_by_guard(path),
            fmt::format("{}: expected a checkpoint of a running simulation, found '{}', the "
                        "state in which a guard stopped it, which is kept for inspection",
                        option, path.string()));
    Checkpoint checkpoint = read_checkpoint(path);
    const auto always = settings_that_may_differ();
    std::vector<std::string_view> keys(always.begin(), always.end());
    keys.insert(keys.end(), may_differ.begin(), may_differ.end());
    require_same_run(option, path, checkpoint, scenario, settings, keys);
    return checkpoint;
}

Checkpoint resume(Simulation& simulation, const std::filesystem::path& path,
                  const std::string& scenario, const std::vector<NamedValue>& settings,
                  const std::vector<std::string_view>& may_differ, const std::string& option) {
    Checkpoint checkpoint = checkpoint_to_resume(path, scenario, settings, may_differ, option);
    simulation.restore(checkpoint.state);
    return checkpoint;
}

} // namespace bris
