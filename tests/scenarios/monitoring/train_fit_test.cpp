// Which accelerations are taken for those of a passing train.
#include "engine/random.hpp"
#include "scenarios/monitoring/train_fit.hpp"
#include "tests/scenarios/monitoring/passing_rock.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <functional>
#include <tuple>

using namespace bris;
using namespace bris::testing;

namespace {

constexpr double rate = 500, lowest = 0.7; // Hz
constexpr RailOnTies rails{
    .bending = 1.58e7, .tie_support = 3e7, .spacing = 0.61, .tie_weight = 3790};

PassingTrain passing(const char* train, double speed = 20) {
    return {train_named(train), speed, rails, 800};
}

LoadHistory load_of(const PassingTrain& p) {
    return passing_load(p.train, p.speed, p.rails, p.dead_load);
}

/// Downward acceleration (m/s2) of a rock under a load (hardening_displacement) as a function of
/// time, from a second before it to `after` seconds after it. `place`: time in the history.
std::vector<double> acceleration_under(
    const LoadHistory& load, double after = 1,
    const std::function<double(double)>& place = [](double t) { return t; }) {
    constexpr double h = 4e-3; // s
    const auto down = [&](double t) { return hardening_displacement(load.at(place(t))); };
    std::vector<double> series;
    for (double t = -1; t < load.times.back() + after; t += 1 / rate)
        series.push_back((down(t - h) - 2 * down(t) + down(t + h)) / (h * h));
    return series;
}

double rms(const std::vector<double>& series) {
    double squares = 0;
    for (const double x : series) squares += x * x;
    return std::sqrt(squares / static_cast<double>(series.size()));
}

/// Noise of unit variance whose neighbouring samples have the correlation `colour`.
std::vector<double> noise(std::size_t samples, double colour, std::uint64_t seed) {
    Random random(seed, 17);
    std::vector<double> series(samples);
    double last = random.normal();
    for (double& x : series)
        x = last = colour * last + std::sqrt(1 - colour * colour) * random.normal();
    return series;
}

TrainFit fit(const std::vector<double>& series, const PassingTrain& p) {
    return fit_train(series, rate, p, lowest);
}

/// Of so many recordings of noise: those of a p-value of at most 1 %, and those accepted.
void count_noise(std::uint64_t seeds, int& significant, int& accepted, int& all) {
    const PassingTrain p = passing("inspection");
    const std::size_t samples = acceleration_under(load_of(p)).size();
    for (const double colour : {0.0, 0.9, 0.99, 0.999})
        for (std::uint64_t seed = 1; seed <= seeds; ++seed, ++all) {
            const TrainFit f = fit(noise(samples, colour, seed), p);
            significant += f.p_value <= 0.01 ? 1 : 0;
            accepted += f.refused_because.empty() ? 1 : 0;
        }
}

/// Upper end of the 95 % interval of a share, of which k of n were found (Wilson).
double upper_end(int k, int n) {
    const double z = 1.96, p = double(k) / n;
    return (p + z * z / (2 * n) + z * std::sqrt(p * (1 - p) / n + z * z / (4.0 * n * n))) /
           (1 + z * z / n);
}

} // namespace

TEST_SUITE("monitoring/train_fit") {
    TEST_CASE("the train itself fits, and its speed is found") {
        for (const auto& [name, speed, stated] :
             {std::tuple{"inspection", 20.0, 0.96}, std::tuple{"inspection", 20.0, 1.04},
              std::tuple{"freight", 15.0, 1.0}, std::tuple{"passenger", 31.3, 1.0},
              std::tuple{"locomotive", 31.3, 1.0}}) {
            const PassingTrain true_one = passing(name, speed), p = passing(name, stated * speed);
            const TrainFit f = fit(acceleration_under(load_of(true_one)), p);
            INFO(name << " " << stated << " " << f.goodness << " " << f.p_value << " " << f.band);
            CHECK(f.refused_because == "");
            CHECK(f.speed == doctest::Approx(speed).epsilon(0.02));
            CHECK(f.goodness > 0.7);
            CHECK(f.p_value <= 0.01);
        }
    }

    TEST_CASE("noise of any colour is taken for a train in at most one of a hundred recordings") {
        int significant = 0, accepted = 0, all = 0;
        count_noise(25, significant, accepted, all);
        INFO(significant << " and " << accepted << " of " << all);
        CHECK(significant <= 4); // at a level of 1 %, five or more have a probability of 0.4 %
        CHECK(accepted == 0);
    }

    TEST_CASE("the level of the test holds in two thousand recordings of noise" *
              doctest::test_suite("slow")) {
        int significant = 0, accepted = 0, all = 0;
        count_noise(500, significant, accepted, all);
        MESSAGE(significant << " of " << all << " significant, at most "
                            << upper_end(significant, all) << "; accepted " << accepted
                            << ", at most " << upper_end(accepted, all));
        CHECK(significant <= 32); // at a level of 1 %, more have a probability of 0.4 %
        CHECK(accepted <= 32);
    }

    TEST_CASE("vibration at a single frequency is no train") {
        const PassingTrain p = passing("inspection");
        const std::size_t samples = acceleration_under(load_of(p)).size();
        for (const double frequency : {2.47, 6.2}) {
            std::vector<double> series = noise(samples, 0, 3);
            for (std::size_t k = 0; k < samples; ++k)
                series[k] =
                    0.01 * series[k] + std::sin(2 * pi * frequency * static_cast<double>(k) / rate);
            CAPTURE(frequency);
            CHECK(fit(series, p).refused_because != "");
        }
    }

    TEST_CASE("another train, one that stops, and one that goes on are refused") {
        const PassingTrain p = passing("inspection");
        const LoadHistory load = load_of(p);
        for (const char* other : {"freight", "passenger", "locomotive"}) {
            INFO(other);
            std::vector<double> series = acceleration_under(load_of(passing(other)), 4);
            const auto least = static_cast<std::size_t>((load.times.back() + 1) * rate);
            if (series.size() < least) series.resize(least, 0.0);
            const TrainFit f = fit(series, p);
            MESSAGE(other << ": " << f.goodness << " " << f.p_value << " " << f.refused_because);
            CHECK(f.refused_because != "");
        }
        for (const double from : {1.0, 1.5, 2.0}) { // s; it stands two seconds later
            const auto place = [&](double t) {
                const double braked = std::clamp(t - from, 0.0, 2.0);
                return t < from ? t : from + braked - braked * braked / 4;
            };
            const TrainFit f = fit(acceleration_under(load, 1, place), p);
            MESSAGE(from << ": " << f.goodness << " " << f.p_value << " " << f.refused_because);
            CHECK(f.refused_because != "");
        }
    }

    TEST_CASE("the right train is found in noise") {
        const PassingTrain p = passing("inspection");
        const auto train = acceleration_under(load_of(p));
        for (const double level : {1.0, 4.0, 8.0}) { // over the rms of the train
            int found = 0;
            constexpr int seeds = 10;
            for (int seed = 1; seed <= seeds; ++seed) {
                auto series = noise(train.size(), 0, 1000 + static_cast<std::uint64_t>(seed));
                for (std::size_t k = 0; k < series.size(); ++k)
                    series[k] = train[k] + level * rms(train) * series[k];
                found += fit(series, p).refused_because.empty() ? 1 : 0;
            }
            MESSAGE("noise " << level << " times the train: found in " << found << " of " << seeds
                             << ", missed at most " << upper_end(seeds - found, seeds));
            if (level <= 4) CHECK(found == seeds);
        }
    }
}
