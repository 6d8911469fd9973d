#pragma once

#include "engine/component.hpp"
#include "engine/entity.hpp"

namespace bris {

// The tables of a sensor network: rocks send to hosts beside the track, and hosts to the cloud,
// each over a link of its own.

struct Rocks {
    static constexpr auto name = "rocks";
};
struct Hosts {
    static constexpr auto name = "hosts";
};
struct Clouds {
    static constexpr auto name = "clouds";
};
struct Links {
    static constexpr auto name = "links";
};

struct NodeId : State<EntityId> {
    static constexpr auto name = "id", unit = "";
    static constexpr bool is_key = true;
};
/// Of a rock: its host.
struct HostOfRock : State<EntityId> {
    static constexpr auto name = "host", unit = "";
};
/// How a rock chooses when it samples.
enum class Strategy : std::uint32_t { continuous, scheduled, triggered, duty_cycled };
/// What a rock does at present. The motion detector is on while it is armed.
enum class Activity : std::uint32_t { asleep, armed, sampling, empty };

/// Settings of a rock that can be changed after it was installed.
struct RockSettingsRow {
    double strategy = 0;            ///< Strategy
    double sampling_rate = 200;     ///< Hz
    double trigger_level = 0.4;     ///< m/s2 at which the motion detector wakes the rock
    double pre_trigger = 0.5;       ///< s before the trigger that a buffer keeps
    double post_trigger = 2;        ///< s that sampling goes on after the last trigger
    double lead = 60;               ///< s before the planned arrival at which a rock wakes
    double session = 300;           ///< s that it then samples
    double duty_period = 600;       ///< s between the beginnings of sampling
    double duty_on = 20;            ///< s of sampling
    double warning_threshold = 1.2; ///< m/s2, root mean square of 1 s from which a rock warns
};
struct RockSettings : State<RockSettingsRow> {
    static constexpr auto name = "settings", unit = "";
};
struct CurrentActivity : State<std::uint32_t> {
    static constexpr auto name = "activity", unit = "";
};
/// Energy left in the battery.
struct Charge : State<double> {
    static constexpr auto name = "charge", unit = "J";
};
/// Energy used so far, by purpose.
struct EnergyUseRow {
    double standing = 0; ///< J, asleep and armed; of a host: while it listens
    double sampling = 0; ///< J
    double sending = 0;  ///< J
    double contact = 0;  ///< J, listening for new settings
    double total() const { return standing + sampling + sending + contact; }
};
struct EnergyUse : State<EnergyUseRow> {
    static constexpr auto name = "energy_use", unit = "J";
};
/// Energy from the solar panel of a host, and the part for which its battery had no room.
struct SolarRow {
    double gained = 0, spilled = 0;
};
struct Solar : State<SolarRow> {
    static constexpr auto name = "solar", unit = "J";
};
/// Time when the battery was empty; infinity: it never was.
struct EmptyAt : State<double> {
    static constexpr auto name = "empty_at", unit = "s";
};
/// Number of samples taken.
struct SamplesTaken : State<std::uint64_t> {
    static constexpr auto name = "samples", unit = "";
};
/// Number of packets that a rock has made; a packet that its buffer had no room for included.
struct PacketsMade : State<std::uint64_t> {
    static constexpr auto name = "packets_made", unit = "";
};
/// Number of packets that reached the cloud.
struct PacketsReceived : State<std::uint64_t> {
    static constexpr auto name = "packets_received", unit = "";
};
struct BytesReceived : State<std::uint64_t> {
    static constexpr auto name = "bytes_received", unit = "B";
};

/// Properties of a link.
struct LinkRow {
    double bandwidth = 0;    ///< bit/s
    double latency = 0;      ///< s
    double jitter = 0;       ///< s, largest additional delay
    double loss = 0;         ///< probability that a transmission is not received
    double repeats = 0;      ///< transmissions of a packet after the first one was lost
    double outage_start = 0; ///< s, of the first outage
    double outage = 0;       ///< s, length of an outage
    double interval = 0;     ///< s between the beginnings of outages; 0: only the first one
    double buffer = 0;       ///< B, of the sender
};
struct LinkProperties : State<LinkRow> {
    static constexpr auto name = "properties", unit = "";
};
/// Counts of a link. Packets in flight have left the buffer and not arrived.
struct LinkCountRow {
    std::uint64_t offered = 0, delivered = 0, lost_on_air = 0, lost_full = 0, transmissions = 0;
    std::uint64_t in_flight = 0, buffered = 0, buffered_bytes = 0, largest_buffered_bytes = 0;
};
struct LinkCounts : State<LinkCountRow, std::uint64_t> {
    static constexpr auto name = "counts", unit = "";
};

} // namespace bris
