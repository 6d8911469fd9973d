#include "scenarios/network/network_simulation.hpp"

#include "engine/errors.hpp"

#include <algorithm>
#include <cmath>

namespace bris {

namespace {

constexpr double tick = 600; // s, between updates of the energy of a host
constexpr auto infinity = std::numeric_limits<double>::infinity();

void set_ids(std::span<EntityId> ids) {
    for (std::size_t k = 0; k < ids.size(); ++k) ids[k] = static_cast<EntityId>(k);
}

} // namespace

NetworkSimulation::NetworkSimulation(const NetworkSettings& settings, const Truth& truth,
                                     std::uint64_t seed)
    : settings_(settings), truth_(truth), seed_(seed), rocks_(settings.rocks),
      links_(settings.rocks + settings.hosts), host_down_(settings.hosts, 0) {
    auto& rocks = world_.table<Rocks>();
    rocks.resize(settings.rocks);
    set_ids(rocks.add<NodeId>());
    rocks.add<CurrentActivity>();
    rocks.add<EnergyUse>();
    rocks.add<SamplesTaken>();
    rocks.add<PacketsMade>();
    std::ranges::fill(rocks.add<Charge>(), settings.rock_power.battery);
    std::ranges::fill(rocks.add<EmptyAt>(), infinity);
    std::ranges::fill(rocks.add<RockSettings>(), settings.rock);
    const auto host_of = rocks.add<HostOfRock>();
    for (EntityId rock = 0; rock < settings.rocks; ++rock) {
        host_of[rock] = rock % settings.hosts;
        signals_.emplace_back(truth, rock);
    }
    auto& hosts = world_.table<Hosts>();
    hosts.resize(settings.hosts);
    set_ids(hosts.add<NodeId>());
    hosts.add<EnergyUse>();
    hosts.add<Solar>();
    std::ranges::fill(hosts.add<Charge>(), settings.host_power.battery);
    auto& clouds = world_.table<Clouds>();
    clouds.resize(1);
    set_ids(clouds.add<NodeId>());
    clouds.add<PacketsReceived>();
    clouds.add<BytesReceived>();
    auto& links = world_.table<Links>();
    links.resize(links_.size());
    set_ids(links.add<NodeId>());
    links.add<LinkCounts>();
    const auto rows = links.add<LinkProperties>();
    for (std::uint32_t link = 0; link < rows.size(); ++link)
        rows[link] = is_rock_link(link) ? settings.rock_link : settings.cloud_link;

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
            {event.version, up_from(link, event.time, 0) + properties(link).latency});
        break;
    }
    }
}

PacketBalance NetworkSimulation::balance() const {
    PacketBalance b;
    for (const std::uint64_t made : world_.column<Rocks, PacketsMade>()) b.made += made;
    b.delivered = world_.column<Clouds, PacketsReceived>()[0];
    for (const LinkCountRow& row : world_.column<Links, LinkCounts>()) {
        b.lost_on_air += row.lost_on_air;
        b.lost_full += row.lost_full;
    }
    for (const LinkMemory& link : links_) b.queued += link.queue.size();
    auto events = events_;
    for (; !events.empty(); events.pop()) b.queued += events.top().kind == Kind::arrival;
    return b;
}

} // namespace bris
