#pragma once

#include "engine/summary.hpp"
#include "tests/verification/check.hpp"

#include <vector>

namespace bris {

/// The checks with the largest error over tolerance, at most `most` of them, the largest first.
std::vector<Check> closest_to_tolerance(std::vector<Check> checks, std::size_t most);
/// A table with one line for each check: group, quantity, expected, found, error, tolerance,
/// verdict.
std::string table_of(const std::vector<Check>& checks);
/// The same table as CSV with a header. Numbers read back to the same bits.
std::string csv_of(const std::vector<Check>& checks);
/// Adds the numbers of checks and of failures, and the largest error over tolerance of each group.
void add_checks(Summary& summary, const std::vector<Check>& checks);
/// The failing checks as "group: quantity; ...". Empty if all pass.
std::string names_of_failing(const std::vector<Check>& checks);

} // namespace bris
