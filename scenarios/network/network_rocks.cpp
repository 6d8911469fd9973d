// What rocks do: wake, sample, pack, warn, listen, and use their batteries.
#include "scenarios/network/network_simulation.hpp"

#include <algorithm>
#include <cmath>

namespace bris {

double NetworkSimulation::standing_power(const NetworkRock& rock) const {
    const RockPower& p = settings_.rock_power;
    switch (rock.activity) {
    case Activity::asleep:
        return p.asleep;
    case Activity::armed:
        return p.armed;
    case Activity::sampling:
        return p.sampling + p.per_sample * rock.settings.sampling_rate;
    case Activity::empty:
        break;
    }
    return 0;
}

/// Brings the energy of a rock up to date. Returns false if its battery is empty, which it then was
/// since the time at which its power had used it up: nothing happened to the rock in between.
bool NetworkSimulation::update_energy(EntityId rock, double time) {
    NetworkRock& r = rocks_[rock];
    if (r.activity == Activity::empty) return false;
    const double power = standing_power(r);
    double& standing = r.activity == Activity::sampling ? r.use.sampling : r.use.standing;
    const double needed = power * (time - r.updated), used = std::min(needed, r.charge);
    standing += used;
    r.charge -= used;
    const bool lasts = r.charge > 0 || used == needed;
    if (!lasts || r.charge <= 0) {
        r.empty_at = power > 0 ? r.updated + used / power : r.updated;
        r.activity = Activity::empty;
        ++r.version;
    }
    r.updated = time;
    return r.activity != Activity::empty;
}

/// Begins what the strategy of the rock asks for.
void NetworkSimulation::start(EntityId rock, double time) {
    const Strategy strategy = rocks_[rock].settings.strategy;
    rocks_[rock].activity = strategy == Strategy::triggered ? Activity::armed : Activity::asleep;
    if (strategy == Strategy::continuous)
        sample_from(rock, time, time, std::numeric_limits<double>::infinity());
    else if (strategy == Strategy::triggered)
        look(rock, time,
             truth_.trains_within(static_cast<std::uint64_t>(time * Truth::base_rate), 0).first);
    else
        next_wake(rock, time);
}

/// Adds the next wake of a rock by its timetable or duty cycle.
void NetworkSimulation::next_wake(EntityId rock, double time) {
    const InstalledRockSettings& s = rocks_[rock].settings;
    const std::uint64_t version = rocks_[rock].version;
    if (s.strategy == Strategy::duty_cycled) {
        const double period = std::ceil(time / s.duty_period - 1e-9);
        return add(period * s.duty_period, Kind::wake, rock, version);
    }
    double next = std::numeric_limits<double>::infinity();
    for (const ScheduledTrain& train : truth_.trains())
        if (train.planned - s.lead > time) next = std::min(next, train.planned - s.lead);
    if (std::isfinite(next)) add(next, Kind::wake, rock, version);
}

void NetworkSimulation::wake(EntityId rock, double time) {
    if (!update_energy(rock, time) || apply_changes(rock, time)) return;
    const InstalledRockSettings& s = rocks_[rock].settings;
    const bool by_timetable = s.strategy == Strategy::scheduled;
    const double end = time + (by_timetable ? s.session : s.duty_on);
    if (rocks_[rock].activity == Activity::sampling) { // the next train comes during the session
        rocks_[rock].session_end = end;
        add(end, Kind::stop, rock, rocks_[rock].version);
    } else {
        sample_from(rock, time, time, end);
    }
    next_wake(rock, by_timetable ? time : time + 1e-6 * s.duty_period); // not this one again
}

/// Samples from `first_time` on, which lies before `time` if a buffer has kept the samples.
void NetworkSimulation::sample_from(EntityId rock, double time, double first_time, double end) {
    NetworkRock& r = rocks_[rock];
    const auto every = std::llround(Truth::base_rate / rocks_[rock].settings.sampling_rate);
    const auto first = static_cast<std::uint64_t>(
        std::ceil(first_time * Truth::base_rate / static_cast<double>(every) - 1e-9) *
        static_cast<double>(every));
    r.next = std::max(r.next, first); // no sample is sent twice
    r.session_end = end;
    r.count = r.squares = 0;
    rocks_[rock].activity = Activity::sampling;
    if (std::isfinite(end)) add(end, Kind::stop, rock, r.version);
    schedule_packet(rock, time);
}

/// Adds the event at which the present packet has its last sample.
void NetworkSimulation::schedule_packet(EntityId rock, double time) {
    const NetworkRock& r = rocks_[rock];
    const double base_samples =
        settings_.packet_samples * Truth::base_rate / rocks_[rock].settings.sampling_rate;
    const double full = (static_cast<double>(r.next) + base_samples) / Truth::base_rate;
    add(std::max(time, full), Kind::packet_full, rock, r.version);
}

void NetworkSimulation::packet_full(EntityId rock, double time) {
    if (!update_energy(rock, time) || rocks_[rock].activity != Activity::sampling) return;
    make_packet(rock, time, static_cast<std::uint32_t>(settings_.packet_samples));
    if (apply_changes(rock, time)) return;
    schedule_packet(rock, time);
}

void NetworkSimulation::stop(EntityId rock, double time) {
    NetworkRock& r = rocks_[rock];
    if (!update_energy(rock, time) || time < r.session_end) return;
    const double every = Truth::base_rate / rocks_[rock].settings.sampling_rate;
    const double left = (time * Truth::base_rate - static_cast<double>(r.next)) / every;
    const auto full = static_cast<std::uint32_t>(settings_.packet_samples);
    for (auto samples = static_cast<std::uint32_t>(std::max(0.0, std::floor(left + 1e-9)));
         samples > 0; samples -= std::min(samples, full))
        make_packet(rock, time, std::min(samples, full));
    ++r.version; // the packet that was being filled is gone
    const Strategy strategy = rocks_[rock].settings.strategy;
    rocks_[rock].activity = strategy == Strategy::triggered ? Activity::armed : Activity::asleep;
    if (strategy == Strategy::triggered)
        look(rock, time,
             truth_.trains_within(static_cast<std::uint64_t>(time * Truth::base_rate), 0).first);
    else
        next_wake(rock, time);
}

/// Finds when a train next moves an armed rock enough to wake it. Looks at the next train when that
/// begins.
void NetworkSimulation::look(EntityId rock, double time, std::size_t train) {
    if (!update_energy(rock, time) || rocks_[rock].activity != Activity::armed) return;
    if (train >= truth_.trains().size()) return;
    const std::uint64_t begin = truth_.first_sample(train);
    const auto now = static_cast<std::uint64_t>(std::ceil(time * Truth::base_rate - 1e-9));
    if (now < begin)
        return add(static_cast<double>(begin) / Truth::base_rate, Kind::look, rock, train);
    const auto& signal = signals_[rock].of_train(train);
    const double level = rocks_[rock].settings.trigger_level;
    for (std::uint64_t k = now - begin; k < signal.size(); ++k)
        if (std::abs(signal[k]) > level)
            return add(static_cast<double>(begin + k) / Truth::base_rate, Kind::trigger, rock,
                       train);
    look(rock, time, train + 1);
}

void NetworkSimulation::trigger(EntityId rock, double time, std::size_t train) {
    if (!update_energy(rock, time) || rocks_[rock].activity != Activity::armed ||
        apply_changes(rock, time))
        return;
    const InstalledRockSettings& s = rocks_[rock].settings;
    const auto& signal = signals_[rock].of_train(train);
    const std::uint64_t begin = truth_.first_sample(train);
    const auto now = static_cast<std::uint64_t>(std::llround(time * Truth::base_rate));
    double last = time; // as the rock notices when it comes: it goes on while triggers follow
    for (std::uint64_t k = now - begin; k < signal.size(); ++k) {
        const double at = static_cast<double>(begin + k) / Truth::base_rate;
        if (at > last + s.post_trigger) break;
        if (std::abs(signal[k]) > s.trigger_level) last = at;
    }
    sample_from(rock, time, std::max(0.0, time - s.pre_trigger), last + s.post_trigger);
}

void NetworkSimulation::make_packet(EntityId rock, double time, std::uint32_t samples) {
    NetworkRock& r = rocks_[rock];
    const double rate = rocks_[rock].settings.sampling_rate;
    const Packet packet{.rock = rock,
                        .samples = samples,
                        .bytes = static_cast<std::uint32_t>(settings_.header_bytes +
                                                            settings_.sample_bytes * samples),
                        .first = r.next,
                        .rate = rate};
    r.next += samples * static_cast<std::uint64_t>(std::llround(Truth::base_rate / rate));
    r.samples += samples;
    ++r.packets_made;
    offer(rock, packet, time);
    check_warning(rock, time, packet);
}

/// Sums the mean square of each second, and warns once per train. Between trains there is only
/// noise, far below any threshold, and nothing is computed.
void NetworkSimulation::check_warning(EntityId rock, double time, const Packet& packet) {
    NetworkRock& r = rocks_[rock];
    const auto every = static_cast<std::uint64_t>(std::llround(Truth::base_rate / packet.rate));
    const auto [from, to] =
        truth_.trains_within(packet.first, packet.first + packet.samples * every);
    if (from == to || r.warned_train == from) return;
    const auto values = signals_[rock].measured(packet.first, packet.samples, packet.rate);
    const double threshold = rocks_[rock].settings.warning_threshold;
    for (std::size_t k = 0; k < values.size(); ++k) {
        const auto block = static_cast<std::uint64_t>(
            static_cast<double>(packet.first + k * every) / Truth::base_rate);
        if (block != r.block) r.count = r.squares = 0;
        r.block = block;
        r.squares += values[k] * values[k];
        if (++r.count < packet.rate || r.squares < threshold * threshold * r.count)
            continue; // a whole second
        r.warned_train = from;
        ++r.packets_made;
        return offer(rock,
                     {.rock = rock,
                      .is_warning = true,
                      .bytes = static_cast<std::uint32_t>(settings_.warning_bytes),
                      .first = packet.first,
                      .rate = packet.rate},
                     time);
    }
}

void NetworkSimulation::contact(EntityId rock, double time) {
    if (!update_energy(rock, time)) return;
    add(time + settings_.contact_interval, Kind::contact, rock);
    NetworkRock& r = rocks_[rock];
    const double used = std::min(r.charge, settings_.rock_power.contact);
    r.charge -= used;
    r.use.contact += used;
    if (!update_energy(rock, time)) return;
    (void)apply_changes(rock, time);
}

/// Takes over the settings that the host holds for the rock. True: they have changed, and the rock
/// begins again.
bool NetworkSimulation::apply_changes(EntityId rock, double time) {
    NetworkRock& r = rocks_[rock];
    InstalledRockSettings settings = r.settings;
    bool changed = false;
    for (; r.changes_known < host_changes_.size(); ++r.changes_known) {
        const HostChange& at_host = host_changes_[r.changes_known];
        if (at_host.time > time) break;
        const SettingsChange& change = settings_.changes[at_host.change];
        if (!change.all && change.rock != rock) continue;
        if (change.strategy) settings.strategy = *change.strategy;
        for (const auto& [name, value] : change.values) settings.*name = value;
        applied_.push_back({at_host.change, rock, time});
        changed = true;
    }
    if (!changed) return false;
    if (rocks_[rock].activity == Activity::sampling) { // what was sampled so far is sent
        r.session_end = time;
        stop(rock, time);
    }
    r.settings = settings;
    ++r.version;
    start(rock, time);
    return true;
}

} // namespace bris
