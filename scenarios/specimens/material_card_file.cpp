#include "scenarios/specimens/material_card_file.hpp"

#include "engine/errors.hpp"
#include "engine/io/csv.hpp"

#include <fmt/format.h>

#include <cmath>
#include <string>
#include <vector>

namespace bris {

namespace {

/// Calls visit(column name, number, largest value) for each number of a card.
void visit_numbers(auto& card, auto&& visit) {
    const auto band = [&](const std::string& name, const std::string& unit, auto& n, double most) {
        visit(name + unit, n.value, most);
        visit(name + "_low" + unit, n.low, most);
        visit(name + "_high" + unit, n.high, most);
    };
    band("friction", "", card.friction, 100);
    band("clump_stiffness", "_N_per_m", card.clump_stiffness, 1e15);
    band("core_porosity", "", card.core_porosity, 1);
}

} // namespace

void write_material_card(const std::filesystem::path& csv, const MaterialCard& card) {
    std::vector<std::string> names;
    std::vector<double> row;
    visit_numbers(card, [&](const std::string& name, double number, double) {
        names.push_back(name);
        row.push_back(number);
    });
    write_csv(csv, names, {row},
              {"properties of rocks estimated from a test by material_card, with the ends of their "
               "90 % bands"},
              6);
}

MaterialCard read_material_card(const std::filesystem::path& csv) {
    const CsvTable table = read_csv(csv);
    require(table.rows.size() == 1,
            fmt::format("{}: expected a material card with one row of numbers, found {} rows",
                        csv.string(), table.rows.size()));
    MaterialCard card;
    visit_numbers(card, [&](const std::string& name, double& number, double most) {
        number = table.column(name).front();
        require(std::isfinite(number) && number > 0 && number <= most,
                fmt::format("{}:{}: {}: expected a number above 0 and at most {:g}, found {}",
                            csv.string(), table.lines.front(), name, most, number));
    });
    return card;
}

} // namespace bris
