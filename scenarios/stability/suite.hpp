#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace bris {

/// How hard the engine is stressed.
struct StressSettings {
    bool full = false; ///< long runs and many draws; else sizes that take seconds
    unsigned threads = 2;
    std::uint64_t seed = 1; ///< of every random scene
};

/// One thing that was tried.
struct StressRow {
    std::string id; ///< of its case, as S6
    std::string what;
    std::string criterion; ///< what must hold
    std::string found;     ///< text, or a number with its unit
    bool pass = false;
};
using StressRows = std::vector<StressRow>;

struct StressCase {
    std::string_view id, title;
    StressRows (*run)(const StressSettings&);
};

/// All cases, in the order of their numbers.
std::span<const StressCase> stress_cases();

/// The case of an id. Throws InputError with the ids there are.
const StressCase& stress_case(std::string_view id);

/// Runs a case. Where a scene of it stops that should not, that is a row that fails.
StressRows run_case(const StressCase& which, const StressSettings& settings);

/// Aligned columns, a line per row.
std::string table_of(const StressRows& rows);

/// How many rows fail.
std::size_t failures(const StressRows& rows);

} // namespace bris
