#pragma once

#include "scenarios/records/logger_table.hpp"

#include <string>
#include <vector>

namespace bris {

/// What the first rows of a table hold in one column. Shares are of the rows.
struct SampledColumn {
    std::vector<double> numbers; ///< NaN: not a number, or empty
    std::vector<double> dates;   ///< s, of texts that are dates or times of day; NaN: none
    double share_of_numbers = 0, share_of_dates = 0, share_of_days = 0, share_of_times = 0,
           share_of_names = 0; ///< days: dates alone; times: of day alone
    std::size_t texts = 0;     ///< number of different texts that are no numbers or dates, to 200

    bool has_numbers() const { return share_of_numbers >= 0.5; }
};

/// The first rows of all columns.
std::vector<SampledColumn> sample_of(const LoggerTable& table);

/// Share of the steps from one finite value to the next one of the same sensor that are upwards.
/// upwards. `sensor`: of each row; empty: one for all.
double share_that_advances(const std::vector<double>& values, const std::vector<double>& sensor);

} // namespace bris
