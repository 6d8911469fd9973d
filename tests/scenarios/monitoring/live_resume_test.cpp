// A test that comes over a broker: interrupted, resumed, and told as one story by its log.
#include "engine/io/whole_file.hpp"
#include "scenarios/stream/recorded_stream.hpp"
#include "scenarios/stream/recording_replay.hpp"
#include "scenarios/stream/stream_log.hpp"
#include "tests/scenarios/faults/process.hpp"
#include "tests/scenarios/monitoring/test_broker.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <thread>

using namespace bris;
using bris::testing::TestBroker;

namespace {

namespace fs = std::filesystem;
using Words = std::vector<std::string>;

Words with(Words words, const Words& more) {
    words.insert(words.end(), more.begin(), more.end());
    return words;
}

/// A specimen that is made in a second.
Words small_specimen() {
    const fs::path specimen = fs::path(BRIS_SOURCE) / "tests" / "scenarios" / "small";
    return {"--quiet", "--config", (specimen / "specimen.cfg").string(), "--grading",
            (specimen / "grading.csv").string()};
}

/// The end of the test is no record: a model that has reached its last strain does not wait for it.
bool is_record(const LogEntry& m) {
    return m.kind == LogEntry::Kind::message && !m.text.starts_with("{\"end\"") &&
           (m.topic == "test_machine/record" || m.topic.ends_with("/imu"));
}

/// All records of a log, with every byte.
Words records_in(const fs::path& file) {
    Words found;
    if (!fs::exists(file)) return found;
    StreamLogReader reader(file);
    while (const auto m = reader.next())
        if (is_record(*m)) found.push_back(m->topic + " " + m->text);
    return found;
}

/// Publishes lines as the machine and the sensors would, a hundred times as fast, until so many are
/// sent.
void publish(BrokerClient& rocks, RecordingReplay& replay, std::size_t until) {
    while (replay.sent() < until && replay.advance())
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
    rocks.flush(20);
}

/// A run of live_triaxial at a broker, in a session that survives an interruption.
class LiveTest {
public:
    LiveTest(const TestBroker& broker, const fs::path& folder, const std::string& name)
        : out(folder / name) {
        const BrokerSettings settings = broker.settings("model");
        words_ = with({"live_triaxial",
                       "--broker",
                       settings.address,
                       "--broker-user",
                       "model",
                       "--broker-password-file",
                       settings.password_file.string(),
                       "--broker-session",
                       name,
                       "--members",
                       "6",
                       "--learning-strain",
                       "0.001",
                       "--recordings",
                       (folder / "recorded").string(),
                       "--compare=false",
                       "--threads",
                       "1",
                       "--out",
                       out.string()},
                      small_specimen());
    }
    Process start(const Words& more = {}) const { return Process(with(words_, more)); }

    const fs::path out;

private:
    Words words_;
};

} // namespace

TEST_SUITE("monitoring/live_resume") {
    TEST_CASE("a test over a broker that is interrupted and resumed loses no record, and ends with "
              "the same estimates") {
        TestBroker broker;
        if (!broker.runs()) return;
        const TemporaryDirectory folder;
        const fs::path recorded = folder.path() / "recorded";
        REQUIRE(run_process(with({"twin", "--variants", "none", "--record", recorded.string(),
                                  "--out", (folder.path() / "twin").string()},
                                 small_specimen()))
                    .code == 0);
        const Words lines = stream_of(recorded / "55kPa", 1.2, 1);
        BrokerClient page(broker.settings("page"), "page", {"bris/scene"});

        const LiveTest undisturbed(broker, folder.path(), "undisturbed");
        {
            Process run = undisturbed.start();
            REQUIRE(page.next(60)); // the model is there
            BrokerClient rocks(broker.settings("rocks"), "rocks", RecordingReplay::topics());
            RecordingReplay replay(rocks, lines, 100);
            publish(rocks, replay, lines.size());
            const Outcome ended = run.wait(60);
            CAPTURE(ended.err);
            REQUIRE(ended.code == 0);
        }
        const LiveTest interrupted(broker, folder.path(), "interrupted");
        {
            Process run = interrupted.start();
            BrokerClient rocks(broker.settings("rocks"), "rocks", RecordingReplay::topics());
            while (!fs::exists(interrupted.out / "live_triaxial.vtkhdf"))
                std::this_thread::sleep_for(std::chrono::milliseconds(50));
            RecordingReplay replay(rocks, lines, 100);
            publish(rocks, replay, lines.size() / 2);
            const std::size_t sent = replay.sent();
            for (int k = 0; k < 400 && records_in(interrupted.out / "stream.ndjson").size() < sent;
                 ++k)
                std::this_thread::sleep_for(std::chrono::milliseconds(50));
            run.send(SIGTERM);
            const Outcome stopped = run.wait(60); // with sanitizers a stage takes seconds
            CAPTURE(stopped.err);
            REQUIRE(stopped.code == 130);
            publish(rocks, replay, lines.size()); // while no model is there
            const Outcome resumed =
                interrupted.start({"--resume", interrupted.out.string()}).wait(60);
            CAPTURE(resumed.err);
            REQUIRE(resumed.code == 0);
        }
        CHECK(read_whole(interrupted.out / "learned.csv") ==
              read_whole(undisturbed.out / "learned.csv"));
        const Words records = records_in(undisturbed.out / "stream.ndjson");
        CHECK(records.size() == lines.size() - 1);
        CHECK(records_in(interrupted.out / "stream.ndjson") == records);

        // the log alone gives the same estimates
        const fs::path again = folder / "again";
        const Outcome replayed = run_process(
            with({"live_triaxial", "--stream", (interrupted.out / "stream.ndjson").string(),
                  "--members", "6", "--learning-strain", "0.001", "--recordings", recorded.string(),
                  "--compare=false", "--threads", "1", "--out", again.string()},
                 small_specimen()));
        CAPTURE(replayed.err);
        REQUIRE(replayed.code == 0);
        CHECK(read_whole(again / "learned.csv") == read_whole(undisturbed.out / "learned.csv"));
    }
}
