#include "scenarios/field_tests/bed_tests.hpp"

#include "engine/errors.hpp"
#include "scenarios/field_tests/rock_bed.hpp"
#include "scenarios/specimens/bed_store.hpp"

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

void make_bed(Run& run, const Simulation& simulation, const Common& common,
              const std::vector<std::string_view>& settings_of_tests) {
    constexpr auto name = "specimen";
    Common of_bed = common;
    of_bed.resume = checkpoint_of(common, name);
    const BedStore store(of_bed, simulation, name, settings_of_tests);
    if (!store.from().empty()) run.resume(store.from(), settings_of_tests);
    run.go(make_bed_phases());
    store.keep(common.out / (std::string(name) + ".ckpt.h5"));
}

} // namespace bris
