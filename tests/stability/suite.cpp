#include "tests/stability/suite.hpp"

#include "engine/errors.hpp"
#include "tests/stability/cases.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>

namespace bris {

namespace {

constexpr std::array cases{
    StressCase{"S1", "bit-identical results with any threads, skins and order of rows",
               stress_determinism},
    StressCase{"S4", "largest stable time step", stress_step_limit},
    StressCase{"S5", "no equilibrium without load", stress_vacuous_equilibrium},
    StressCase{"S6", "energy budget", stress_energy_budget},
    StressCase{"S7", "servo of membrane and platen", stress_servo},
    StressCase{"S8", "large ratios of size and mass", stress_size_ratio},
    StressCase{"S9", "deep overlaps at the start", stress_deep_overlap},
    StressCase{"S10", "fast impacts", stress_fast_impact},
    StressCase{"S11", "faulty sensors", stress_sensors},
    StressCase{"S12", "drift over many steps", stress_long_drift},
    StressCase{"S13", "restitution and friction", stress_restitution},
    StressCase{"S14", "independence of units", stress_unit_scaling},
    StressCase{"S15", "independence of the reference frame", stress_frames},
    StressCase{"S16", "conservation of momentum", stress_momentum},
    StressCase{"S18", "sleeping grains", stress_sleeping},
    StressCase{"S20", "absurd parameters", stress_absurd_parameters},
    StressCase{"S22", "NaN in the state", stress_not_a_number},
    StressCase{"S25", "rebuilt neighbour lists", stress_lists},
    StressCase{"S27", "clumps as rigid bodies", stress_clump_dynamics},
    StressCase{"S29", "memory and open files over many scenes", stress_soak},
};

} // namespace

std::span<const StressCase> stress_cases() { return cases; }

const StressCase& stress_case(std::string_view id) {
    const auto found = std::ranges::find(cases, id, &StressCase::id);
    std::string known;
    for (const StressCase& c : cases) known += fmt::format("{}{}", known.empty() ? "" : ", ", c.id);
    require(found != cases.end(),
            fmt::format("--case: expected one of {}, found \"{}\"", known, id));
    return *found;
}

StressRows run_case(const StressCase& which, const StressSettings& settings) {
    try {
        return which.run(settings);
    } catch (const SimulationError& error) {
        return {{std::string(which.id), "the whole case", "runs to its end", error.what(), false}};
    }
}

std::string table_of(const StressRows& rows) {
    std::array<std::size_t, 3> width{};
    for (const StressRow& r : rows) {
        width[0] = std::max(width[0], r.what.size());
        width[1] = std::max(width[1], r.criterion.size());
        width[2] = std::max(width[2], r.found.size());
    }
    std::string text;
    for (const StressRow& r : rows)
        text += fmt::format("{:4} {:4}  {:{}}  {:{}}  {:{}}\n", r.pass ? "pass" : "FAIL", r.id,
                            r.what, width[0], r.criterion, width[1], r.found, width[2]);
    return text;
}

std::size_t failures(const StressRows& rows) {
    return static_cast<std::size_t>(std::ranges::count(rows, false, &StressRow::pass));
}

} // namespace bris
