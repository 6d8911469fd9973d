#include "scenarios/ballast_box/load_turns.hpp"

#include "engine/math.hpp"

#include <algorithm>
#include <cmath>

namespace bris {

std::vector<double> load_turns(const Train& train, const RailOnTies& rails, double dead_load) {
    constexpr double speed = 10; // m/s: a value every centimetre of track
    constexpr double least_change = 0.05;
    const LoadHistory passing = passing_load(train, speed, rails, dead_load);
    const double change = least_change * std::ranges::max(passing.values);
    std::vector<double> turns{dead_load};
    bool rising = true;
    double extreme = dead_load;
    for (const double value : passing.values) {
        const double force = std::max(0.0, value);
        const bool goes_on = rising ? force > extreme : force < extreme;
        if (goes_on) {
            extreme = force;
        } else if (std::abs(force - extreme) > change) {
            turns.push_back(extreme);
            rising = !rising;
            extreme = force;
        }
    }
    if (rising) turns.push_back(extreme); // the last fall is less than the least change
    turns.push_back(dead_load);
    return turns;
}

LoadHistory load_through(const std::vector<double>& turns, double interval) {
    constexpr int parts = 20; // of a half wave, between which the force is linear
    LoadHistory history{.times = {0}, .values = {turns.front()}};
    for (std::size_t k = 1; k < turns.size(); ++k)
        for (int part = 1; part <= parts; ++part) {
            const double share = static_cast<double>(part) / parts;
            history.times.push_back(interval * (static_cast<double>(k - 1) + share));
            history.values.push_back(turns[k - 1] +
                                     (turns[k] - turns[k - 1]) * 0.5 * (1 - std::cos(pi * share)));
        }
    return history;
}

} // namespace bris
