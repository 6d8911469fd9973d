#pragma once

#include "engine/report.hpp"
#include "scenarios/ballast_box/load_turns.hpp"
#include "scenarios/forecast/passage_forecast.hpp"

#include <string>
#include <vector>

namespace bris {

/// What is shown of a forecast.
struct ForecastResults {
    std::vector<std::string> names; ///< of the sensor rocks
    std::size_t rock = 0;           ///< the one whose deflection is judged
    double threshold = 0;           ///< m, of its deflection
    std::vector<MemberMovements> members = {};
    PassageForecast forecast = {};
    std::vector<LeftOutMember> left_out = {};     ///< members, each from all others
    std::optional<PassageMovements> found = {};   ///< on a simulated site
    std::vector<JudgedRecording> recordings = {}; ///< of a folder; empty: compliances were given
    std::vector<double> last_turns = {},
                        next_turns = {}; ///< N, of the load on a tie by both trains
};

/// The verdict in one sentence. Further lines: how many recordings were used, if some were left
/// out; that the rock was not recorded or its recording left out; that its recorded compliance lies
/// outside those of the members, so that the forecast extrapolates.
std::string sentence_of(const ForecastResults& results);

/// How well each recording fits the train, and how many are used. Forecasts of all rocks and the
/// tie, what was found on a simulated site, and how many members lie in the 90 % bands that follow
/// from all others.
void add_forecast(Report& summary, const ForecastResults& results);

/// A CSV file of probabilities for thresholds of 0.1 to 3 mm: by the forecast, by the members
/// without any recording, and the share of members above the threshold under the recorded train.
void write_probabilities(const std::filesystem::path& csv, const ForecastResults& results);

/// Loads of both trains, members with the forecast, and the probability of exceeding any threshold.
void draw_forecast(const std::filesystem::path& png, const ForecastResults& results);

} // namespace bris
