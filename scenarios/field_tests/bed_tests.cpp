#include "scenarios/field_tests/bed_tests.hpp"

#include "engine/errors.hpp"

#include <fmt/format.h>

namespace bris {

void require_folder_to_resume(const Common& common) {
    require(
        common.resume.empty() || std::filesystem::is_directory(common.resume),
        fmt::format("--resume: expected a folder of results, found '{}'", common.resume.string()));
}

std::filesystem::path checkpoint_of(const Common& common, const std::filesystem::path& name) {
    if (common.resume.empty()) return {};
    const std::filesystem::path file = common.resume / (name.string() + ".ckpt.h5");
    return std::filesystem::exists(file) ? file : std::filesystem::path();
}

} // namespace bris
