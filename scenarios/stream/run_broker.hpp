#pragma once

#include "engine/io/broker_client.hpp"
#include "engine/scenario.hpp"
#include "scenarios/sensors/recording.hpp"
#include "scenarios/stream/broker_lines.hpp"
#include "scenarios/stream/logged_lines.hpp"
#include "scenarios/stream/logged_link.hpp"

#include <filesystem>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace bris {

/// Settings of what a run has to do with a broker, and of its log.
struct RunBrokerSettings {
    BrokerSettings client;
    double history = 4; ///< GiB
    void declare_options(auto& option) {
        client.declare_options(option);
        option("broker_session", client.session, "",
               "Name under which the broker keeps records after this program was interrupted, for "
               "the next run with that name. Empty: none are kept then.");
        option("broker_history", history, "GiB",
               "Largest size of stream.ndjson, the log of all that came and was published. 0: no "
               "log, so that records cannot be replayed, nor used by a run that is resumed.",
               within(0, 1000));
    }
};

/// Name of the log in the folder of the results.
constexpr auto log_name = "stream.ndjson";

/// Begins the log of a run, or goes on with that of the run that is resumed; null: there is to be
/// none. Any other log that is there is kept under another name, since it may be the only copy of a
/// test. `stream`: where records come from, which may not be the log. Throws InputError,
/// OutputError.
std::shared_ptr<StreamLog> begin_log(const RunBrokerSettings& settings, LoggedRecords records,
                                     const std::filesystem::path& stream, const Common& common);
/// Goes on with the arrivals of the run that is resumed, if there is one that has a log. To be
/// called before anything arrives.
void go_on_with_arrivals(const Common& common);
/// What the log left out, in one line; empty: nothing.
std::string report_on_log(const StreamLog* log, const RunBrokerSettings& settings);

/// The broker of a run: a connection, or the log of an earlier run that gives the same messages
/// again, or both, for then the results are published anew.
class RunBroker {
public:
    /// Whether a run with these settings has any. `stream`: where records come from instead.
    static bool is_needed(const RunBrokerSettings& settings, const std::filesystem::path& stream) {
        return !settings.client.address.empty() ||
               records_of_log(stream) == LoggedRecords::messages;
    }
    /// Connects. Records come from a log if `stream` is one of messages, from other lines if it is
    /// anything else, and from the broker if it is empty. `speed`: of a log, relative to the times
    /// of arrival; 0: at once. A broker without an answer is an error where records come from it;
    /// otherwise the run goes on, with one line on stderr, and connects later.
    RunBroker(const RunBrokerSettings& settings, const std::filesystem::path& stream, double speed,
              const Common& common);

    /// From now on all messages are logged, after those of its earlier sessions have been given
    /// again.
    void keep_in(std::shared_ptr<StreamLog> log) { logged_.emplace(source(), std::move(log)); }
    /// Whether records come from here.
    bool gives_records() const { return gives_records_; }
    /// The records, as lines; called once.
    std::unique_ptr<BrokerLines> lines(const std::vector<SensorInfo>& infos) {
        return std::make_unique<BrokerLines>(link(), infos);
    }
    BrokerLink& link() { return logged_ ? *logged_ : source(); }
    /// Name of the run in its signs of life and alarms: of its session, else of its scenario.
    const std::string& name() const { return name_; }
    /// What the run does from now on, for its signs of life, and the time (s) until that is done;
    /// NaN: unknown.
    void report_doing(const std::string& doing,
                      double left = std::numeric_limits<double>::quiet_NaN());
    /// Waits a moment for the last publications and ends the session.
    void finish();

private:
    BrokerLink& source() {
        if (replayed_) return *replayed_;
        return *client_;
    }

    std::string name_;
    bool gives_records_;
    std::optional<BrokerClient> client_;
    std::optional<ReplayedLink> replayed_;
    std::optional<LoggedLink> logged_;
};

} // namespace bris
