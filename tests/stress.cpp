// The stress suite: hard cases that the engine must compute correctly or refuse.
#include "engine/errors.hpp"
#include "engine/io/whole_file.hpp"
#include "engine/report.hpp"
#include "engine/run.hpp"
#include "tests/stability/suite.hpp"

#include <fmt/format.h>

#include <cstdio>

namespace {

using namespace bris;

struct Stress {
    std::string only;
    bool full = false, list = false;
    double soak_minutes = 30;

    void declare_options(auto& option) {
        option("case", only, "", "Run one case only, for example S6. Empty: run all cases.");
        option("list", list, "", "Print the cases and end.");
        option("full", full, "",
               "Run long runs and many random draws, which take minutes to hours instead of "
               "seconds.");
        option("soak_minutes", soak_minutes, "",
               "Minutes for which the case S29 loads and runs scenes with --full.",
               within(0.1, 1e5));
    }
};

/// Text as a CSV cell.
std::string cell(const std::string& text) {
    std::string quoted = "\"";
    for (const char c : text) quoted += c == '"' ? "\"\"" : std::string(1, c);
    return quoted + "\"";
}

void write_rows(const std::filesystem::path& path, const StressRows& rows) {
    std::string text = "case,what,criterion,found,verdict\n";
    for (const StressRow& r : rows)
        text += fmt::format("{},{},{},{},{}\n", r.id, cell(r.what), cell(r.criterion),
                            cell(r.found), r.pass ? "pass" : "fail");
    write_whole(path, text);
}

void run(const Stress& stress, const Common& common) {
    std::vector<StressCase> cases;
    if (stress.only.empty())
        cases.assign(stress_cases().begin(), stress_cases().end());
    else
        cases.push_back(stress_case(stress.only));
    if (stress.list) {
        for (const StressCase& c : cases) fmt::print("{:4} {}\n", c.id, c.title);
        return;
    }
    const StressSettings settings{stress.full, common.threads, common.seed, stress.soak_minutes};
    StressRows all;
    Report summary;
    std::vector<std::string> names;
    for (const StressCase& c : cases) names.emplace_back(c.id);
    run_cases(common, names, [&](std::size_t k) {
        const StressCase& c = cases[k];
        const auto began = this_instant();
        const StressRows rows = run_case(c, settings);
        const double seconds = seconds_since(began);
        report_news(common, fmt::format("{} {}: {} of {} rows pass, {:.1f} s\n{}", c.id, c.title,
                                        rows.size() - failures(rows), rows.size(), seconds,
                                        table_of(rows)));
        Report own;
        own.add("rows", rows.size());
        own.add("failures", failures(rows));
        own.add("wall_s", seconds);
        for (const NamedValue& entry : own.entries()) own.show({entry.key});
        summary.add_part(std::string(c.id), own);
        all.insert(all.end(), rows.begin(), rows.end());
    });
    summary.add("rows", all.size());
    summary.add("failures", failures(all));
    summary.show({"rows", "failures"});
    write_rows(common.out / "stress.csv", all);
    StressRows failing = all;
    std::erase_if(failing, [](const StressRow& row) { return row.pass; });
    summary.show_sentence(table_of(failing));
    summary.show_sentence("All rows are in stress.csv.");
    report_results(common, summary);
    if (failures(all) > 0)
        throw SimulationError(fmt::format("{} of {} rows fail, see {}", failures(all), all.size(),
                                          (common.out / "stress.csv").string()));
}

} // namespace

int main(int argc, char** argv) {
    return run_scenario<Stress>(argc, argv,
                                {"stress",
                                 "Runs hard cases that the engine must compute correctly or "
                                 "refuse.",
                                 "its cases are short and can be run one by one with --case",
                                 "it runs many small scenes, which --list prints"},
                                run);
}
