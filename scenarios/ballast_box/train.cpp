#include "scenarios/ballast_box/train.hpp"

#include "engine/assets.hpp"
#include "engine/errors.hpp"
#include "engine/io/text_table.hpp"
#include "engine/message.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
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

double RailOnTies::reach() const { return 12 / wave_number(); } // sqrt(2) exp(-12) = 9e-6

std::size_t RailOnTies::ties_on_each_side() const {
    return static_cast<std::size_t>(std::ceil(reach() / spacing));
}

TrackRail RailOnTies::rail(double of_rails, double gap) const {
    const std::size_t side = ties_on_each_side(), n = 2 * side + 1;
    std::vector<double> at;
    for (std::size_t k = 0; k < n; ++k)
        at.push_back(spacing * (static_cast<double>(k) - static_cast<double>(side)));
    std::vector<TieSupport> supports(n, {.stiffness = tie_support});
    supports[side].gap = gap;
    return {std::move(at), std::move(supports), bending, of_rails + tie_weight};
}

InfluenceLine RailOnTies::influence() const { return rail(0).influence_on(ties_on_each_side()); }

double RailOnTies::stiffness_without_tie() const {
    return rail(0).stiffness_without(ties_on_each_side());
}

double passing_time(const Train& train, double speed, const RailOnTies& rails) {
    return (train.length() + 2 * rails.reach()) / speed;
}

LoadHistory history_of_passage(const Train& train, double speed, const RailOnTies& rails,
                               const std::function<double(std::span<const RailLoad>)>& force) {
    constexpr double interval = 1e-3; // s
    const double duration = passing_time(train, speed, rails);
    const auto intervals = static_cast<std::size_t>(std::ceil(duration / interval));
    LoadHistory history;
    std::vector<RailLoad> axles(train.axles.size());
    for (std::size_t k = 0; k <= intervals; ++k) {
        const double time = duration * static_cast<double>(k) / static_cast<double>(intervals);
        for (std::size_t i = 0; i < axles.size(); ++i)
            axles[i] = {speed * time - rails.reach() - train.axles[i].behind, train.axles[i].load};
        history.times.push_back(time);
        history.values.push_back(force(axles));
    }
    return history;
}

LoadHistory passing_load(const Train& train, double speed, const RailOnTies& rails,
                         double dead_load) {
    TrackRail rail = rails.rail(dead_load);
    return history_of_passage(train, speed, rails, [&](std::span<const RailLoad> axles) {
        return rail.under(axles).reactions[rails.ties_on_each_side()] - rails.tie_weight;
    });
}

} // namespace bris
