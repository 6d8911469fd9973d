#include "scenarios/network/network_settings.hpp"

#include "engine/errors.hpp"
#include "engine/io/csv.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>

namespace bris {

namespace {

struct ChangeColumn {
    const char* name;
    double InstalledRockSettings::*value;
    double low, high; // both accepted
};

constexpr std::array<ChangeColumn, 9> change_columns{
    {{"sampling_rate_Hz", &InstalledRockSettings::sampling_rate, 1, Truth::base_rate},
     {"trigger_level_m_per_s2", &InstalledRockSettings::trigger_level, 1e-3, 1e3},
     {"pre_trigger_s", &InstalledRockSettings::pre_trigger, 0, 60},
     {"post_trigger_s", &InstalledRockSettings::post_trigger, 0.1, 3600},
     {"lead_s", &InstalledRockSettings::lead, 0, 1e5},
     {"session_s", &InstalledRockSettings::session, 1, 1e5},
     {"duty_period_s", &InstalledRockSettings::duty_period, 1, 1e6},
     {"duty_on_s", &InstalledRockSettings::duty_on, 0.1, 1e6},
     {"warning_threshold_m_per_s2", &InstalledRockSettings::warning_threshold, 1e-3, 1e3}}};

/// From a cell of a table; empty: no change.
std::optional<Strategy> strategy_of(double value, const std::string& at) {
    if (std::isnan(value)) return std::nullopt;
    require(value == std::round(value) && value >= 0 && value <= 3,
            fmt::format("{}strategy: expected 0, 1, 2 or 3, found {:g}", at, value));
    return static_cast<Strategy>(value);
}

} // namespace

const char* name_of(Strategy strategy) {
    constexpr std::array names{"continuous", "scheduled", "triggered", "duty_cycled"};
    return names[static_cast<std::size_t>(strategy)];
}

void check_rock_settings(const InstalledRockSettings& s, const std::string& where) {
    require_sampling_rate(s.sampling_rate, where + "sampling rate");
    require(s.duty_on < s.duty_period,
            fmt::format("{}duty cycle: expected sampling for less than the period of {:g} s, found "
                        "{:g} s",
                        where, s.duty_period, s.duty_on));
}

std::vector<SettingsChange> read_changes(const std::filesystem::path& csv, unsigned rocks) {
    const CsvTable table = read_csv(csv);
    const auto times = table.column("t_s"), of_rocks = table.column("rock");
    for (const std::string& name : table.names) {
        bool known = name == "t_s" || name == "rock" || name == "strategy";
        for (const ChangeColumn& column : change_columns) known = known || name == column.name;
        require(known, fmt::format("{}: expected the name of a setting, found column '{}'",
                                   csv.string(), name));
    }
    std::vector<SettingsChange> changes;
    for (std::size_t row = 0; row < table.rows.size(); ++row) {
        const std::string at = fmt::format("{}:{}: ", csv.string(), table.lines[row]);
        require(std::isfinite(times[row]) && times[row] >= 0,
                fmt::format("{}t_s: expected a time from 0 on, found {:g}", at, times[row]));
        const double rock = of_rocks[row];
        require(rock == std::round(rock) && rock >= 0 && rock <= rocks,
                fmt::format("{}rock: expected 0 (all) or a number up to {}, found {:g}", at, rocks,
                            rock));
        SettingsChange change{.time = times[row],
                              .rock = rock > 0 ? static_cast<EntityId>(rock) - 1 : 0,
                              .all = rock == 0};
        if (table.has("strategy")) change.strategy = strategy_of(table.column("strategy")[row], at);
        for (const ChangeColumn& column : change_columns) {
            if (!table.has(column.name)) continue;
            const double value = table.column(column.name)[row];
            if (std::isnan(value)) continue;
            require(value >= column.low && value <= column.high,
                    fmt::format("{}{}: expected {:g} to {:g}, found {:g}", at, column.name,
                                column.low, column.high, value));
            if (column.value == &InstalledRockSettings::sampling_rate)
                require_sampling_rate(value, at + column.name);
            change.values.emplace_back(column.value, value);
        }
        require(change.strategy || !change.values.empty(),
                at + "expected at least one setting to change, found none");
        changes.push_back(std::move(change));
    }
    return changes;
}

} // namespace bris
