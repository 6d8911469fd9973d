// What links and hosts do: store, send, lose, delay, forward, and live on sunshine.
#include "engine/random.hpp"
#include "scenarios/network/network_simulation.hpp"

#include <algorithm>
#include <cmath>

namespace bris {

namespace {

constexpr double restart_charge = 0.05; // of its battery, from which a host works again

/// Integral of max(0, sin) of the time of day: J per W of peak, since midnight of the first day.
double sunshine_until(double time) {
    constexpr double day = 86400, half = day / 2;
    const double days = std::floor(time / day), since_dawn = time - days * day - day / 4;
    const double today =
        since_dawn <= 0 ? 0 : half / pi * (1 - std::cos(pi * std::min(since_dawn, half) / half));
    return days * 2 * half / pi + today;
}

} // namespace

std::uint32_t NetworkSimulation::host_of_link(std::uint32_t link) const {
    return is_rock_link(link) ? rocks_[link].host : link - settings_.rocks;
}

/// Earliest time from `time` on at which the link is up for `airtime` seconds.
double NetworkSimulation::up_from(std::uint32_t link, double time, double airtime) const {
    const LinkProperties& p = links_[link].properties;
    if (p.outage <= 0) return time;
    double begin = p.outage_start;
    if (p.interval > 0 && time > begin)
        begin += p.interval * std::floor((time - begin) / p.interval);
    if (time >= begin && time < begin + p.outage) return begin + p.outage;
    const double next = time < begin ? begin : begin + p.interval;
    const bool interrupted = next > time && next < time + airtime;
    return interrupted ? next + p.outage : time;
}

void NetworkSimulation::offer(std::uint32_t link, const Packet& packet, double time) {
    NetworkLink& to = links_[link];
    LinkCounts& c = to.counts;
    ++c.offered;
    if (static_cast<double>(c.buffered_bytes + packet.bytes) > to.properties.buffer) {
        ++c.lost_full;
        return;
    }
    c.buffered_bytes += packet.bytes;
    c.largest_buffered_bytes = std::max(c.largest_buffered_bytes, c.buffered_bytes);
    ++c.buffered;
    if (packet.is_warning) // overtakes all that is not being sent
        to.queue.insert(to.queue.begin() + (to.sending ? 1 : 0), packet);
    else
        to.queue.push_back(packet);
    try_to_send(link, time);
}

void NetworkSimulation::try_to_send(std::uint32_t link, double time) {
    NetworkLink& to = links_[link];
    if (to.busy || to.queue.empty()) return;
    if (is_rock_link(link) && !update_energy(link, time)) return; // its packets stay where they are
    const std::uint32_t host = host_of_link(link);
    const double airtime = 8.0 * to.queue.front().bytes / to.properties.bandwidth;
    const double from =
        hosts_[host].is_down ? (std::floor(time / tick) + 1) * tick : up_from(link, time, airtime);
    to.busy = true;
    if (from > time) return add(from, Kind::retry, link);
    to.sending = true;
    ++to.counts.transmissions;
    if (is_rock_link(link)) {
        NetworkRock& rock = rocks_[link];
        const double used = std::min(rock.charge, airtime * settings_.rock_power.sending);
        rock.charge -= used;
        rock.use.sending += used;
    } else {
        hosts_[host].charge -= airtime * settings_.host_power.sending;
        hosts_[host].use.sending += airtime * settings_.host_power.sending;
    }
    add(time + airtime, Kind::sent, link);
}

void NetworkSimulation::sent(std::uint32_t link, double time) {
    NetworkLink& to = links_[link];
    LinkCounts& c = to.counts;
    const LinkProperties& p = links_[link].properties;
    to.busy = to.sending = false;
    Random random(seed_ + 1000 + link, c.transmissions);
    const bool lost = random.uniform() < p.loss;
    if (lost && to.tries++ < static_cast<unsigned>(p.repeats)) return try_to_send(link, time);
    to.tries = 0;
    const Packet packet = to.queue.front();
    to.queue.pop_front();
    --c.buffered;
    c.buffered_bytes -= packet.bytes;
    if (lost) {
        ++c.lost_on_air;
    } else {
        ++c.in_flight;
        add(time + p.latency + p.jitter * random.uniform(), Kind::arrival, link, 0, packet);
    }
    try_to_send(link, time);
}

void NetworkSimulation::arrive(std::uint32_t link, double time, const Packet& packet) {
    LinkCounts& c = links_[link].counts;
    --c.in_flight;
    ++c.delivered;
    if (is_rock_link(link)) return offer(settings_.rocks + host_of_link(link), packet, time);
    ++packets_received_;
    bytes_received_ += packet.bytes;
    if (packet.is_warning) {
        warnings_.push_back({packet, time});
        return;
    }
    const auto every = static_cast<std::uint64_t>(std::llround(Truth::base_rate / packet.rate));
    const auto [from, to] =
        truth_.trains_within(packet.first, packet.first + packet.samples * every);
    if (from != to) received_.push_back({packet, time});
}

/// Charges a host by the sun since the last tick, less what it used by listening.
void NetworkSimulation::host_tick(std::uint32_t host, double time) {
    const HostPower& p = settings_.host_power;
    NetworkHost& h = hosts_[host];
    const double gained = p.panel * (sunshine_until(time) - sunshine_until(time - tick));
    const double listening =
        h.is_down ? 0 : std::min(p.listening * tick, std::max(0.0, h.charge + gained));
    h.gained += gained;
    h.use.standing += listening;
    h.charge += gained - listening;
    if (h.charge > p.battery) {
        h.spilled += h.charge - p.battery;
        h.charge = p.battery;
    }
    if (h.charge <= 0)
        h.is_down = true;
    else if (h.charge > restart_charge * p.battery)
        h.is_down = false;
    add(time + tick, Kind::host_tick, host);
}

} // namespace bris
