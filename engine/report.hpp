#pragma once

#include "engine/scenario.hpp"
#include "engine/summary.hpp"

#include <string>
#include <string_view>
#include <vector>

namespace bris {

/// A summary that also says what of it the person sees who has started the run: rows of a table,
/// and sentences that say how far they can be trusted.
class Report : public Summary {
public:
    /// Appends the results of a part of the run, as those of one pressure, with `name` in front of
    /// their keys. The rows that the part shows become a column of this name. Without a name they
    /// are results of the whole run.
    void add_part(const std::string& name, const Report& part);

    /// Shows entries that were added, in this order: `peak_q_Pa` as "peak q  284 kPa", with the
    /// band of `peak_q_low_Pa` and `peak_q_high_Pa` if there is one. A report that shows no entry
    /// shows all of them.
    void show(const std::vector<std::string>& keys);
    /// A row that is only shown.
    void show_row(const std::string& words, const std::string& text) {
        rows_.push_back({words, {text}});
    }
    /// A sentence below the table, or one on each line of a text.
    void show_sentence(std::string_view text);

    /// All that is shown: rows of cells, of which the first ones are words, and sentences. The
    /// first row of parts has their names, or else what is shown of them; no part: no row.
    using Table = std::vector<std::vector<std::string>>;
    Table table_of_parts() const;
    Table table_of_whole() const;
    const std::vector<std::string>& sentences() const { return sentences_; }

    /// What is shown, in at most `most_lines` lines: the title, the table, sentences, and the last
    /// line. What does not fit is left out, and a line says so.
    std::string text(const std::string& title, const std::string& last) const;
    static constexpr std::size_t most_lines = 25;

private:
    struct Row {
        std::string words;
        std::vector<std::string> cells;
    };
    const NamedValue* find(const std::string& key) const;
    std::string shown_with_band(const NamedValue& entry) const;

    std::vector<std::string> parts_; ///< names of the columns
    std::vector<Row> rows_of_parts_; ///< cells of parts at the end may be missing
    std::vector<Row> rows_;          ///< of the whole run, with one cell
    std::vector<std::string> sentences_;
};

/// A number with three significant digits, as "1.23", "0.0123", "12300" and "1.2e-07"; "-" if it is
/// not known (NaN). A unit that takes prefixes has the one that makes the number short: "284 kPa".
std::string three_digits(double x, const std::string& unit = "");
/// The same with a band: "284 (251 to 317) kPa".
std::string three_digits(double x, double low, double high, const std::string& unit = "");

/// Writes the results (write_results) and their page (write_run_page), and prints what the report
/// shows under the command as it was typed, with a closing line that says where all results are.
/// Called when all other files are written: it is all that a run prints to stdout. Throws
/// OutputError.
void report_results(const Common& common, const Report& results);
/// Prints to stderr, unless the run is quiet, what was found so far.
void report_news(const Common& common, const std::string& text);

} // namespace bris
