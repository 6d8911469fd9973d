#pragma once

#include "engine/io/broker_client.hpp"
#include "engine/io/broker_history.hpp"
#include "engine/scenario.hpp"
#include "scenarios/recordings/broker_lines.hpp"
#include "scenarios/recordings/recording.hpp"

#include <filesystem>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace bris {

/// Settings of what a run has to do with a broker.
struct RunBrokerSettings {
    BrokerSettings client;
    double history = 4; ///< GiB
    void describe(auto& option) {
        client.describe(option);
        option("broker_session", client.session, "",
               "Name under which the broker keeps records after this program was interrupted, for "
               "the next run with that name. Empty: none are kept then.");
        option("broker_history", history, "GiB",
               "Largest size of the history, all that came from the broker and was published, in "
               "the run file. 0: no history.",
               within(0, 1000));
    }
};

/// The broker of a run: a connection, or the history of an earlier run that gives the same messages
/// again, or both, for then the results are published anew; and the history that is kept.
class RunBroker {
public:
    /// Whether a run with these settings has any. `stream`: where records come from instead.
    static bool is_needed(const RunBrokerSettings& settings, const std::filesystem::path& stream) {
        return !settings.client.address.empty() || is_hdf5(stream);
    }
    /// Connects. Records come from a history if `stream` is a run file, from other lines if it is
    /// anything else, and from the broker if it is empty. `speed`: of a history, relative to the
    /// times of arrival; 0: at once. A broker without an answer is an error where records come from
    /// it; otherwise the run goes on, with one line on stderr, and connects later.
    RunBroker(const RunBrokerSettings& settings, const std::filesystem::path& stream, double speed,
              const Common& common);

    /// From now on all messages are kept in this file, after those of the run `earlier` that is
    /// resumed (empty: none). The file has to be open until `finish`.
    void keep_in(Hdf5File& file, const std::filesystem::path& earlier = {});
    /// Whether records come from here.
    bool gives_records() const { return gives_records_; }
    /// The records, as lines; called once.
    std::unique_ptr<BrokerLines> lines(const std::vector<SensorInfo>& infos) {
        return std::make_unique<BrokerLines>(link(), infos);
    }
    BrokerLink& link() { return recorded_ ? *recorded_ : source(); }
    /// Name of the run in its signs of life and alarms: of its session, else of its scenario.
    const std::string& name() const { return name_; }
    /// What the run does from now on, for its signs of life, and the time (s) until that is done;
    /// NaN: unknown.
    void report_doing(const std::string& doing,
                      double left = std::numeric_limits<double>::quiet_NaN());
    /// Waits a moment for the last publications, ends the session and writes the history.
    void finish();
    /// What the history left out; empty: nothing.
    std::string report() const;

private:
    BrokerLink& source() {
        if (replayed_) return *replayed_;
        return *client_;
    }

    std::string name_;
    double history_;
    bool gives_records_;
    std::optional<BrokerClient> client_;
    std::optional<ReplayedLink> replayed_;
    std::optional<BrokerHistory> kept_;
    std::optional<RecordedLink> recorded_;
};

/// Renames the run file of the run that is resumed, so that a new one can be written in its place.
/// Returns its path; empty: there is none.
std::filesystem::path put_aside_run_file(const Common& common, const std::string& name);

} // namespace bris
