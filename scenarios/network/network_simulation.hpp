#pragma once

#include "scenarios/network/network_settings.hpp"
#include "scenarios/network/truth.hpp"

#include <cstdint>
#include <deque>
#include <limits>
#include <queue>
#include <vector>

namespace bris {

/// What a rock sends: samples, or a warning.
struct Packet {
    EntityId rock = 0;
    bool is_warning = false;
    std::uint32_t samples = 0;
    std::uint32_t bytes = 0;
    std::uint64_t first = 0; ///< base sample (Truth) at which it begins
    double rate = 0;         ///< Hz, of its samples
};

/// A packet as it arrived at the cloud.
struct Received {
    Packet packet;
    double time = 0; ///< s
};

/// Counts of all packets: made = delivered + lost + queued. `queued` is counted in the queues and
/// in flight, not computed from the others.
struct PacketBalance {
    std::uint64_t made = 0, delivered = 0, lost_on_air = 0, lost_full = 0, queued = 0;
    std::uint64_t lost() const { return lost_on_air + lost_full; }
};

/// A change of settings that took effect.
struct AppliedChange {
    std::size_t change = 0;
    EntityId rock = 0;
    double time = 0; ///< s
};

/// What a rock does at present. The motion detector is on while it is armed.
enum class Activity { asleep, armed, sampling, empty };

/// Energy used so far, by purpose, J.
struct EnergyUse {
    double standing = 0; ///< asleep and armed; of a host: while it listens
    double sampling = 0, sending = 0;
    double contact = 0; ///< listening for new settings
    double total() const { return standing + sampling + sending + contact; }
};

/// A rock of the network, and what it keeps in its memory.
struct NetworkRock {
    std::uint32_t host = 0;
    InstalledRockSettings settings = {};
    Activity activity = Activity::asleep;
    double charge = 0; ///< J, left in the battery
    EnergyUse use = {};
    double empty_at = std::numeric_limits<double>::infinity(); ///< s, when the battery was empty
    std::uint64_t samples = 0;                                 ///< taken
    std::uint64_t packets_made = 0; ///< those for which its buffer had no room included
    std::uint64_t version = 0;      ///< events of earlier sessions do nothing
    double updated = 0;             ///< s, of its energy
    double session_end = 0;         ///< s
    std::uint64_t next = 0;         ///< base sample that is packed next
    std::size_t changes_known = 0;  ///< changes at the host that were applied
    std::uint64_t block = 0;        ///< of 1 s, whose mean square is summed
    double squares = 0, count = 0;
    std::size_t warned_train = std::numeric_limits<std::size_t>::max();
};

struct NetworkHost {
    double charge = 0; ///< J
    EnergyUse use = {};
    double gained = 0, spilled = 0; ///< J, from the solar panel; for which there was no room
    bool is_down = false;
};

/// Counts of a link. Packets in flight have left the buffer and not arrived.
struct LinkCounts {
    std::uint64_t offered = 0, delivered = 0, lost_on_air = 0, lost_full = 0, transmissions = 0;
    std::uint64_t in_flight = 0, buffered = 0, buffered_bytes = 0, largest_buffered_bytes = 0;
};

struct NetworkLink {
    LinkProperties properties = {};
    LinkCounts counts = {};
    std::deque<Packet> queue = {};
    bool busy = false, sending = false;
    unsigned tries = 0;
};

/// A sensor network as a sequence of events: rocks wake by their timetable, by motion or
/// periodically, sample, fill packets and send them to their host, which stores and forwards them
/// to the cloud. Links lose, delay and interrupt; batteries empty, and the sun charges those of the
/// hosts. One thread; all numbers follow from the settings, the truth and the seed.
class NetworkSimulation {
public:
    NetworkSimulation(const NetworkSettings& settings, const Truth& truth, std::uint64_t seed);
    /// Runs to the end of the truth.
    void run();

    const std::vector<NetworkRock>& rocks() const { return rocks_; }
    const std::vector<NetworkHost>& hosts() const { return hosts_; }
    /// Those of the rocks, then those of the hosts.
    const std::vector<NetworkLink>& links() const { return links_; }
    std::uint64_t bytes_received() const { return bytes_received_; } ///< by the cloud
    PacketBalance balance() const;
    /// Data packets with samples under trains, in order of arrival.
    const std::vector<Received>& received() const { return received_; }
    const std::vector<Received>& warnings() const { return warnings_; }
    const std::vector<AppliedChange>& applied_changes() const { return applied_; }

private:
    enum class Kind {
        wake,
        stop,
        look,
        trigger,
        packet_full,
        contact,
        sent,
        retry,
        arrival,
        host_tick,
        change
    };
    struct Event {
        double time;
        std::uint64_t order; // of events at the same time: as they were added
        Kind kind;
        std::uint32_t entity;
        std::uint64_t version; // of the rock's session, or the index of a train or a change
        Packet packet = {};
        bool operator>(const Event& other) const {
            return time != other.time ? time > other.time : order > other.order;
        }
    };
    struct HostChange {
        std::size_t change;
        double time; // s, when it is at the host
    };

    void add(double time, Kind kind, std::uint32_t entity, std::uint64_t version = 0,
             const Packet& packet = {});
    void handle(const Event& event);

    // rocks
    void start(EntityId rock, double time);
    void wake(EntityId rock, double time);
    void sample_from(EntityId rock, double time, double first_time, double end);
    void stop(EntityId rock, double time);
    void look(EntityId rock, double time, std::size_t train);
    void trigger(EntityId rock, double time, std::size_t train);
    void packet_full(EntityId rock, double time);
    void schedule_packet(EntityId rock, double time);
    void make_packet(EntityId rock, double time, std::uint32_t samples);
    void check_warning(EntityId rock, double time, const Packet& packet);
    void contact(EntityId rock, double time);
    bool apply_changes(EntityId rock, double time);
    void next_wake(EntityId rock, double time);
    bool update_energy(EntityId rock, double time);
    double standing_power(const NetworkRock& rock) const;

    // links and hosts
    void offer(std::uint32_t link, const Packet& packet, double time);
    void try_to_send(std::uint32_t link, double time);
    void sent(std::uint32_t link, double time);
    void arrive(std::uint32_t link, double time, const Packet& packet);
    void host_tick(std::uint32_t host, double time);
    double up_from(std::uint32_t link, double time, double airtime) const;
    bool is_rock_link(std::uint32_t link) const { return link < settings_.rocks; }
    std::uint32_t host_of_link(std::uint32_t link) const;

    static constexpr double tick = 600; // s, between updates of the energy of a host

    NetworkSettings settings_;
    const Truth& truth_;
    std::uint64_t seed_;
    std::priority_queue<Event, std::vector<Event>, std::greater<>> events_;
    std::uint64_t added_ = 0;
    std::vector<NetworkRock> rocks_;
    std::vector<RockSignal> signals_; // of the rocks
    std::vector<NetworkHost> hosts_;
    std::vector<NetworkLink> links_;
    std::uint64_t packets_received_ = 0, bytes_received_ = 0; // by the cloud
    std::vector<HostChange> host_changes_; // by the time at which they were given
    std::vector<Received> received_, warnings_;
    std::vector<AppliedChange> applied_;
};

} // namespace bris
