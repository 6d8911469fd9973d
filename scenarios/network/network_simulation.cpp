#include "scenarios/network/network_simulation.hpp"

#include <algorithm>

namespace bris {

NetworkSimulation::NetworkSimulation(const NetworkSettings& settings, const Truth& truth,
                                     std::uint64_t seed)
    : settings_(settings), truth_(truth), seed_(seed) {
    for (EntityId rock = 0; rock < settings.rocks; ++rock) {
        rocks_.push_back({.host = rock % settings.hosts,
                          .settings = settings.rock,
                          .charge = settings.rock_power.battery});
        signals_.emplace_back(truth, rock);
        links_.push_back({.properties = settings.rock_link});
    }
    hosts_.assign(settings.hosts, {.charge = settings.host_power.battery});
    links_.resize(settings.rocks + settings.hosts, {.properties = settings.cloud_link});
    for (std::size_t k = 0; k < settings.changes.size(); ++k)
        add(settings.changes[k].time, Kind::change, 0, k);
    for (std::uint32_t host = 0; host < settings.hosts; ++host) add(tick, Kind::host_tick, host);
    for (EntityId rock = 0; rock < settings.rocks; ++rock) {
        start(rock, 0);
        if (settings.contact_interval > 0) add(settings.contact_interval, Kind::contact, rock);
    }
}

void NetworkSimulation::add(double time, Kind kind, std::uint32_t entity, std::uint64_t version,
                            const Packet& packet) {
    events_.push({time, added_++, kind, entity, version, packet});
}

void NetworkSimulation::run() {
    const double end = truth_.settings().duration;
    while (!events_.empty() && events_.top().time <= end) {
        const Event event = events_.top();
        events_.pop();
        handle(event);
    }
    for (EntityId rock = 0; rock < settings_.rocks; ++rock) (void)update_energy(rock, end);
}

void NetworkSimulation::handle(const Event& event) {
    const auto of_present_session = [&] { return event.version == rocks_[event.entity].version; };
    switch (event.kind) {
    case Kind::wake:
        if (of_present_session()) wake(event.entity, event.time);
        break;
    case Kind::stop:
        if (of_present_session()) stop(event.entity, event.time);
        break;
    case Kind::packet_full:
        if (of_present_session()) packet_full(event.entity, event.time);
        break;
    case Kind::look:
        look(event.entity, event.time, event.version);
        break;
    case Kind::trigger:
        trigger(event.entity, event.time, event.version);
        break;
    case Kind::contact:
        contact(event.entity, event.time);
        break;
    case Kind::sent:
        sent(event.entity, event.time);
        break;
    case Kind::retry:
        links_[event.entity].busy = false;
        try_to_send(event.entity, event.time);
        break;
    case Kind::arrival:
        arrive(event.entity, event.time, event.packet);
        break;
    case Kind::host_tick:
        host_tick(event.entity, event.time);
        break;
    case Kind::change: { // given to the cloud; the host has it when its link is up
        const auto link = settings_.rocks; // of the first host: all hear of it at the same time
        host_changes_.push_back(
            {event.version, up_from(link, event.time, 0) + links_[link].properties.latency});
        break;
    }
    }
}

PacketBalance NetworkSimulation::balance() const {
    PacketBalance b;
    for (const NetworkRock& rock : rocks_) b.made += rock.packets_made;
    b.delivered = packets_received_;
    for (const NetworkLink& link : links_) {
        b.lost_on_air += link.counts.lost_on_air;
        b.lost_full += link.counts.lost_full;
        b.queued += link.queue.size();
    }
    auto events = events_;
    for (; !events.empty(); events.pop()) b.queued += events.top().kind == Kind::arrival;
    return b;
}

} // namespace bris
