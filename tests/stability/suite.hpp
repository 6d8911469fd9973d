#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace bris {

/// Settings of the stress suite.
struct StressSettings {
    bool full = false; ///< long runs and many random draws, instead of sizes that take seconds
    unsigned threads = 2;
    std::uint64_t seed = 1;   ///< of every random scene
    double soak_minutes = 30; ///< length of S29 at full size
};

/// One test of a case and its result.
struct StressRow {
    std::string id;        ///< of its case, for example S6
    std::string what;      ///< what is tested
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

/// The case with an id. Throws InputError with all ids for an unknown one.
const StressCase& stress_case(std::string_view id);

/// Runs a case. If one of its scenes stops unexpectedly, the result is a single failing row.
StressRows run_case(const StressCase& which, const StressSettings& settings);

/// A table of aligned columns with one line per row.
std::string table_of(const StressRows& rows);

/// Number of failing rows.
std::size_t failures(const StressRows& rows);

} // namespace bris
