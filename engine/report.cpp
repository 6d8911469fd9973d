#include "engine/report.hpp"

#include "engine/errors.hpp"
#include "engine/message.hpp"
#include "engine/printable.hpp"
#include "engine/run_page.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <sstream>
#include <stdexcept>

namespace bris {

namespace {

/// A unit as it ends a key, and as it is shown.
struct Unit {
    const char *in_key, *shown;
};
// longer endings first
constexpr std::array units{Unit{"_kg_per_m3", "kg/m3"},
                           Unit{"_rad_per_s", "rad/s"},
                           Unit{"_kN_per_mm", "kN/mm"},
                           Unit{"_um_per_kN", "um/kN"},
                           Unit{"_m_per_s2", "m/s2"},
                           Unit{"_N_per_m", "N/m"},
                           Unit{"_m_per_s", "m/s"},
                           Unit{"_degrees", "deg"},
                           Unit{"_percent", "%"},
                           Unit{"_per_s", "1/s"},
                           Unit{"_days", "days"},
                           Unit{"_MiB", "MiB"},
                           Unit{"_kPa", "kPa"},
                           Unit{"_rad", "rad"},
                           Unit{"_deg", "deg"},
                           Unit{"_kN", "kN"},
                           Unit{"_mm", "mm"},
                           Unit{"_Hz", "Hz"},
                           Unit{"_m3", "m3"},
                           Unit{"_Pa", "Pa"},
                           Unit{"_kg", "kg"},
                           Unit{"_h", "h"},
                           Unit{"_N", "N"},
                           Unit{"_J", "J"},
                           Unit{"_s", "s"},
                           Unit{"_m", "m"}};
constexpr std::array with_prefixes{"Pa", "N/m", "Hz", "N", "J", "s", "m"};

/// A key without its unit, and the unit.
struct KeyParts {
    std::string name, in_key, unit;
};

KeyParts parts_of(const std::string& key) {
    for (const Unit& u : units)
        if (key.ends_with(u.in_key))
            return {key.substr(0, key.size() - std::string(u.in_key).size()), u.in_key, u.shown};
    return {key, "", ""};
}

/// Factor of a number and prefix of its unit.
struct Prefix {
    double factor = 1;
    const char* letter = "";
};

Prefix prefix_for(double x, const std::string& unit) {
    if (std::ranges::find(with_prefixes, unit) == with_prefixes.end() || !std::isfinite(x))
        return {};
    const double size = std::abs(x);
    if (unit != "s") // hours of computing stay seconds
        for (const Prefix& p : {Prefix{1e-9, "G"}, {1e-6, "M"}, {1e-3, "k"}})
            if (size * p.factor >= 0.9995) return p;
    if (size == 0 || size >= 0.09995) return {};
    for (const Prefix& p : {Prefix{1e3, "m"}, {1e6, "u"}})
        if (size * p.factor >= 0.9995) return p;
    return size >= 1e-10 ? Prefix{1e9, "n"} : Prefix{};
}

std::string digits(double x) {
    if (std::isnan(x)) return "-";
    if (x == 0) return "0"; // also a negative one
    if (std::abs(x) < 999.5 || std::abs(x) >= 1e7) return fmt::format("{:.3g}", x);
    const double unit = std::pow(10, std::floor(std::log10(std::abs(x))) - 2);
    return fmt::format("{:.0f}", std::round(x / unit) * unit);
}

std::string shown(bool x, const std::string&) { return x ? "yes" : "no"; }
std::string shown(double x, const std::string& unit) { return three_digits(x, unit); }
std::string shown(const std::string& x, const std::string&) { return x.empty() ? "none" : x; }
std::string shown(std::integral auto x, const std::string& unit) {
    return fmt::format("{}{}{}", x, unit.empty() ? "" : " ", unit);
}

std::string in_words(std::string key) {
    std::ranges::replace(key, '_', ' ');
    return key;
}

/// With more parts, each of them is a line.
constexpr std::size_t most_columns = 5;

template <class Row>
std::vector<Row> transposed(const std::vector<Row>& rows) {
    std::vector<Row> turned{{"", {}}};
    for (const std::string& part : rows.front().cells) turned.push_back({part, {}});
    for (std::size_t r = 1; r < rows.size(); ++r) {
        turned.front().cells.push_back(rows[r].words);
        for (std::size_t c = 0; c < rows[r].cells.size(); ++c)
            turned[c + 1].cells.resize(r, "-"), turned[c + 1].cells[r - 1] = rows[r].cells[c];
    }
    return turned;
}

template <class Row>
Report::Table texts_of(const std::vector<Row>& rows) {
    Report::Table table;
    for (const Row& row : rows) {
        table.push_back({row.words});
        for (const std::string& cell : row.cells) table.back().push_back(printable(cell));
    }
    return table;
}

/// A line for each row, with cells below each other. Cells of the whole run stand alone: they do
/// not widen columns.
std::vector<std::string> in_columns(const Report::Table& parts, const Report::Table& whole) {
    std::vector<std::size_t> widths(2);
    const auto widen = [&](const std::string& cell, std::size_t column) {
        widths.resize(std::max(widths.size(), column + 1));
        widths[column] = std::max(widths[column], cell.size());
    };
    for (const auto& row : parts)
        for (std::size_t c = 0; c < row.size(); ++c) widen(row[c], c);
    for (const auto& row : whole) widen(row.front(), 0);
    std::vector<std::string> lines;
    Report::Table rows = parts;
    rows.insert(rows.end(), whole.begin(), whole.end());
    for (const auto& row : rows) {
        std::string line;
        for (std::size_t c = 0; c < row.size(); ++c)
            line += fmt::format("  {:<{}}", row[c], widths[c]);
        lines.push_back(line.substr(0, line.find_last_not_of(' ') + 1));
    }
    return lines;
}

} // namespace

std::string three_digits(double x, const std::string& unit) {
    if (std::isnan(x)) return "-";
    const Prefix p = prefix_for(x, unit);
    return fmt::format("{}{}{}{}", digits(p.factor * x), unit.empty() ? "" : " ", p.letter, unit);
}

std::string three_digits(double x, double low, double high, const std::string& unit) {
    const Prefix p = prefix_for(x, unit);
    return fmt::format("{} ({} to {}){}{}{}", digits(p.factor * x), digits(p.factor * low),
                       digits(p.factor * high), unit.empty() ? "" : " ", p.letter, unit);
}

const NamedValue* Report::find(const std::string& key) const {
    const auto found = std::ranges::find(entries(), key, &NamedValue::key);
    return found == entries().end() ? nullptr : &*found;
}

void Report::add_part(const std::string& name, const Report& part) {
    for (NamedValue entry : part.entries()) {
        if (!name.empty()) entry.key = fmt::format("{}_{}", name, entry.key);
        add(entry);
    }
    if (name.empty()) {
        rows_.insert(rows_.end(), part.rows_.begin(), part.rows_.end());
        sentences_.insert(sentences_.end(), part.sentences_.begin(), part.sentences_.end());
        return;
    }
    parts_.push_back(in_words(name));
    for (const Row& row : part.rows_) {
        auto mine = std::ranges::find(rows_of_parts_, row.words, &Row::words);
        if (mine == rows_of_parts_.end())
            mine = rows_of_parts_.insert(rows_of_parts_.end(), {row.words, {}});
        mine->cells.resize(parts_.size() - 1, "-");
        mine->cells.push_back(row.cells.front());
    }
    for (const std::string& sentence : part.sentences_)
        sentences_.push_back(fmt::format("{}: {}", parts_.back(), sentence));
}

std::string Report::shown_with_band(const NamedValue& entry) const {
    const KeyParts key = parts_of(entry.key);
    const std::string name = key.name.substr(0, key.name.rfind("_median"));
    const NamedValue *low = find(name + "_low" + key.in_key),
                     *high = find(name + "_high" + key.in_key);
    if (low == nullptr || high == nullptr)
        return std::visit([&](const auto& x) { return shown(x, key.unit); }, entry.value);
    return three_digits(std::get<double>(entry.value), std::get<double>(low->value),
                        std::get<double>(high->value), key.unit);
}

void Report::show_sentence(std::string_view text) {
    while (!text.empty()) {
        const auto end = std::min(text.find('\n'), text.size());
        if (end > 0) sentences_.emplace_back(text.substr(0, end));
        text.remove_prefix(std::min(end + 1, text.size()));
    }
}

void Report::show(const std::vector<std::string>& keys) {
    for (const std::string& key : keys) {
        const NamedValue* entry = find(key);
        if (entry == nullptr) throw std::logic_error("a result to show was not added: " + key);
        show_row(in_words(parts_of(key).name), shown_with_band(*entry));
    }
}

Report::Table Report::table_of_parts() const {
    std::vector<Row> rows = rows_of_parts_;
    if (!rows.empty()) rows.insert(rows.begin(), {"", parts_});
    return texts_of(parts_.size() > most_columns ? transposed(rows) : rows);
}

Report::Table Report::table_of_whole() const {
    Report all = *this;
    if (rows_.empty() && rows_of_parts_.empty())
        for (const NamedValue& entry : entries()) all.show({entry.key});
    return texts_of(all.rows_);
}

std::string Report::text(const std::string& title, const std::string& last) const {
    std::vector<std::string> lines = in_columns(table_of_parts(), table_of_whole());
    const auto cut = [](std::vector<std::string>& list, std::size_t most, const std::string& rest) {
        if (list.size() <= most) return;
        const std::size_t more = list.size() - most + 1;
        list.resize(most - 1);
        list.push_back(fmt::format("  {} more {}", more, rest));
    };
    std::vector<std::string> sentences = sentences_;
    cut(sentences, most_lines / 2, "of such lines are left out.");
    cut(lines, most_lines - 2 - sentences.size(), "in summary.json");
    std::string text = printable(title) + "\n";
    for (const std::string& line : lines) text += line + "\n";
    for (const std::string& sentence : sentences) text += printable(sentence) + "\n";
    return text + printable(last) + "\n";
}

void report_results(const Common& common, const Report& results) {
    write_results(common, results); // before printing, which fails if stdout is closed
    write_run_page(common, results);
    std::string command = common.scenario;
    for (const std::string& word : common.arguments) command += " " + word;
    const std::string text = results.text(
        command,
        fmt::format(
            "Results are in {}: report.html to read, summary.json with all numbers and settings.",
            common.out.string()));
    if (std::fwrite(text.data(), 1, text.size(), stdout) != text.size() || std::fflush(stdout) != 0)
        throw OutputError(fmt::format("cannot print the results: {}", std::strerror(errno)));
}

void report_news(const Common& common, const std::string& text) {
    if (common.quiet) return;
    std::istringstream lines(text);
    for (std::string line; std::getline(lines, line);) say(line);
}

} // namespace bris
