#pragma once

#include "engine/ensemble.hpp"
#include "engine/progress.hpp"
#include "engine/report.hpp"
#include "engine/run.hpp"

#include <algorithm>
#include <filesystem>
#include <memory>
#include <string_view>
#include <vector>

namespace bris {

// Several tests of one bed, each with a run and a folder of results of its own.

/// Throws InputError unless --resume is empty or a folder of results.
void require_folder_to_resume(const Common& common);

/// The checkpoint NAME.ckpt.h5 in the folder --resume; empty: there is none.
std::filesystem::path checkpoint_of(const Common& common, const std::filesystem::path& name);

/// Makes the bed of several tests in the `run` of a simulation, as specimen.ckpt.h5; continues from
/// that of --resume, or takes it from the store of beds (BedStore), where it is afterwards.
/// `settings_of_tests` do not concern the bed.
void make_bed(Run& run, const Simulation& simulation, const Common& common,
              const std::vector<std::string_view>& settings_of_tests);

/// Runs all tests, as many at once as there are threads, and returns them in their order. `make`
/// (test, threads, report) returns a pointer to the run of a test, whose `go` runs it. `samples`:
/// of one test, for the progress line.
template <class Test, class Make>
auto run_tests(const std::vector<Test>& tests, double samples, const Common& common,
               Progress& progress, const Make& make) {
    const auto testers =
        std::max(1u, std::min(common.threads, static_cast<unsigned>(tests.size())));
    progress.begin_job(static_cast<double>(tests.size()) * samples);
    std::vector<decltype(make(tests[0], 1u, ReportProgress()))> runs(tests.size());
    run_ensemble(tests.size(), testers, [&](std::size_t k) {
        runs[k] = make(tests[k], std::max(1u, common.threads / testers),
                       progress_slot(progress, static_cast<unsigned>(k)));
        runs[k]->go();
    });
    progress.pause();
    return runs;
}

/// Adds the summaries of all tests; several are parts with the names of their tests.
template <class Runs>
void add_results_of_tests(Report& all, const Runs& runs) {
    for (const auto& one : runs) all.add_part(runs.size() > 1 ? one->name() : "", one->summary());
}

} // namespace bris
