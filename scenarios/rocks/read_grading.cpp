#include "engine/errors.hpp"
#include "engine/io/csv.hpp"
#include "engine/io/text_table.hpp"
#include "scenarios/rocks/grading.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

namespace bris {
namespace {

/// A grading with the line of the file of each sieve, and how the file was read.
struct Draft {
    const TextTable& table;
    Grading grading;
    std::vector<int> lines = {};
    std::vector<std::string> notes = {};
};

double metres_per(const TextTable& table, std::size_t column) {
    constexpr std::array<std::pair<std::string_view, double>, 9> units{{{"", 1e-3},
                                                                        {"mm", 1e-3},
                                                                        {"cm", 1e-2},
                                                                        {"m", 1},
                                                                        {"um", 1e-6},
                                                                        {"\u00b5m", 1e-6},
                                                                        {"\u03bcm", 1e-6},
                                                                        {"in", 0.0254},
                                                                        {"inch", 0.0254}}};
    const auto& [title, name, unit] = table.columns[column];
    const auto found = std::ranges::find(units, unit, &std::pair<std::string_view, double>::first);
    require(found != units.end(),
            fmt::format("{}: column '{}': expected mm, cm, m, um or in, found the unit '{}'",
                        table.path.string(), title, unit));
    return found->second;
}

/// Factor from the numbers of a column to mass fractions: as its title states, else by their size.
double fraction_per(const TextTable& table, std::size_t column, Draft& draft) {
    const auto& [title, name, unit] = table.columns[column];
    for (const char* percent : {"%", "percent", "pct", "wt%", "% mass", "mass %"})
        if (unit == percent) return 0.01;
    for (const char* fraction : {"1", "-", "fraction"})
        if (unit == fraction) return 1;
    require(unit.empty(), fmt::format("{}: column '{}': expected percent or a fraction of the "
                                      "mass, found the unit '{}'",
                                      table.path.string(), title, unit));
    double most = 0;
    for (std::size_t row = 0; row < table.rows.size(); ++row)
        most = std::max(most, table.number(row, column)); // NaN changes nothing
    require(most <= 1.01 || most >= 5,
            fmt::format("{}: column '{}': expected the unit in the title, as '{} [%]', found "
                        "numbers up to {:g}, which may be percent or fractions",
                        table.path.string(), title, title, most));
    draft.notes.push_back(
        fmt::format("'{}' as {}", title, most >= 5 ? "percent" : "fractions of the mass"));
    return most >= 5 ? 0.01 : 1;
}

/// What is finer than the finest sieve stands in a row of its own.
bool is_pan(const std::string& cell) {
    return cell == "pan" || cell == "Pan" || cell == "PAN" || cell == "tray" || cell == "0";
}

/// Rows of sieves, from coarse to fine; the pan is not among them.
std::vector<std::size_t> rows_of_sieves(std::size_t size, Draft& draft) {
    const TextTable& table = draft.table;
    std::vector<std::size_t> rows;
    for (std::size_t row = 0; row < table.rows.size(); ++row)
        if (!is_pan(table.rows[row][size])) rows.push_back(row);
    const auto descends = [&](std::size_t a, std::size_t b) {
        return table.number(a, size) > table.number(b, size);
    };
    const auto ascends = [&](std::size_t a, std::size_t b) { return descends(b, a); };
    const auto never = [&](auto follows) { // two neighbours that are not in this order
        return std::ranges::adjacent_find(
            rows, [&](std::size_t a, std::size_t b) { return !follows(a, b); });
    };
    if (rows.size() > 1 && never(ascends) == rows.end()) {
        std::ranges::reverse(rows);
        draft.notes.push_back("sieves from fine to coarse");
    } else if (const auto at = never(descends); rows.size() > 1 && at != rows.end()) {
        throw InputError(fmt::format("{}: sieve: expected sizes that decrease, or increase, from "
                                     "line to line, found {} after {}",
                                     table.where(*(at + 1)), table.rows[*(at + 1)][size],
                                     table.rows[*at][size]));
    }
    return rows;
}

/// Mass fraction that passes each sieve, by what each one retains: of the whole mass alone, or
/// together with all coarser ones.
std::vector<double> passing_by_retained(std::size_t size, std::size_t column,
                                        const std::vector<std::size_t>& rows, Draft& draft) {
    const TextTable& table = draft.table;
    const auto& [title, name, unit] = table.columns[column];
    const double factor = fraction_per(table, column, draft);
    double sum = 0, pan = 0;
    bool grows = true;
    for (std::size_t row = 0; row < table.rows.size(); ++row)
        if (is_pan(table.rows[row][size])) pan += factor * table.number(row, column);
    for (std::size_t k = 0; k < rows.size(); ++k) {
        const double here = factor * table.number(rows[k], column);
        require(here >= 0, fmt::format("{}: column '{}': expected a share of at least 0, found {}",
                                       table.where(rows[k]), title, table.rows[rows[k]][column]));
        grows = grows && (k == 0 || here >= factor * table.number(rows[k - 1], column));
        sum += here;
    }
    const bool complete = std::abs(sum + pan - 1) < 0.01;
    const bool is_cumulative =
        table.columns[column].is_named({"cum", "total"}) || (grows && sum > 1.01);
    require(is_cumulative || complete || (!grows && sum <= 1.01 && pan == 0),
            fmt::format("{}: column '{}': expected shares that add up to 100 %, or a title with "
                        "the word cumulative, found {:.1f} %",
                        table.path.string(), title, 100 * (sum + pan)));
    draft.notes.push_back(fmt::format("'{}' as retained on each sieve{}", title,
                                      is_cumulative ? " and all coarser ones" : ""));
    std::vector<double> passing;
    double retained = 0;
    for (const std::size_t row : rows) {
        const double here = factor * table.number(row, column);
        retained = is_cumulative ? here : retained + here;
        passing.push_back(std::max(0.0, 1 - retained));
    }
    return passing;
}

void read_limits(std::size_t size, std::size_t lower, std::size_t upper, Draft& draft) {
    const TextTable& table = draft.table;
    const double metres = metres_per(table, size);
    const std::array factor{fraction_per(table, lower, draft), fraction_per(table, upper, draft)};
    for (const std::size_t row : rows_of_sieves(size, draft)) {
        const Sieve sieve{metres * table.number(row, size), factor[0] * table.number(row, lower),
                          factor[1] * table.number(row, upper)};
        if (std::isnan(sieve.lower) && std::isnan(sieve.upper)) continue;
        draft.grading.sieves.push_back(sieve);
        draft.lines.push_back(table.lines[row]);
    }
}

/// One column for all sieves: what passes them, or what they retain. Two such columns must agree.
void read_shares(std::size_t size, Draft& draft) {
    const TextTable& table = draft.table;
    const double metres = metres_per(table, size);
    const auto passing = table.find({"pass", "finer"}), retained = table.find({"retain"});
    if (!passing && !retained) { // refused, with the titles that there are
        (void)table.column("lower_percent", {"lower", "min"});
        (void)table.column("upper_percent", {"upper", "max"});
    }
    const std::vector<std::size_t> rows = rows_of_sieves(size, draft);
    std::vector<double> by_retained, shares;
    if (passing) {
        const double factor = fraction_per(table, *passing, draft);
        for (const std::size_t row : rows) shares.push_back(factor * table.number(row, *passing));
        draft.notes.push_back(fmt::format("'{}' as passing", table.columns[*passing].title));
    }
    if (retained) by_retained = passing_by_retained(size, *retained, rows, draft);
    for (std::size_t k = 0; k < rows.size(); ++k) {
        const double share = passing ? shares[k] : by_retained[k];
        if (std::isnan(share)) continue;
        require(!passing || !retained || std::abs(share - by_retained[k]) < 0.015,
                fmt::format("{}: expected the same from passing and retained masses, found {:.1f} "
                            "and {:.1f} % passing",
                            table.where(rows[k]), 100 * share,
                            retained ? 100 * by_retained[k] : 0));
        draft.grading.sieves.push_back({metres * table.number(rows[k], size), share, share});
        draft.lines.push_back(table.lines[rows[k]]);
    }
}

void check_rows(const Draft& draft) {
    const Grading& grading = draft.grading;
    const std::string path = draft.table.path.string();
    // of two sieves, the one on the later line is at fault
    const auto refuse = [&](std::size_t k, const std::string& what) {
        const int line = std::max(draft.lines[k], draft.lines[k > 0 ? k - 1 : 0]);
        throw InputError(fmt::format("{}:{}: {}", path, line, what));
    };
    constexpr double least_coarse = 1e-4, most_coarse = 2; // m, of gradings of grains
    constexpr double widest = 1e4;                         // ratio of sieves
    for (std::size_t k = 0; k < grading.sieves.size(); ++k) {
        const Sieve& sieve = grading.sieves[k];
        if (!(sieve.size > 0 && std::isfinite(sieve.size)))
            refuse(k, "sieve: expected a positive size");
        const double coarsest = grading.sieves.front().size;
        if (k == 0 && !(coarsest >= least_coarse && coarsest <= most_coarse))
            refuse(k, fmt::format("sieve: expected {:g} to {:g} mm for the coarsest sieve, found "
                                  "{:.4g} mm: is it in another unit?",
                                  1e3 * least_coarse, 1e3 * most_coarse, 1e3 * coarsest));
        if (sieve.size * widest < coarsest)
            refuse(k, fmt::format("sieve: expected at least 1/{:g} of the coarsest sieve, found "
                                  "{:.4g} mm",
                                  widest, 1e3 * sieve.size));
        if (std::isnan(sieve.lower) != std::isnan(sieve.upper))
            refuse(k, "limits: expected two numbers, or - in both columns, found one of each");
        if (!(sieve.lower >= 0 && sieve.upper <= 1 && sieve.lower <= sieve.upper))
            refuse(k, fmt::format("limits: expected 0 <= lower <= upper <= 100, found {} and {}",
                                  100 * sieve.lower, 100 * sieve.upper));
        if (k == 0) continue;
        const Sieve& coarser = grading.sieves[k - 1];
        if (sieve.lower > coarser.lower || sieve.upper > coarser.upper)
            refuse(k, "limits: expected them not to increase towards finer sieves");
    }
    require(grading.sieves.size() >= 2, path + ":1: expected at least two sieves with limits");
    if (grading.sieves.back().lower == 1)
        refuse(grading.sieves.size() - 1,
               "limits: expected less than 100 % to pass the finest sieve with limits");
    constexpr double least = 0.8;
    if (grading.sieves.front().middle() < least)
        refuse(0, fmt::format("expected at least {:g} % to pass the coarsest sieve, found {:g} %",
                              100 * least, 100 * grading.sieves.front().middle()));
}

/// Where the coarsest sieve retains something, the curve goes on straight to the size that all
/// passes, at most twice that of the sieve.
void complete_curve(Draft& draft) {
    std::vector<Sieve>& sieves = draft.grading.sieves;
    const Sieve coarsest = sieves[0], next = sieves[1];
    const double rest = 1 - coarsest.middle(), step = coarsest.middle() - next.middle();
    if (rest <= 0) return;
    const double steps = step > 0 ? rest / step : std::numeric_limits<double>::infinity();
    const double size = coarsest.size * std::min(2.0, std::pow(coarsest.size / next.size, steps));
    draft.notes.push_back(fmt::format("{:.1f} % retained on the coarsest sieve as rocks of up to "
                                      "{:.1f} mm",
                                      100 * rest, 1e3 * size));
    sieves.insert(sieves.begin(), {size, 1, 1});
}

} // namespace

Grading read_grading(const std::filesystem::path& path) {
    const TextTable table = read_text_table(path);
    Draft draft{.table = table, .grading = {.name = path.stem().string(), .sieves = {}}};
    if (!table.separators().empty()) draft.notes.push_back(table.separators());
    const std::size_t size =
        table.column("sieve_mm", {"sieve", "size", "opening", "aperture", "diameter"},
                     {"pass", "retain", "lower", "upper"});
    const auto lower = table.find({"lower", "min"}), upper = table.find({"upper", "max"});
    if (lower && upper)
        read_limits(size, *lower, *upper, draft);
    else
        read_shares(size, draft);
    check_rows(draft);
    complete_curve(draft);
    std::string& how = draft.grading.read_as;
    for (const std::string& note : draft.notes) how += (how.empty() ? "" : ", ") + note;
    return draft.grading;
}

} // namespace bris
