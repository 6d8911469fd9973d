#include "scenarios/monitoring/passage_cause.hpp"

#include "engine/errors.hpp"
#include "engine/io/csv.hpp"
#include "engine/io/whole_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <sstream>
#include <vector>

namespace bris {

namespace {

double number_in(std::string_view cell, std::string_view name, const std::string& where) {
    const auto value = number_of(cell);
    require(value && std::abs(*value) < 1e300, // NaN, too
            fmt::format("{}: {}: expected a number, found '{}'", where, name, cell));
    return *value;
}

} // namespace

std::map<std::string, PassageCause> read_causes(const std::filesystem::path& csv) {
    std::map<std::string, PassageCause> causes;
    if (!std::filesystem::exists(csv)) return causes;
    std::istringstream in(read_whole(csv));
    std::vector<std::string> names;
    std::size_t number = 0;
    for (std::string line; std::getline(in, line);) {
        const std::string where = fmt::format("{}:{}", csv.string(), ++number);
        const auto cells = cells_of(line);
        if (line.starts_with('#') || (cells.size() == 1 && cells[0].empty())) continue;
        if (names.empty()) {
            names.assign(cells.begin(), cells.end());
            require(std::ranges::count(names, "passage") == 1,
                    where + ": expected names of columns with one 'passage', found '" + line + "'");
            continue;
        }
        require(cells.size() == names.size(),
                fmt::format("{}: expected {} cells, found {}", where, names.size(), cells.size()));
        PassageCause cause;
        std::string passage;
        for (std::size_t k = 0; k < names.size(); ++k) {
            if (names[k] == "passage")
                passage = cells[k];
            else if (names[k] == "condition")
                cause.condition = cells[k];
            else if (names[k] == "session")
                cause.session = cells[k];
            else if (!cells[k].empty())
                cause.numbers[names[k]] = number_in(cells[k], names[k], where);
        }
        require(causes.emplace(passage, cause).second,
                fmt::format("{}: expected each passage once, found '{}' again", where, passage));
    }
    return causes;
}

} // namespace bris
