// The engine against exact answers: every group of checks, one table, and which numbers fail.
#include "engine/errors.hpp"
#include "engine/io/whole_file.hpp"
#include "engine/run.hpp"
#include "engine/summary.hpp"
#include "scenarios/verification/cases.hpp"
#include "scenarios/verification/table.hpp"

#include <fmt/format.h>

#include <cstdio>

namespace {

using namespace bris;

struct Verify {
    std::string only;
    bool list = false;

    void describe(auto& option) {
        std::vector<std::string> names{""};
        for (const VerificationCase& c : verification_cases()) names.emplace_back(c.name);
        option("case", only, "", "one group alone", names);
        option("list", list, "",
               "print the groups and the sources of their exact values, run nothing");
    }
};

void run(const Verify& settings, const Common& common) {
    if (settings.list) {
        for (const VerificationCase& c : verification_cases())
            fmt::print("{:<16} {}\n", c.name, c.source);
        return;
    }
    std::vector<Check> checks;
    Progress progress = make_progress(common);
    const auto cases = verification_cases();
    for (std::size_t k = 0; k < cases.size(); ++k) {
        if (!settings.only.empty() && settings.only != cases[k].name) continue;
        progress.report(0, {"verify", static_cast<double>(k) / static_cast<double>(cases.size()),
                            cases[k].name});
        for (Check& check : verify(cases[k].name)) checks.push_back(std::move(check));
    }
    write_whole(common.out / "verification.csv", csv_of(checks));
    Summary results;
    add_checks(results, checks);
    fmt::print("{}", table_of(checks));
    report_results(common, results);
    if (const std::string failing = names_of_failing(checks); !failing.empty())
        throw SimulationError("failing: " + failing);
}

} // namespace

int main(int argc, char** argv) {
    return run_scenario<Verify>(argc, argv,
                                {"verify", "compare the engine with exact answers",
                                 "its runs are short",
                                 "it runs many small scenes; --list names them"},
                                run);
}
