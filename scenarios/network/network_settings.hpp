#pragma once

#include "engine/entity.hpp"
#include "scenarios/network/truth.hpp"

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace bris {

/// How a rock chooses when it samples.
enum class Strategy : std::uint32_t { continuous, scheduled, triggered, duty_cycled };

/// Settings of a rock that can be changed after it was installed.
struct InstalledRockSettings {
    Strategy strategy = Strategy::continuous;
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

/// Properties of a link.
struct LinkProperties {
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

/// Power and energy of a rock. Defaults are orders of magnitude of common devices, not measured.
struct RockPower {
    double battery = 29e3;    ///< J, 2.2 Ah at 3.7 V
    double asleep = 30e-6;    ///< W
    double armed = 300e-6;    ///< W, with motion detector and its buffer
    double sampling = 4e-3;   ///< W while sampling, besides each sample
    double per_sample = 5e-6; ///< J
    double sending = 40e-3;   ///< W while the radio sends
    double contact = 1e-3;    ///< J to listen for new settings
};

struct HostPower {
    double battery = 180e3; ///< J
    double listening = 0.5; ///< W
    double sending = 1.5;   ///< W, besides listening
    double panel = 10;      ///< W at noon: peak * max(0, sin(2 pi (t - 6 h) / 24 h))
};

/// A change of the settings of rocks after they were installed, given to the cloud at a time.
struct SettingsChange {
    double time = 0; ///< s
    EntityId rock = 0;
    bool all = true; ///< of all rocks
    std::optional<Strategy> strategy = {};
    std::vector<std::pair<double InstalledRockSettings::*, double>> values =
        {}; ///< of other settings
};

struct NetworkSettings {
    unsigned rocks = 4, hosts = 1;
    InstalledRockSettings rock;
    RockPower rock_power;
    HostPower host_power;
    double sample_bytes = 6, header_bytes = 20, warning_bytes = 32;
    double packet_samples = 80;     ///< samples in a full packet
    double contact_interval = 3600; ///< s between contacts for new settings; each wake is one too
    LinkProperties rock_link{.bandwidth = 250e3,
                             .latency = 5e-3,
                             .jitter = 5e-3,
                             .loss = 0.02,
                             .repeats = 3,
                             .outage_start = 20e3,
                             .outage = 600,
                             .interval = 30e3,
                             .buffer = 1 << 20};
    LinkProperties cloud_link{.bandwidth = 2e6,
                              .latency = 0.05,
                              .jitter = 0.05,
                              .loss = 0.005,
                              .repeats = 5,
                              .outage_start = 40e3,
                              .outage = 1200,
                              .interval = 40e3,
                              .buffer = 64 << 20};
    std::vector<SettingsChange> changes;
};

/// "continuous", "scheduled", "triggered", "duty_cycled".
const char* name_of(Strategy strategy);

/// Reads changes of settings: a CSV file with the columns t_s, rock (0: all; otherwise numbered
/// from 1) and any of strategy (0 continuous, 1 scheduled, 2 triggered, 3 duty-cycled),
/// sampling_rate_Hz, trigger_level_m_per_s2, pre_trigger_s, post_trigger_s, lead_s, session_s,
/// duty_period_s, duty_on_s and warning_threshold_m_per_s2; an empty cell changes nothing. Throws
/// InputError with file:line, what was expected and what was found.
std::vector<SettingsChange> read_changes(const std::filesystem::path& csv, unsigned rocks);

/// Throws InputError, beginning with `where`, unless the settings can be used together.
void check_rock_settings(const InstalledRockSettings& settings, const std::string& where);

} // namespace bris
