#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace bris {

/// A table of numbers read from text: comma-separated, one header line with the column names
/// (units in the name, as `radius_mm`), lines starting with '#' are comments.
struct CsvTable {
    std::filesystem::path path;
    std::vector<std::string> names;
    std::vector<std::vector<double>> rows;
    std::vector<int> lines; ///< line number in the file of each row, counted from 1

    /// Values of the named column. Throws InputError naming the file and the columns it has.
    std::vector<double> column(const std::string& name) const;
    bool has(const std::string& name) const;
};

/// A column that is wanted of a file, under a name and in a unit of ours: scale * what it has +
/// offset.
struct CsvColumn {
    std::string ours, theirs;
    std::string unit = ""; ///< of theirs, as given; "": ours
    double scale = 1, offset = 0;
    std::string where = ""; ///< file:line that asks for it
};

/// How a CSV file is written.
struct CsvForm {
    char delimiter = ','; ///< ' ': blanks and tabs, any number of them
    char comment = '#';   ///< begins lines that are none of the table
    char decimal = '.';
    unsigned header_line = 0,
             first_line =
                 0; ///< of names and of the first numbers, from 1; 0: the first line, and the next
    std::vector<CsvColumn> columns =
        {}; ///< those wanted, all others are let be; none: all, as they are named

    const CsvColumn* find(const std::string& ours) const; ///< null: not wanted
};

/// Without blanks, tabs and the sign that ends lines elsewhere, at either end.
std::string_view trimmed(std::string_view text);
/// Names as messages list them, with commas between.
std::string listed(const std::vector<std::string>& names);
/// The cells of a line, without blanks or quotes around them; a delimiter between quotes is none.
std::vector<std::string_view> cells_of(std::string_view line, char delimiter = ',');
/// A cell as a number, NaN if it is empty or "-"; nothing if it is not one.
std::optional<double> number_of(std::string_view cell);

/// Reads a CSV file. An empty cell or "-" becomes NaN. Throws InputError with file:line, what was
/// expected and what was found; OutputError if the file cannot be read.
CsvTable read_csv(const std::filesystem::path& path, const CsvForm& form = {});

/// Writes a CSV file with `digits` significant digits (default: exact round trip), as a new file
/// that replaces the old one only when complete. Comments stand before the header, each with "# ".
/// Throws OutputError.
void write_csv(const std::filesystem::path& path, const std::vector<std::string>& names,
               const std::vector<std::vector<double>>& rows,
               const std::vector<std::string>& comments = {}, int digits = 17);

} // namespace bris
