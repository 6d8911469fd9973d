#pragma once

#include "scenarios/records/given_columns.hpp"
#include "scenarios/records/logger_columns.hpp"
#include "scenarios/records/logger_sample.hpp"

#include <string>
#include <vector>

namespace bris {

/// Chooses the column of the times among those that nobody has taken: the one that advances from
/// sample to sample, if possible one with dates, and its unit: as stated, or as dates and usual
/// sampling rates show it. Sets form, time, day and is_absolute, and marks what is taken. `sensor`:
/// of each sampled row. Throws InputError if the unit cannot be told.
void find_logged_time(const LoggerTable& table, const std::vector<SampledColumn>& sample,
                      const std::vector<double>& sensor, const GivenColumn* given,
                      LoggerColumns& columns, std::vector<char>& is_taken,
                      std::vector<std::string>& notes);

} // namespace bris
