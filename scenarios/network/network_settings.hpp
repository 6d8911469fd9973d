#pragma once

#include "scenarios/network/tables.hpp"
#include "scenarios/network/truth.hpp"

#include <filesystem>
#include <string>
#include <vector>

namespace bris {

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
    /// Names and new values, as in RockSettingsRow.
    std::vector<std::pair<double RockSettingsRow::*, double>> values;
};

struct NetworkSettings {
    unsigned rocks = 4, hosts = 1;
    RockSettingsRow rock;
    RockPower rock_power;
    HostPower host_power;
    double sample_bytes = 6, header_bytes = 20, warning_bytes = 32;
    double packet_samples = 80;     ///< samples in a full packet
    double contact_interval = 3600; ///< s between contacts for new settings; each wake is one too
    LinkRow rock_link{.bandwidth = 250e3,
                      .latency = 5e-3,
                      .jitter = 5e-3,
                      .loss = 0.02,
                      .repeats = 3,
                      .outage_start = 20e3,
                      .outage = 600,
                      .interval = 30e3,
                      .buffer = 1 << 20};
    LinkRow cloud_link{.bandwidth = 2e6,
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
void check_rock_settings(const RockSettingsRow& settings, const std::string& where);

} // namespace bris
