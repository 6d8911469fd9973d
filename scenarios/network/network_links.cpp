// What links and hosts do: store, send, lose, delay, forward, and live on sunshine.
#include "engine/random.hpp"
#include "scenarios/network/network_simulation.hpp"

#include <algorithm>
#include <cmath>

namespace bris {

namespace {

constexpr double tick = 600;            // s, between updates of the energy of a host
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

LinkRow& NetworkSimulation::properties(std::uint32_t link) {
    return world_.column<Links, LinkProperties>()[link];
}

const LinkRow& NetworkSimulation::properties(std::uint32_t link) const {
    return world_.column<Links, LinkProperties>()[link];
}

LinkCountRow& NetworkSimulation::counts(std::uint32_t link) {
    return world_.column<Links, LinkCounts>()[link];
}

std::uint32_t NetworkSimulation::host_of_link(std::uint32_t link) const {
    return is_rock_link(link) ? world_.column<Rocks, HostOfRock>()[link] : link - settings_.rocks;
}

/// Earliest time from `time` on at which the link is up for `airtime` seconds.
double NetworkSimulation::up_from(std::uint32_t link, double time, double airtime) const {
    const LinkRow& p = properties(link);
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
    LinkCountRow& c = counts(link);
    LinkMemory& memory = links_[link];
    ++c.offered;
    if (static_cast<double>(c.buffered_bytes + packet.bytes) > properties(link).buffer) {
        ++c.lost_full;
        return;
    }
    c.buffered_bytes += packet.bytes;
    c.largest_buffered_bytes = std::max(c.largest_buffered_bytes, c.buffered_bytes);
    ++c.buffered;
    if (packet.is_warning) // overtakes all that is not being sent
        memory.queue.insert(memory.queue.begin() + (memory.sending ? 1 : 0), packet);
    else
        memory.queue.push_back(packet);
    try_to_send(link, time);
}

void NetworkSimulation::try_to_send(std::uint32_t link, double time) {
    LinkMemory& memory = links_[link];
    if (memory.busy || memory.queue.empty()) return;
    if (is_rock_link(link) && !update_energy(link, time)) return; // its packets stay where they are
    const std::uint32_t host = host_of_link(link);
    const double airtime = 8.0 * memory.queue.front().bytes / properties(link).bandwidth;
    const double from =
        host_down_[host] != 0 ? (std::floor(time / tick) + 1) * tick : up_from(link, time, airtime);
    memory.busy = true;
    if (from > time) return add(from, Kind::retry, link);
    memory.sending = true;
    ++counts(link).transmissions;
    if (is_rock_link(link)) {
        double& charge = world_.column<Rocks, Charge>()[link];
        const double used = std::min(charge, airtime * settings_.rock_power.sending);
        charge -= used;
        world_.column<Rocks, EnergyUse>()[link].sending += used;
    } else {
        world_.column<Hosts, Charge>()[host] -= airtime * settings_.host_power.sending;
        world_.column<Hosts, EnergyUse>()[host].sending += airtime * settings_.host_power.sending;
    }
    add(time + airtime, Kind::sent, link);
}

void NetworkSimulation::sent(std::uint32_t link, double time) {
    LinkMemory& memory = links_[link];
    LinkCountRow& c = counts(link);
    const LinkRow& p = properties(link);
    memory.busy = memory.sending = false;
    Random random(seed_ + 1000 + link, c.transmissions);
    const bool lost = random.uniform() < p.loss;
    if (lost && memory.tries++ < static_cast<unsigned>(p.repeats)) return try_to_send(link, time);
    memory.tries = 0;
    const Packet packet = memory.queue.front();
    memory.queue.pop_front();
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
    LinkCountRow& c = counts(link);
    --c.in_flight;
    ++c.delivered;
    if (is_rock_link(link)) return offer(settings_.rocks + host_of_link(link), packet, time);
    ++world_.column<Clouds, PacketsReceived>()[0];
    world_.column<Clouds, BytesReceived>()[0] += packet.bytes;
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
    double& charge = world_.column<Hosts, Charge>()[host];
    EnergyUseRow& use = world_.column<Hosts, EnergyUse>()[host];
    SolarRow& solar = world_.column<Hosts, Solar>()[host];
    const double gained = p.panel * (sunshine_until(time) - sunshine_until(time - tick));
    const double listening =
        host_down_[host] != 0 ? 0 : std::min(p.listening * tick, std::max(0.0, charge + gained));
    solar.gained += gained;
    use.standing += listening;
    charge += gained - listening;
    if (charge > p.battery) {
        solar.spilled += charge - p.battery;
        charge = p.battery;
    }
    if (charge <= 0)
        host_down_[host] = 1;
    else if (charge > restart_charge * p.battery)
        host_down_[host] = 0;
    add(time + tick, Kind::host_tick, host);
}

} // namespace bris
