#include "scenarios/network/truth.hpp"

#include "engine/errors.hpp"
#include "engine/io/csv.hpp"
#include "engine/random.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace bris {

namespace {

constexpr double rest = 1; // s, of the signal before and after a train

std::vector<ScheduledTrain> read_timetable(const TruthSettings& s) {
    const CsvTable table = read_csv(s.timetable);
    const auto planned = table.column("planned_s");
    const auto arrival = table.has("arrival_s") ? table.column("arrival_s") : planned;
    std::vector<ScheduledTrain> trains;
    for (std::size_t k = 0; k < planned.size(); ++k) {
        const double least = trains.empty() ? rest : trains.back().arrival + s.passage + 2 * rest;
        const double at = std::isnan(arrival[k]) ? planned[k] : arrival[k];
        require(std::isfinite(planned[k]),
                fmt::format("{}:{}: planned_s: expected a number, found {}", s.timetable.string(),
                            table.lines[k], planned[k]));
        require(at >= least && at < 1e9,
                fmt::format("{}:{}: expected arrivals in order, here at least {:g} s, found {:g}",
                            s.timetable.string(), table.lines[k], least, at));
        trains.push_back({planned[k], at});
    }
    return trains;
}

} // namespace

void require_sampling_rate(double rate, const std::string& what) {
    const double ratio = Truth::base_rate / rate;
    require(rate > 0 && ratio == std::round(ratio) && rate == std::round(rate),
            fmt::format("{}: expected a whole number of Hz that divides {:g}, found {:g}", what,
                        Truth::base_rate, rate));
}

Truth::Truth(const TruthSettings& settings, std::uint64_t seed) : settings_(settings), seed_(seed) {
    vibration_.rate = base_rate;
    vibration_.lead = rest;
    vibration_.duration = settings.passage;
    if (!settings.timetable.empty()) {
        trains_ = read_timetable(settings);
    } else {
        Random random(seed, 1);
        // a train late by more than half a headway would meet the next one
        const double most = std::max(0.0, 0.5 * settings.headway - settings.passage - 2 * rest);
        for (double planned = 0.5 * settings.headway; planned < settings.duration;
             planned += settings.headway)
            trains_.push_back(
                {planned, planned + std::clamp(settings.delay * random.normal(), -most, most)});
    }
    std::erase_if(trains_, [&](const ScheduledTrain& t) {
        return t.arrival + settings.passage + 2 * rest > settings.duration;
    });
    for (ScheduledTrain& t : trains_) t.changed = t.arrival >= settings.change_time;
}

std::uint64_t Truth::first_sample(std::size_t train) const {
    return static_cast<std::uint64_t>(std::llround((trains_[train].arrival - rest) * base_rate));
}

std::uint64_t Truth::samples_per_train() const {
    return static_cast<std::uint64_t>(std::llround((settings_.passage + 2 * rest) * base_rate));
}

std::vector<double> Truth::signal(unsigned rock, std::size_t train) const {
    return synthetic_vertical(
        vibration_, synthetic_state(trains_[train].changed ? settings_.changed_state : "clean"),
        seed_, static_cast<unsigned>(train) + 1, rock + 1);
}

std::pair<std::size_t, std::size_t> Truth::trains_within(std::uint64_t first,
                                                         std::uint64_t end) const {
    const auto from = std::ranges::partition_point(trains_, [&](const ScheduledTrain& t) {
        return (t.arrival + settings_.passage + rest) * base_rate <= static_cast<double>(first);
    });
    const auto to = std::ranges::partition_point(trains_, [&](const ScheduledTrain& t) {
        return (t.arrival - rest) * base_rate < static_cast<double>(end);
    });
    return {static_cast<std::size_t>(from - trains_.begin()),
            static_cast<std::size_t>(std::max(from, to) - trains_.begin())};
}

double Truth::noise_of_sample(double rate) const { return settings_.noise * std::sqrt(rate / 200); }

const std::vector<double>& RockSignal::of_train(std::size_t train) {
    if (train != train_) signal_ = truth_.signal(rock_, train);
    train_ = train;
    return signal_;
}

std::vector<double> RockSignal::measured(std::uint64_t first, std::size_t count, double rate) {
    const auto every = static_cast<std::uint64_t>(std::llround(Truth::base_rate / rate));
    const double deviation = truth_.noise_of_sample(rate);
    const std::uint64_t end = first + count * every;
    std::vector<double> values(count, 0.0);
    for (std::size_t k = 0; k < count; ++k) {
        Random random(truth_.seed() + 1 + rock_, first + k * every); // of this sample at any packet
        values[k] = deviation * random.normal();
    }
    const auto [from, to] = truth_.trains_within(first, end);
    for (std::size_t train = from; train < to; ++train) {
        const std::uint64_t begin = truth_.first_sample(train),
                            stop = begin + truth_.samples_per_train();
        const auto& a = of_train(train);
        for (std::uint64_t at = std::max(begin, first); at < std::min(stop, end); ++at)
            values[(at - first) / every] += a[at - begin] / static_cast<double>(every);
    }
    return values;
}

} // namespace bris
