#include "scenarios/ballast_box/train.hpp"

#include "engine/assets.hpp"
#include "engine/errors.hpp"
#include "engine/io/csv.hpp"

#include <fmt/format.h>

#include <cmath>

namespace bris {

Train train_named(const std::string& name, const std::string& option) {
    constexpr double heaviest = 500; // kN, more than any railway allows
    const auto path = asset_or_file(option, "trains", name, ".csv");
    const CsvTable table = read_csv(path);
    const auto position = table.column("position_m"), load = table.column("axle_load_kN");
    require(!position.empty(), path.string() + ": expected at least one axle, found none");
    Train train{.name = name, .axles = {}};
    for (std::size_t k = 0; k < position.size(); ++k) {
        const auto expect = [&](bool is_met, const char* what, double found) {
            require(is_met, fmt::format("{}:{}: expected {}, found {:g}", path.string(),
                                        table.lines[k], what, found));
        };
        expect(k > 0 || position[k] == 0, "position_m 0 of the first axle", position[k]);
        expect(k == 0 || position[k] > position[k - 1],
               "a position_m greater than that of the axle before", position[k]);
        expect(load[k] > 0 && load[k] <= heaviest, "an axle_load_kN above 0 and at most 500",
               load[k]);
        train.axles.push_back({position[k], 1e3 * load[k]});
    }
    return train;
}

double RailOnTies::wave_number() const {
    return std::pow(tie_support / spacing / (4 * bending), 0.25);
}

double RailOnTies::share(double x) const {
    const double beta = wave_number(), phase = beta * std::abs(x);
    return 0.5 * spacing * beta * std::exp(-phase) * (std::cos(phase) + std::sin(phase));
}

double RailOnTies::stiffness_without_tie() const {
    return 2 * tie_support / (spacing * wave_number()) - tie_support;
}

double RailOnTies::reach() const { return 12 / wave_number(); } // sqrt(2) exp(-12) = 9e-6

double passing_time(const Train& train, double speed, const RailOnTies& rails) {
    return (train.length() + 2 * rails.reach()) / speed;
}

LoadHistory passing_load(const Train& train, double speed, const RailOnTies& rails,
                         double dead_load) {
    constexpr double interval = 1e-3; // s
    const double duration = passing_time(train, speed, rails);
    const auto intervals = static_cast<std::size_t>(std::ceil(duration / interval));
    LoadHistory history;
    for (std::size_t k = 0; k <= intervals; ++k) {
        const double time = duration * static_cast<double>(k) / static_cast<double>(intervals);
        double force = dead_load;
        for (const Axle& axle : train.axles)
            force += axle.load * rails.share(speed * time - rails.reach() - axle.behind);
        history.times.push_back(time);
        history.values.push_back(force);
    }
    return history;
}

} // namespace bris
