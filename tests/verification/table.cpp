#include "tests/verification/table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <map>

namespace bris {

namespace {

const char* word(Check::Rule rule) {
    switch (rule) {
    case Check::Rule::relative:
        return "relative";
    case Check::Rule::absolute:
        return "absolute";
    case Check::Rule::at_most:
        return "at most";
    case Check::Rule::at_least:
        break;
    }
    return "at least";
}

std::string quoted(std::string text) {
    std::replace(text.begin(), text.end(), '"', '\'');
    return '"' + text + '"';
}

/// Error over tolerance. Infinite for any error if the tolerance is zero.
double share_of_tolerance(const Check& c) {
    if (c.error() <= 0) return 0;
    return c.tolerance > 0 ? c.error() / c.tolerance : std::numeric_limits<double>::infinity();
}

} // namespace

std::vector<Check> closest_to_tolerance(std::vector<Check> checks, std::size_t most) {
    std::ranges::stable_sort(checks, [](const Check& a, const Check& b) {
        const double first = share_of_tolerance(a), second = share_of_tolerance(b);
        return std::isnan(first) ? !std::isnan(second) : first > second;
    });
    checks.resize(std::min(checks.size(), most));
    return checks;
}

std::string table_of(const std::vector<Check>& checks) {
    std::size_t widest = 8;
    for (const Check& c : checks) widest = std::max(widest, c.group.size() + 2 + c.quantity.size());
    std::string text = fmt::format("{:<{}} {:>12} {:>12} {:>9} {:>9}\n", "closest to tolerance",
                                   widest, "expected", "found", "error", "tolerance");
    for (const Check& c : checks)
        text += fmt::format("{:<{}} {:>12.6g} {:>12.6g} {:>9.2e} {:>9.1e} {}{}\n",
                            c.group + ": " + c.quantity, widest, c.expected, c.found, c.error(),
                            c.tolerance, c.passes() ? "" : "FAILS ",
                            c.rule == Check::Rule::relative ? "" : word(c.rule));
    return text;
}

std::string csv_of(const std::vector<Check>& checks) {
    std::string text = "case,quantity,unit,expected,found,error,tolerance,rule,others,passes\n";
    for (const Check& c : checks)
        text +=
            fmt::format("{},{},{},{},{},{},{},{},{},{}\n", c.group, quoted(c.quantity),
                        quoted(c.unit), c.expected, c.found, c.error(), c.tolerance, word(c.rule),
                        std::isnan(c.published) ? std::string() : fmt::format("{}", c.published),
                        c.passes() ? 1 : 0);
    return text;
}

void add_checks(Summary& summary, const std::vector<Check>& checks) {
    std::map<std::string, double> worst;
    std::size_t failing = 0;
    for (const Check& c : checks) {
        failing += c.passes() ? 0u : 1u;
        const double share = share_of_tolerance(c);
        double& most = worst[c.group];
        most = std::isnan(share) ? share : std::max(most, share);
    }
    summary.add("checks", checks.size());
    summary.add("failing", failing);
    for (const auto& [group, share] : worst) summary.add(group + "_error_over_tolerance", share);
}

std::string names_of_failing(const std::vector<Check>& checks) {
    std::string names;
    for (const Check& c : checks)
        if (!c.passes()) names += (names.empty() ? "" : "; ") + c.group + ": " + c.quantity;
    return names;
}

} // namespace bris
