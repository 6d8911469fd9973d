#pragma once

#include "engine/io/csv.hpp"
#include "engine/io/whole_file.hpp"

#include <fmt/format.h>

#include <cmath>
#include <filesystem>
#include <functional>
#include <sstream>
#include <string>
#include <vector>

namespace bris::testing {

/// A table of texts, as a spreadsheet sees it.
struct Sheet {
    using Cells = std::vector<std::string>;
    Cells names;
    std::vector<Cells> rows;

    static Sheet read(const std::filesystem::path& csv) {
        Sheet sheet;
        std::istringstream in(read_whole(csv));
        for (std::string line; std::getline(in, line);) {
            if (line.starts_with('#')) continue;
            Cells cells;
            for (const auto cell : cells_of(line)) cells.emplace_back(cell);
            if (sheet.names.empty())
                sheet.names = cells;
            else
                sheet.rows.push_back(cells);
        }
        return sheet;
    }
    std::string text() const {
        std::string text = "# \u00b5, \u00b0 and \u00b2 are no ASCII\n";
        const auto add = [&](const Cells& cells) {
            for (std::size_t k = 0; k < cells.size(); ++k) text += (k ? "," : "") + cells[k];
            text += '\n';
        };
        add(names);
        for (const Cells& row : rows) add(row);
        return text;
    }
    void insert(std::size_t column, const std::string& name, const Cells& in_turn) {
        names.insert(names.begin() + static_cast<std::ptrdiff_t>(column), name);
        for (std::size_t k = 0; k < rows.size(); ++k)
            rows[k].insert(rows[k].begin() + static_cast<std::ptrdiff_t>(column),
                           in_turn[k % in_turn.size()]);
    }
    void change(const std::function<std::string(const std::string& name, double x)>& write) {
        for (Cells& row : rows)
            for (std::size_t c = 0; c < names.size(); ++c)
                if (const auto x = number_of(row[c]); x && std::isfinite(*x))
                    row[c] = write(names[c], *x);
    }
};

/// A number rounded to single precision.
inline std::string in_single_precision(const std::string&, double x) {
    return fmt::format("{}", static_cast<double>(static_cast<float>(x)));
}

} // namespace bris::testing
