// Compares the engine with exact solutions: every group of checks in one table, with the numbers
// that fail.
#include "engine/errors.hpp"
#include "engine/io/whole_file.hpp"
#include "engine/report.hpp"
#include "engine/run.hpp"
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
        option("case", only, "", "Run one group of checks only. Empty: run all groups.", names);
        option("list", list, "",
               "Print the groups with the sources of their exact values and end.");
    }
};

void run(const Verify& settings, const Common& common) {
    if (settings.list) {
        for (const VerificationCase& c : verification_cases())
            fmt::print("{:<16} {}\n", c.name, c.source);
        return;
    }
    std::vector<std::string> names;
    for (const VerificationCase& c : verification_cases())
        if (settings.only.empty() || settings.only == c.name) names.emplace_back(c.name);
    std::vector<Check> checks;
    run_cases(common, names, [&](std::size_t k) {
        for (Check& check : verify(names[k])) checks.push_back(std::move(check));
    });
    write_whole(common.out / "verification.csv", csv_of(checks));
    Report results;
    add_checks(results, checks);
    const std::string all = (common.out / "verification.csv").string();
    std::erase_if(checks, [](const Check& check) { return check.passes(); });
    results.show_sentence(table_of(checks)); // those that fail
    results.show_sentence("All numbers with their exact values and tolerances are in " + all + ".");
    report_results(common, results);
    if (const std::string failing = names_of_failing(checks); !failing.empty())
        throw SimulationError("verify: these checks fail: " + failing);
}

} // namespace

int main(int argc, char** argv) {
    return run_scenario<Verify>(argc, argv,
                                {"verify", "Compares the engine with exact solutions.",
                                 "its runs are short",
                                 "it runs many small scenes, which --list prints"},
                                run);
}
