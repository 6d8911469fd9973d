#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace bris {

/// A table of numbers read from text: comma-separated, with one header line of column names (the
/// unit is part of the name, as in `radius_mm`); lines that begin with '#' are comments. Columns
/// that nobody asks for may hold anything.
struct CsvTable {
    std::filesystem::path path;
    std::vector<std::string> names;
    std::vector<std::string> titles;       ///< names in the file, which a CsvForm may replace
    std::vector<std::vector<double>> rows; ///< NaN where a cell holds no number
    std::vector<int> lines;                ///< line number of each row in the file, counted from 1
    /// By column: what is wrong with it, for whoever asks for it: two columns have its name, or a
    /// cell is not a number (the first one, with file and line).
    std::map<std::string, std::string> unusable = {};

    /// Values of a column. Throws InputError, naming the file and its columns, if there is none of
    /// that name or if it cannot be used.
    std::vector<double> column(const std::string& name) const;
    bool has(const std::string& name) const;
    /// Titles, sorted, that are not among `used`; columns without a title are left out.
    std::vector<std::string> others(const std::vector<std::string>& used) const;
};

/// A column to read from a file, under the name and in the unit of BRIS: scale * number + offset.
struct CsvColumn {
    std::string ours, theirs;
    std::string unit = ""; ///< unit in the file; "": the unit of BRIS
    double scale = 1, offset = 0;
    std::string where = ""; ///< file:line that requests the column
};

/// Format of a CSV file.
struct CsvForm {
    char delimiter = ','; ///< ' ': any number of blanks and tabs
    char comment = '#';   ///< begins a comment line
    char decimal = '.';
    /// Line of the column names and first line of numbers, counted from 1; 0: the first line that
    /// is not a comment, and the next one.
    unsigned header_line = 0, first_line = 0;
    /// Columns to read; empty: all columns, under their own names.
    std::vector<CsvColumn> columns = {};

    const CsvColumn* find(const std::string& ours) const; ///< null: not requested
};

/// The text without blanks, tabs and carriage returns at either end.
std::string_view trimmed(std::string_view text);
/// The names separated by commas, for messages.
std::string listed(const std::vector<std::string>& names);
/// The cells of a line, without surrounding blanks or quotes. A delimiter between quotes does not
/// separate cells.
std::vector<std::string_view> cells_of(std::string_view line, char delimiter = ',');
/// A cell as a number; NaN if it is empty or "-"; nothing if it is not a number.
std::optional<double> number_of(std::string_view cell);

/// Reads a CSV file in any encoding of read_text. An empty cell or "-" becomes NaN. Throws
/// InputError with file:line, what was expected and what was found; OutputError if the file cannot
/// be read.
CsvTable read_csv(const std::filesystem::path& path, const CsvForm& form = {});

/// Writes a CSV file with `digits` significant digits (default: exact round trip). The new file
/// replaces an old one only when it is complete. Comments precede the header, each after "# ".
/// Throws OutputError.
void write_csv(const std::filesystem::path& path, const std::vector<std::string>& names,
               const std::vector<std::vector<double>>& rows,
               const std::vector<std::string>& comments = {}, int digits = 17);

} // namespace bris
