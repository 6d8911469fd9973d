// A library of specimens: triaxial tests of many packings whose friction, stiffness and porosity
// cover a range, kept on common strains. From it, early measurements of a specimen that was never
// simulated predict what follows.

#include "scenarios/assimilation/specimen_library.hpp"

#include "engine/errors.hpp"
#include "engine/io/checkpoint.hpp"
#include "engine/scenario.hpp"
#include "engine/summary.hpp"
#include "scenarios/assimilation/library_design.hpp"

#include <fmt/format.h>

namespace bris {

namespace {

constexpr auto library_file = "specimen_library.h5";

struct LibraryRun {
    Triaxial triaxial;
    LibraryDesign design;

    void describe(auto& option) {
        design.describe(option);
        triaxial.describe(option);
    }
};

/// The library in the folder --resume, or one without specimens.
SpecimenLibrary begin_library(const LibraryRun& s, const Common& common) {
    SpecimenLibrary library = empty_library(s.design, s.triaxial, common);
    if (common.resume.empty()) return library;
    const auto file = common.resume / library_file;
    require(std::filesystem::exists(file), fmt::format("--resume: expected {} in '{}', found none",
                                                       library_file, common.resume.string()));
    SpecimenLibrary before = read_library(file);
    require_same_run("--resume", file, {common.scenario, 0, before.settings, {}}, common.scenario,
                     library.settings, settings_that_may_differ());
    return before;
}

void run(const LibraryRun& s, const Common& common) {
    check_design(s.design, s.triaxial);
    require(s.triaxial.test.friction == TriaxialSettings{}.friction,
            "--friction: not used by this scenario, whose specimens have frictions from "
            "--lowest-friction to --highest-friction; expected --preparation-friction, that of "
            "the rocks while a specimen is made");
    require_memory_for(s.triaxial, common.threads, common.memory_limit,
                       static_cast<double>(common.threads) * s.triaxial.test.final_axial_strain /
                           s.triaxial.test.stage_strain);
    SpecimenLibrary library = begin_library(s, common);
    complete_library(library, common.out / library_file, s.design, s.triaxial, common);
    Summary summary;
    summary.add("specimens_made", library.specimens.size());
    std::uint64_t redrawn = 0;
    for (const LibrarySpecimen& specimen : library.specimens) redrawn += specimen.redrawn;
    summary.add("packings_redrawn", redrawn);
    summary.add("specimens_given_up", library.given_up.size());
    report_results(common, summary);
}

std::string explain(const LibraryRun& s, const Common& common) {
    return explain_triaxial(s.triaxial, common);
}

} // namespace

} // namespace bris

int main(int argc, char** argv) {
    return bris::run_scenario<bris::LibraryRun>(
        argc, argv,
        {"specimen_library",
         "Tests many specimens of different friction, stiffness, porosity and packing, and keeps "
         "the results as a library for predictions."},
        bris::run, bris::explain);
}
