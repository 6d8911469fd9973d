// A network of SmartRocks for a day or a month: which strategy of sampling costs how much energy
// and how many bytes, and what does it still see?
#include "engine/ensemble.hpp"
#include "engine/errors.hpp"
#include "engine/io/csv.hpp"
#include "engine/io/plot.hpp"
#include "engine/report.hpp"
#include "scenarios/network/network_results.hpp"

#include <fmt/format.h>

namespace bris {

namespace {

void declare_link_options(auto& option, const std::string& name, const std::string& which,
                          LinkProperties& link) {
    option(name + "_bandwidth", link.bandwidth, "bit/s",
           "Bandwidth of the link from " + which + ".", within(1, 1e12));
    option(name + "_latency", link.latency, "s", "Delay of a packet on that link.",
           within(0, 3600));
    option(name + "_jitter", link.jitter, "s", "Largest additional delay, uniformly distributed.",
           within(0, 3600));
    option(name + "_loss", link.loss, "", "Probability that a transmission is not received.",
           within(0, 1));
    option(name + "_repeats", link.repeats, "",
           "Number of times that a packet is sent again before it is given up.", within(0, 1000));
    option(name + "_outage_start", link.outage_start, "s", "Time of the first outage.",
           within(0, 1e9));
    option(name + "_outage", link.outage, "s", "Length of an outage. 0: none.", within(0, 1e9));
    option(name + "_outage_interval", link.interval, "s",
           "Time between the beginnings of outages. 0: only one.", within(0, 1e9));
    option(name + "_buffer", link.buffer, "B",
           "Memory of the sender for packets that wait for the link.", within(1, 1e15));
}

struct Network {
    NetworkSettings settings;
    TruthSettings truth;
    std::string strategy = "all";
    std::filesystem::path changes;

    void declare_options(auto& option) {
        option.group("Network");
        option("rocks", settings.rocks, "", "Number of SmartRocks.", within(1, 1000));
        option("hosts", settings.hosts, "", "Number of hosts next to the track.", within(1, 1000));
        option("duration", truth.duration, "s", "Simulated time.", within(60, 1e9));
        option("strategy", strategy, "", "How rocks choose when they sample; all: compare all.",
               {"all", "continuous", "scheduled", "triggered", "duty_cycled"});
        option("changes", changes, "",
               "CSV file of settings that change after installation: t_s, rock (0: all), and any "
               "of strategy, sampling_rate_Hz, warning_threshold_m_per_s2 and others.");
        InstalledRockSettings& r = settings.rock;
        option.group("Rocks");
        option("sampling_rate", r.sampling_rate, "Hz", "Sampling rate, which divides 400 Hz.",
               within(1, Truth::base_rate));
        option("warning_threshold", r.warning_threshold, "m/s2",
               "Root mean square of a second from which a rock sends a warning.", above(0, 1e3));
        option("trigger_level", r.trigger_level, "m/s2",
               "Acceleration at which a triggered rock wakes.", above(0, 1e3));
        option("pre_trigger", r.pre_trigger, "s", "Time before the trigger that a buffer keeps.",
               within(0, 60));
        option("post_trigger", r.post_trigger, "s",
               "Time for which sampling goes on after the last trigger.", within(0.1, 3600));
        option("lead", r.lead, "s",
               "Time before a planned arrival at which a scheduled rock wakes.", within(0, 1e5));
        option("session", r.session, "s",
               "Time for which a scheduled rock samples after it has woken.", within(1, 1e5));
        option("duty_period", r.duty_period, "s", "Period of a duty-cycled rock.", within(1, 1e6));
        option("duty_on", r.duty_on, "s",
               "Time for which a duty-cycled rock samples in each period.", within(0.1, 1e6));
        option("packet_samples", settings.packet_samples, "", "Samples in a full packet.",
               within(1, 1e5));
        option("contact_interval", settings.contact_interval, "s",
               "Time between the contacts at which a rock that does not sample asks for new "
               "settings. 0: never.",
               within(0, 1e9));
        RockPower& p = settings.rock_power;
        option("battery", p.battery, "J", "Energy in the battery of a rock.", above(0, 1e9));
        option("sleep_power", p.asleep, "W", "Power of a rock asleep.", within(0, 100));
        option("armed_power", p.armed, "W", "Power of a rock whose motion detector is on.",
               within(0, 100));
        option("sampling_power", p.sampling, "W", "Power of a rock that samples.", within(0, 100));
        option("sample_energy", p.per_sample, "J", "Additional energy of each sample.",
               within(0, 1));
        option("sending_power", p.sending, "W", "Additional power of a rock while its radio sends.",
               within(0, 100));
        option("contact_energy", p.contact, "J", "Energy of a contact.", within(0, 100));
        declare_link_options(option, "rock", "a rock to its host", settings.rock_link);
        option.group("Hosts");
        HostPower& h = settings.host_power;
        option("host_battery", h.battery, "J", "Energy in the battery of a host.", above(0, 1e12));
        option("host_power", h.listening, "W", "Power of a host that listens.", within(0, 1e4));
        option("host_sending_power", h.sending, "W",
               "Additional power of a host while its radio sends.", within(0, 1e4));
        option("solar_panel", h.panel, "W", "Power of the solar panel of a host at noon.",
               within(0, 1e5));
        declare_link_options(option, "cloud", "a host to the cloud", settings.cloud_link);
        option.group("Truth (synthetic)");
        option("headway", truth.headway, "s", "Time between planned arrivals of trains.",
               within(60, 1e7));
        option("delay", truth.delay, "s", "Standard deviation of arrivals about the timetable.",
               within(0, 1e6));
        option("passage", truth.passage, "s", "Time that a train takes.", within(2, 1000));
        option("timetable", truth.timetable, "",
               "CSV file of trains instead: planned_s, and arrival_s if it differs.");
        option("change_time", truth.change_time, "s",
               "Time from which the ballast is in the changed state.", within(0, 1e9));
        option("changed_state", truth.changed_state, "", "State of the ballast after the change.",
               {"clean", "fouled", "loosened"});
    }
};

constexpr std::array all_strategies{Strategy::continuous, Strategy::scheduled, Strategy::triggered,
                                    Strategy::duty_cycled};

std::vector<Strategy> chosen(const Network& n) {
    std::vector<Strategy> strategies;
    for (const Strategy s : all_strategies)
        if (n.strategy == "all" || n.strategy == name_of(s)) strategies.push_back(s);
    return strategies;
}

void add(Report& summary, const StrategyResult& r) {
    Report own;
    const auto put = [&](const char* name, const auto& value) { own.add(name, value); };
    put("packets_made", r.packets.made);
    put("packets_delivered", r.packets.delivered);
    put("packets_lost_on_air", r.packets.lost_on_air);
    put("packets_lost_full", r.packets.lost_full);
    put("packets_queued", r.packets.queued);
    put("bytes_per_day", r.bytes_per_day);
    put("energy_per_day_J", r.energy_per_day);
    put("lifetime_days", r.lifetime / 86400);
    put("train_time_recorded", r.recorded_share);
    put("spectrum_error", r.spectrum_error);
    put("alarm_delay_s", r.alarm_delay);
    put("warnings", r.warnings);
    put("false_warnings", r.false_warnings);
    put("host_charge_J", r.host_least_charge);
    put("settings_changed", r.changes.size());
    own.show({"lifetime_days", "energy_per_day_J", "bytes_per_day", "packets_made",
              "packets_delivered", "train_time_recorded", "spectrum_error", "alarm_delay_s",
              "warnings", "false_warnings"});
    summary.add_part(name_of(r.strategy), own);
}

void draw(const std::filesystem::path& png, const std::vector<StrategyResult>& results) {
    Plot spectra{.title = "Spectrum of the first rock under all trains",
                 .x_label = "frequency (Hz)",
                 .y_label = "density ((m/s2)2/Hz)",
                 .y_logarithmic = true},
        error{.title = "Spectrum error and energy",
              .x_label = "energy of a rock (J/day)",
              .y_label = "relative error of the spectrum",
              .x_logarithmic = true,
              .y_logarithmic = true},
        delay{.title = "Alarm delay and data",
              .x_label = "received by the cloud (kB/day)",
              .y_label = "delay of the first warning (s)",
              .x_logarithmic = true,
              .y_logarithmic = true};
    const auto curve = [](const Spectrum& s, const char* label) {
        Curve c{label};
        for (std::size_t k = 1; k < s.density.size(); ++k) {
            c.x.push_back(s.frequency(k));
            c.y.push_back(s.density[k] > 0 ? s.density[k] : std::nan(""));
        }
        return c;
    };
    spectra.curves.push_back(curve(results.front().true_spectrum, "true"));
    for (const StrategyResult& r : results) {
        const char* const name = name_of(r.strategy);
        spectra.curves.push_back(curve(r.received_spectrum, name));
        error.curves.push_back(
            {name, {r.energy_per_day}, {r.spectrum_error}, Curve::Style::points});
        delay.curves.push_back(
            {name, {1e-3 * r.bytes_per_day}, {r.alarm_delay}, Curve::Style::points});
    }
    draw_plots(png, {spectra, error, delay}, 3);
}

void write_table(const std::filesystem::path& csv, const std::vector<StrategyResult>& results) {
    std::vector<std::vector<double>> rows;
    for (const StrategyResult& r : results)
        rows.push_back({static_cast<double>(r.strategy), r.bytes_per_day, r.energy_per_day,
                        r.lifetime / 86400, r.recorded_share, r.spectrum_error, r.alarm_delay,
                        static_cast<double>(r.false_warnings)});
    write_csv(csv,
              {"strategy", "bytes_per_day", "energy_J_per_day", "lifetime_days",
               "train_time_recorded", "spectrum_error", "alarm_delay_s", "false_warnings"},
              rows, {"strategy: 0 continuous, 1 scheduled, 2 triggered, 3 duty-cycled"}, 6);
}

void run(const Network& given, const Common& common) {
    Network n = given;
    check_rock_settings(n.settings.rock, "--strategy: ");
    require(n.settings.packet_samples == std::floor(n.settings.packet_samples),
            fmt::format("--packet-samples: expected a whole number, found {:g}",
                        n.settings.packet_samples));
    require(n.settings.contact_interval == 0 || n.settings.contact_interval >= 1,
            fmt::format("--contact-interval: expected 0 (never) or at least 1 s, found {:g} s",
                        n.settings.contact_interval));
    for (const auto& [link, name] :
         {std::pair{n.settings.rock_link, "rock"}, std::pair{n.settings.cloud_link, "cloud"}}) {
        require(
            link.repeats == std::floor(link.repeats),
            fmt::format("--{}-repeats: expected a whole number, found {:g}", name, link.repeats));
        require(link.interval == 0 || link.interval > link.outage,
                fmt::format("--{}-outage-interval: expected more than the outage of {:g} s, found "
                            "{:g} s",
                            name, link.outage, link.interval));
    }
    if (!n.changes.empty()) n.settings.changes = read_changes(n.changes, n.settings.rocks);
    const Truth truth(n.truth, common.seed);
    const std::vector<Strategy> strategies = chosen(n);
    std::vector<StrategyResult> results(strategies.size());
    run_ensemble(strategies.size(), common.threads, [&](std::size_t k) {
        NetworkSettings settings = n.settings;
        settings.rock.strategy = strategies[k];
        NetworkSimulation simulation(settings, truth, common.seed);
        simulation.run();
        results[k] = result_of(simulation, settings, truth);
    });
    Report summary;
    summary.add("trains", truth.trains().size());
    for (const StrategyResult& r : results) {
        require(r.packets.made == r.packets.delivered + r.packets.lost() + r.packets.queued,
                "packets: expected made = delivered + lost + queued");
        add(summary, r);
    }
    summary.show({"trains"});
    write_table(common.out / "strategies.csv", results);
    draw(common.out / "smartrock_net.png", results);
    report_results(common, summary);
}

} // namespace

} // namespace bris

int main(int argc, char** argv) {
    return bris::run_scenario<bris::Network>(
        argc, argv,
        {.name = "smartrock_net",
         .description = "Simulates a network of SmartRocks, hosts and the cloud, and compares "
                        "strategies of sampling on one truth.",
         .cannot_resume = "a day of a network is simulated in seconds",
         .cannot_explain = "it runs events, not time steps"},
        bris::run);
}
