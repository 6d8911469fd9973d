#include "scenarios/verification/table.hpp"

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

std::string table_of(const std::vector<Check>& checks) {
    std::size_t widest = 8;
    for (const Check& c : checks) widest = std::max(widest, c.quantity.size());
    std::string text, group;
    for (const Check& c : checks) {
        if (c.group != group) {
            group = c.group;
            text +=
                fmt::format("{}\n  {:<{}} {:>14} {:>14} {:>10} {:>10} {:>10}\n", group, "quantity",
                            widest, "expected", "found", "error", "tolerance", "others");
        }
        const auto others =
            std::isnan(c.published) ? std::string("-") : fmt::format("{:.1e}", c.published);
        text += fmt::format("  {:<{}} {:>14.7g} {:>14.7g} {:>10.2e} {:>10.1e} {:>10} {}{}\n",
                            c.quantity, widest, c.expected, c.found, c.error(), c.tolerance, others,
                            c.passes() ? "" : "FAILS ",
                            c.rule == Check::Rule::relative ? "" : word(c.rule));
    }
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
