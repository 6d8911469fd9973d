// The whole live system on one computer: a broker, the sample recordings as sensors and test
// machine, the model that follows them, and the page that shows it.
#include "engine/assets.hpp"
#include "engine/child_program.hpp"
#include "engine/errors.hpp"
#include "engine/interrupt.hpp"
#include "engine/io/broker_client.hpp"
#include "engine/io/json_members.hpp"
#include "engine/scenario.hpp"
#include "engine/stopwatch.hpp"
#include "engine/summary.hpp"
#include "scenarios/monitoring/published_numbers.hpp"
#include "scenarios/records/recorded_test.hpp"
#include "scenarios/stream/local_broker.hpp"
#include "scenarios/stream/log_replay.hpp"
#include "scenarios/stream/recorded_stream.hpp"
#include "scenarios/stream/recording_replay.hpp"

#include <fmt/format.h>

#include <chrono>
#include <cstdio>
#include <optional>
#include <thread>

namespace bris {

namespace {

struct Demo {
    std::filesystem::path recordings = assets_folder() / "smartrock" / "55kPa", history;
    double speed = 2, final_strain = 0.01, start = 0, keep = 0;
    std::string preparation = "report"; // as the specimen of the example, which was not tapped
    unsigned bodies = 400, members = 6, taps = 0;
    std::string host = "127.0.0.1";
    unsigned port = 0;

    void declare_options(auto& option) {
        option("recordings", recordings, "",
               "Folder with recordings.csv and test.csv of a test at 55 kPa; the folder above it "
               "has the metadata of the sensors.");
        option(
            "history", history, "",
            "Log (stream.ndjson) of a run of live_triaxial or monitor. The page shows again what "
            "came over the broker in that run, and no model runs.");
        option("speed", speed, "", "Speed of the replay relative to the times of the records.",
               within(0.01, 1e4));
        option("final_axial_strain", final_strain, "", "Axial strain at which the model ends.",
               within(0.001, 0.08));
        option("bodies", bodies, "", "Number of rocks in the model, sensor rocks included.",
               within(20, 1e5));
        option("preparation", preparation, "",
               "Core porosity of the model's specimen, which should be that of the recorded test: "
               "report is 0.32, laboratory is 0.38.",
               {"laboratory", "report"});
        option("taps", taps, "", "Smallest number of taps with which its preparation ends.",
               within(0, 1000));
        option("members", members, "", "Number of ensemble members.", within(6, 1000));
        option(
            "host", host, "",
            "Address on which the page and its websockets listen. With another address than that "
            "of the loopback, anybody who can reach this computer can read and send.");
        option("port", port, "", "Port of the page. 0: a free one.", within(0, 65535));
        option("start_after", start, "s",
               "Time that passes before the replay begins, after the model has made its specimen "
               "(with "
               "--history: after the page is there).",
               within(0, 1e6));
        option("keep", keep, "s", "Time for which the page stays after the end.", within(0, 1e7));
    }
};

void pause(double seconds) {
    const Instant began = this_instant();
    while (seconds_since(began) < seconds && !interrupted())
        std::this_thread::sleep_for(std::chrono::milliseconds(10));
}

std::vector<std::string> words_of_model(const Demo& d, const Common& common,
                                        const std::string& broker) {
    const auto program = this_program().parent_path() / "live_triaxial";
    const std::string out = (common.out / "model").string();
    std::vector<std::string> words{program.string(),
                                   "--broker",
                                   broker,
                                   "--out",
                                   out,
                                   "--recordings",
                                   d.recordings.parent_path().string(),
                                   "--bodies",
                                   std::to_string(d.bodies),
                                   "--members",
                                   std::to_string(d.members),
                                   "--final-axial-strain",
                                   fmt::format("{:g}", d.final_strain),
                                   "--compare=false",
                                   "--least-diameter",
                                   "1",
                                   "--preparation",
                                   d.preparation,
                                   "--taps",
                                   std::to_string(d.taps),
                                   "--threads",
                                   std::to_string(common.threads),
                                   "--seed",
                                   std::to_string(common.seed)};
    if (common.quiet) words.emplace_back("--quiet");
    return words;
}

/// What a run that published was called, which its alarms say.
std::string name_of_run(const std::filesystem::path& log) {
    StreamLogReader reader(log);
    while (const auto entry = reader.next()) {
        if (entry->kind != LogEntry::Kind::published || !entry->topic.ends_with("/alarm")) continue;
        JsonMembers members(entry->text);
        while (const auto member = members.next())
            if (member->name == "run") return json_text(member->value).value_or("");
    }
    return "history";
}

/// How a message of a log is published again: sensors and pages retain what describes a state.
BrokerLink::Delivery delivery_of(const LogEntry& m) {
    const bool of_state = m.topic.ends_with("/config") || m.topic.ends_with("/config/ack") ||
                          m.topic.ends_with("/status");
    return m.retained || of_state ? BrokerLink::Delivery::retained
                                  : BrokerLink::Delivery::at_least_once;
}

/// Publishes all that a run received and published, in its order and at its times.
void show_history(const Demo& d, const Common& common, BrokerClient& client) {
    std::size_t shown = 0;
    pause(d.start);
    LogReplay replay(d.history, d.speed);
    while (!replay.over()) {
        const auto m = replay.next(1);
        if (interrupted()) throw Interrupted("interrupted");
        const bool is_message =
            m && (m->kind == LogEntry::Kind::message || m->kind == LogEntry::Kind::published);
        if (!is_message || m->topic == BrokerLink::own_topic) continue;
        const Instant due = this_instant();
        bool sent = false;
        while (!(sent = client.publish(m->topic, m->text, delivery_of(*m))) &&
               seconds_since(due) < 5)
            pause(0.005); // too many are on their way
        shown += static_cast<std::size_t>(sent);
    }
    client.flush(10);
    client.signs_of_life()->report("all is shown");
    pause(d.keep);
    client.signs_of_life()->end();
    Summary summary;
    summary.add("messages_shown", shown);
    report_results(common, summary);
}

void run(const Demo& d, const Common& common) {
    const bool is_replay = !d.history.empty();
    require(!is_replay || records_of_log(d.history) == LoggedRecords::messages,
            fmt::format("--history: expected the log (stream.ndjson) of a run over a broker, found "
                        "'{}'",
                        d.history.string()));
    const SavesWhenInterrupted saves("the model's results so far are written");
    LocalBroker broker(
        {common.out, assets_folder() / "live_page", d.host, static_cast<int>(d.port)});
    fmt::print("page: {}\n", broker.page());
    std::fflush(stdout);
    BrokerSettings settings;
    settings.address = broker.address();
    if (is_replay) {
        settings.run = name_of_run(d.history);
        BrokerClient client(settings, "history", {});
        client.signs_of_life()->report("showing again what passed over the broker, " +
                                       d.history.string());
        client.publish("bris/numbers", published_table(), BrokerLink::Delivery::retained);
        return show_history(d, common, client);
    }
    const auto lines = stream_of(d.recordings, 1.2, QualityControlSettings{}.rest);
    auto topics = RecordingReplay::topics();
    topics.emplace_back("bris/scene");
    BrokerClient client(settings, "sensors", topics);
    ChildProgram model(words_of_model(d, common, broker.address()));
    // the scene says that the specimen is made: the test begins
    bool is_ready = false;
    while (!is_ready && model.runs() && !interrupted())
        if (const auto message = client.next(0.1)) is_ready = message->topic == "bris/scene";
    pause(d.start);
    RecordingReplay replay(client, lines, d.speed);
    while (replay.advance() && model.runs() && !interrupted()) pause(0.01);
    while (model.runs() && !interrupted()) {
        (void)replay.advance(); // settings are acknowledged until the end
        pause(0.05);
    }
    const Instant ended = this_instant();
    while (seconds_since(ended) < d.keep && !interrupted()) {
        (void)replay.advance();
        pause(0.05);
    }
    if (interrupted()) throw Interrupted("interrupted; the model's results so far are written");
    if (model.exit_code() != 0)
        throw SimulationError(fmt::format("the model ended with exit code {}", model.exit_code()));
    Summary summary;
    summary.add("records_sent", replay.sent());
    summary.add("records_withheld", replay.withheld());
    summary.add("breaks_of_connection", client.counters().breaks);
    report_results(common, summary);
}

} // namespace

} // namespace bris

int main(int argc, char** argv) {
    return bris::run_scenario<bris::Demo>(
        argc, argv,
        {.name = "live_demo",
         .description = "Runs a broker, a replay of the sample recordings, the model that follows "
                        "them and the page that shows the rocks.",
         .cannot_resume = "it is a replay; the model's own results are in the folder model",
         .cannot_explain = "it runs no time steps itself"},
        bris::run);
}
