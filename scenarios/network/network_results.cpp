#include "scenarios/network/network_results.hpp"

#include <algorithm>
#include <cmath>
#include <map>

namespace bris {

namespace {

/// Base samples from `first` to before `end` that the cloud received, at one rate.
struct Piece {
    std::uint64_t first, end;
    double rate;
};

std::uint64_t every_of(double rate) {
    return static_cast<std::uint64_t>(std::llround(Truth::base_rate / rate));
}

/// The received packets of a rock, joined where they follow each other.
std::vector<Piece> pieces_of(const std::vector<Received>& received, EntityId rock) {
    std::vector<Piece> pieces;
    for (const Received& r : received)
        if (r.packet.rock == rock)
            pieces.push_back({r.packet.first,
                              r.packet.first + r.packet.samples * every_of(r.packet.rate),
                              r.packet.rate});
    std::ranges::sort(pieces, {}, &Piece::first);
    std::vector<Piece> joined;
    for (const Piece& p : pieces)
        if (!joined.empty() && joined.back().end == p.first && joined.back().rate == p.rate)
            joined.back().end = p.end;
        else
            joined.push_back(p);
    return joined;
}

/// The samples of a rock under trains, by their rate, and the base samples that they cover.
struct Measured {
    std::map<double, std::vector<std::vector<double>>> runs;
    std::uint64_t covered = 0;
};

Measured measured_by(const std::vector<Piece>& pieces, const Truth& truth, EntityId rock) {
    Measured measured;
    RockSignal signal(truth, rock);
    for (const Piece& p : pieces) {
        const std::uint64_t every = every_of(p.rate);
        const auto [from, to] = truth.trains_within(p.first, p.end);
        for (std::size_t train = from; train < to; ++train) {
            const std::uint64_t begin = truth.first_sample(train),
                                stop = begin + truth.samples_per_train();
            std::uint64_t first = std::max(p.first, begin);
            first += (every - (first - p.first) % every) % every; // a sample of the rock
            const std::uint64_t end = std::min(p.end, stop);
            if (end < first + every) continue;
            const std::size_t count = (end - first) / every;
            measured.covered += count * every;
            measured.runs[p.rate].push_back(signal.measured(first, count, p.rate));
        }
    }
    return measured;
}

/// Spectra with bins of 1 Hz of all rates, weighted by their segments; bins above half a rate are
/// 0.
Spectrum spectrum_of(const std::map<double, std::vector<std::vector<double>>>& runs) {
    Spectrum sum{.spacing = 1};
    sum.density.assign(static_cast<std::size_t>(Truth::base_rate / 2) + 1, 0.0);
    for (const auto& [rate, of_rate] : runs) {
        const auto segment = static_cast<std::size_t>(rate);
        if (std::ranges::none_of(of_rate, [&](const auto& run) { return run.size() >= segment; }))
            continue;
        const Spectrum one = welch(of_rate, rate, {.segment = segment});
        for (std::size_t k = 0; k < one.density.size(); ++k)
            sum.density[k] += static_cast<double>(one.segments) * one.density[k];
        sum.segments += one.segments;
    }
    for (double& density : sum.density)
        density /= static_cast<double>(std::max<std::size_t>(1, sum.segments));
    return sum;
}

Spectrum true_spectrum_of(const Truth& truth, EntityId rock) {
    std::vector<std::vector<double>> runs;
    for (std::size_t train = 0; train < truth.trains().size(); ++train)
        runs.push_back(truth.signal(rock, train));
    return spectrum_of({{Truth::base_rate, std::move(runs)}});
}

double relative_error(const Spectrum& found, const Spectrum& expected) {
    double error = 0, sum = 0;
    for (std::size_t k = 1; k < expected.density.size(); ++k) {
        error += std::abs(found.density[k] - expected.density[k]);
        sum += expected.density[k];
    }
    return error / sum;
}

void add_alarms(StrategyResult& result, const NetworkSimulation& simulation, const Truth& truth) {
    const auto& trains = truth.trains();
    const auto first_changed = std::ranges::find_if(trains, &ScheduledTrain::changed);
    for (const Received& w : simulation.warnings()) {
        const auto [from, to] = truth.trains_within(w.packet.first, w.packet.first + 1);
        const bool right = from < to && trains[from].changed;
        ++result.warnings;
        result.false_warnings += !right;
        if (!right) continue;
        const double delay = w.time - first_changed->arrival;
        if (!(result.alarm_delay <= delay)) result.alarm_delay = delay;
    }
}

} // namespace

StrategyResult result_of(const NetworkSimulation& simulation, const NetworkSettings& settings,
                         const Truth& truth) {
    StrategyResult result{.strategy = settings.rock.strategy, .packets = simulation.balance()};
    const double duration = truth.settings().duration, days = duration / 86400,
                 rocks = settings.rocks;
    result.bytes_per_day = static_cast<double>(simulation.bytes_received()) / days;
    for (const NetworkRock& rock : simulation.rocks()) {
        const double used = rock.use.total(), empty = rock.empty_at;
        result.energy_per_day += used / std::min(days, empty / 86400) / rocks;
        result.lifetime +=
            (std::isfinite(empty) ? empty : settings.rock_power.battery / used * duration) / rocks;
    }
    double covered = 0, errors = 0, heard = 0;
    for (EntityId rock = 0; rock < settings.rocks && !truth.trains().empty(); ++rock) {
        const Measured measured = measured_by(pieces_of(simulation.received(), rock), truth, rock);
        covered += static_cast<double>(measured.covered);
        const Spectrum expected = true_spectrum_of(truth, rock), found = spectrum_of(measured.runs);
        if (rock == 0) {
            result.true_spectrum = expected;
            result.received_spectrum = found;
        }
        if (found.segments == 0) continue;
        errors += relative_error(found, expected);
        ++heard;
    }
    result.recorded_share =
        covered / (rocks * static_cast<double>(truth.trains().size() * truth.samples_per_train()));
    if (heard > 0) result.spectrum_error = errors / heard;
    add_alarms(result, simulation, truth);
    result.host_least_charge =
        std::ranges::min_element(simulation.hosts(), {}, &NetworkHost::charge)->charge;
    result.changes = simulation.applied_changes();
    return result;
}

double duty_cycle_lifetime(const NetworkSettings& s) {
    const InstalledRockSettings& r = s.rock;
    const RockPower& p = s.rock_power;
    const double duty = r.duty_on / r.duty_period, samples = r.duty_on * r.sampling_rate,
                 packets = std::ceil(samples / s.packet_samples - 1e-9);
    const double bytes = packets * s.header_bytes + samples * s.sample_bytes;
    const double power = (1 - duty) * p.asleep +
                         duty * (p.sampling + p.per_sample * r.sampling_rate) +
                         p.sending * 8 * bytes / s.rock_link.bandwidth / r.duty_period +
                         (s.contact_interval > 0 ? p.contact / s.contact_interval : 0);
    return p.battery / power;
}

} // namespace bris
