#include "scenarios/ballast_box/train.hpp"

#include "engine/assets.hpp"
#include "engine/errors.hpp"
#include "engine/io/text_table.hpp"
#include "engine/message.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <string_view>
#include <utility>

namespace bris {

namespace {

using Units = std::span<const std::pair<std::string_view, double>>;

constexpr std::array<std::pair<std::string_view, double>, 4> lengths{
    {{"m", 1}, {"cm", 1e-2}, {"mm", 1e-3}, {"ft", 0.3048}}};
constexpr double pound = 4.4482216152605; // N
constexpr std::array<std::pair<std::string_view, double>, 8> forces{{{"kN", 1e3},
                                                                     {"N", 1},
                                                                     {"t", 9806.65},
                                                                     {"kg", 9.80665},
                                                                     {"kip", 1e3 * pound},
                                                                     {"kips", 1e3 * pound},
                                                                     {"lbf", pound},
                                                                     {"lb", pound}}};

/// Factor from the numbers of a column to SI, by the unit in its title.
double factor_of(const TextTable& table, std::size_t column, Units units) {
    const auto& [title, name, unit] = table.columns[column];
    const auto found = std::ranges::find(units, unit, &std::pair<std::string_view, double>::first);
    if (found != units.end()) return found->second;
    std::string known;
    for (const auto& [text, factor] : units)
        known += (known.empty() ? "" : ", ") + std::string(text);
    throw InputError(fmt::format("{}: column '{}': expected one of the units {} in the title, as "
                                 "{} [{}], found {}",
                                 table.path.string(), title, known, name, units[0].first,
                                 unit.empty() ? "none" : "'" + unit + "'"));
}

/// Whether the positions are those of the axles, or else their spacings.
bool has_positions(const TextTable& table) {
    const auto position = table.find({"position"}), spacing = table.find({"spacing"});
    require(!position || !spacing,
            fmt::format("{}: expected a column of positions or one of spacings, found both",
                        table.path.string()));
    return !spacing;
}

} // namespace

Train train_named(const std::string& name, const std::string& option) {
    constexpr double heaviest = 500e3; // N, more than any railway allows
    const TextTable table = read_text_table(asset_or_file(option, "trains", name, ".csv"));
    const bool are_positions = has_positions(table);
    const std::size_t place = are_positions ? table.column("position_m", {"position"})
                                            : table.column("spacing_m", {"spacing"}),
                      weight = table.column("axle_load_kN", {"load"}, {"wheel"});
    const double metres = factor_of(table, place, lengths),
                 newtons = factor_of(table, weight, forces);
    require(!table.rows.empty(), table.path.string() + ": expected at least one axle, found none");
    Train train{.name = name, .axles = {}};
    const std::string& title = table.columns[place].title;
    for (std::size_t k = 0; k < table.rows.size(); ++k) {
        const double found = table.number(k, place), load = newtons * table.number(k, weight);
        const auto expect = [&](bool is_met, const std::string& what, std::size_t column) {
            require(is_met, fmt::format("{}: expected {}, found {}", table.where(k), what,
                                        table.rows[k][column]));
        };
        const double before = k > 0 ? train.axles.back().behind : 0,
                     behind = metres * found + (are_positions ? 0 : before);
        expect(k > 0 || behind == 0, title + " 0 of the first axle", place);
        expect(k == 0 || behind > before,
               are_positions ? "a " + title + " greater than that of the axle before"
                             : "a " + title + " above 0",
               place);
        expect(load > 0 && load <= heaviest,
               fmt::format("a load above 0 and at most {:g} in '{}'", heaviest / newtons,
                           table.columns[weight].title),
               weight);
        train.axles.push_back({behind, load});
    }
    const std::string separators = table.separators();
    if (!separators.empty() || title != "position_m" ||
        table.columns[weight].title != "axle_load_kN")
        train.read_as =
            fmt::format("{}{}'{}' as {} of axles, '{}' as their loads", separators,
                        separators.empty() ? "" : ", ", title,
                        are_positions ? "positions" : "spacings", table.columns[weight].title);
    return train;
}

void say_how_read(const Train& train) {
    if (!train.read_as.empty())
        say(fmt::format("train {}: read with {}", train.name, train.read_as));
}

double RailOnTies::wave_number() const {
    return std::pow(tie_support / spacing / (4 * bending), 0.25);
}

double RailOnTies::share(double x) const {
    const double beta = wave_number(), phase = beta * std::abs(x);
    return 0.5 * spacing * beta * std::exp(-phase) * (std::cos(phase) + std::sin(phase));
}

double RailOnTies::stiffness_without_tie() const {
    return 2 * tie_support / (spacing * wave_number()) - tie_support;
}

double RailOnTies::reach() const { return 12 / wave_number(); } // sqrt(2) exp(-12) = 9e-6

double passing_time(const Train& train, double speed, const RailOnTies& rails) {
    return (train.length() + 2 * rails.reach()) / speed;
}

LoadHistory passing_load(const Train& train, double speed, const RailOnTies& rails,
                         double dead_load) {
    constexpr double interval = 1e-3; // s
    const double duration = passing_time(train, speed, rails);
    const auto intervals = static_cast<std::size_t>(std::ceil(duration / interval));
    LoadHistory history;
    for (std::size_t k = 0; k <= intervals; ++k) {
        const double time = duration * static_cast<double>(k) / static_cast<double>(intervals);
        double force = dead_load;
        for (const Axle& axle : train.axles)
            force += axle.load * rails.share(speed * time - rails.reach() - axle.behind);
        history.times.push_back(time);
        history.values.push_back(force);
    }
    return history;
}

} // namespace bris
