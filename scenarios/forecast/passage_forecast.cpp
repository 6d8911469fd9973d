#include "scenarios/forecast/passage_forecast.hpp"

#include "engine/errors.hpp"

#include <algorithm>
#include <cmath>

namespace bris {

namespace {

constexpr double least_deflection = 1e-5;  // m
constexpr double least_compliance = 1e-10; // m/N

double logarithm(double value, double least) { return std::log(std::max(value, least)); }

DeflectionForecast forecast_rock(const std::vector<MemberMovements>& members, std::size_t rock,
                                 const std::optional<RecordedMovement>& recorded) {
    std::vector<double> last, next;
    for (const MemberMovements& m : members) {
        last.push_back(logarithm(m.last.rocks.at(rock).compliance, least_compliance));
        next.push_back(logarithm(m.next.rocks.at(rock).deflection, least_deflection));
    }
    DeflectionForecast forecast{.members = predict_by_mean(next), .recorded = recorded};
    forecast.logarithm =
        recorded ? predict_by_line(last, next, logarithm(recorded->compliance, least_compliance),
                                   recorded->deviation / recorded->compliance)
                 : forecast.members;
    return forecast;
}

} // namespace

double DeflectionForecast::probability_above(double deflection) const {
    return logarithm.probability_above(std::log(deflection));
}

double DeflectionForecast::quantile(double probability) const {
    return std::exp(logarithm.quantile(probability));
}

PassageForecast forecast_passage(const std::vector<MemberMovements>& members,
                                 const std::vector<RecordedMovement>& recorded) {
    require(members.size() >= 4, "forecast: expected at least 4 members");
    PassageForecast forecast;
    for (std::size_t rock = 0; rock < members.front().last.rocks.size(); ++rock) {
        const auto found = std::ranges::find(recorded, rock, &RecordedMovement::sensor);
        forecast.rocks.push_back(forecast_rock(
            members, rock, found == recorded.end() ? std::nullopt : std::optional(*found)));
    }
    std::vector<double> settlements;
    for (const MemberMovements& m : members) settlements.push_back(m.next.tie.settlement);
    forecast.settlement = predict_by_mean(settlements);
    return forecast;
}

std::vector<LeftOutMember> forecasts_of_members(const std::vector<MemberMovements>& members,
                                                std::size_t rock, double relative) {
    std::vector<LeftOutMember> all;
    for (std::size_t k = 0; k < members.size(); ++k) {
        std::vector<MemberMovements> others = members;
        others.erase(others.begin() + static_cast<std::ptrdiff_t>(k));
        const double compliance =
            std::max(members[k].last.rocks.at(rock).compliance, least_compliance);
        all.push_back({members[k].next.rocks.at(rock).deflection,
                       forecast_rock(others, rock,
                                     RecordedMovement{rock, compliance, relative * compliance})});
    }
    return all;
}

} // namespace bris
