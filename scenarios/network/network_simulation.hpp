#pragma once

#include "engine/world.hpp"
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

/// A sensor network as a sequence of events: rocks wake by their timetable, by motion or
/// periodically, sample, fill packets and send them to their host, which stores and forwards them
/// to the cloud. Links lose, delay and interrupt; batteries empty, and the sun charges those of the
/// hosts. Rocks, hosts, the cloud and links are rows of tables of their own (tables.hpp). One
/// thread; all numbers follow from the settings, the truth and the seed.
class NetworkSimulation {
public:
    NetworkSimulation(const NetworkSettings& settings, const Truth& truth, std::uint64_t seed);
    /// Runs to the end of the truth.
    void run();

    const World& world() const { return world_; }
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
    /// What a rock keeps in its memory beside its row.
    struct RockMemory {
        std::uint64_t version = 0;     // events of earlier sessions do nothing
        double updated = 0;            // s, of its energy
        double session_end = 0;        // s
        std::uint64_t next = 0;        // base sample that is packed next
        std::size_t changes_known = 0; // entries of host_changes_ that were applied
        std::uint64_t block = 0;       // of 1 s, whose mean square is summed
        double squares = 0, count = 0;
        std::size_t warned_train = std::numeric_limits<std::size_t>::max();
    };
    struct LinkMemory {
        std::deque<Packet> queue;
        bool busy = false, sending = false;
        unsigned tries = 0;
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
    void set_activity(EntityId rock, Activity activity);
    double standing_power(EntityId rock) const;
    Activity activity(EntityId rock) const;
    const RockSettingsRow& settings_of(EntityId rock) const;

    // links and hosts
    void offer(std::uint32_t link, const Packet& packet, double time);
    void try_to_send(std::uint32_t link, double time);
    void sent(std::uint32_t link, double time);
    void arrive(std::uint32_t link, double time, const Packet& packet);
    void host_tick(std::uint32_t host, double time);
    double up_from(std::uint32_t link, double time, double airtime) const;
    bool is_rock_link(std::uint32_t link) const { return link < settings_.rocks; }
    std::uint32_t host_of_link(std::uint32_t link) const;
    LinkRow& properties(std::uint32_t link);
    const LinkRow& properties(std::uint32_t link) const;
    LinkCountRow& counts(std::uint32_t link);

    NetworkSettings settings_;
    const Truth& truth_;
    std::uint64_t seed_;
    World world_;
    std::priority_queue<Event, std::vector<Event>, std::greater<>> events_;
    std::uint64_t added_ = 0;
    std::vector<RockMemory> rocks_;
    std::vector<RockSignal> signals_;
    std::vector<LinkMemory> links_;
    std::vector<char> host_down_;
    std::vector<HostChange> host_changes_; // by the time at which they were given
    std::vector<Received> received_, warnings_;
    std::vector<AppliedChange> applied_;
};

} // namespace bris
