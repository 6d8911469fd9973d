// Whether those who listen at the broker know that a run is alive, and what they take for granted.
#include "tests/scenarios/faults/process.hpp"
#include "tests/scenarios/monitoring/test_broker.hpp"

#include <doctest/doctest.h>

#include <csignal>
#include <map>

using namespace bris;
using bris::testing::TestBroker;

namespace {

bool has(const std::string& text, const std::string& part) {
    return text.find(part) != std::string::npos;
}

/// The next message of a topic; empty: none came in time.
std::string next_of(BrokerClient& client, const std::string& topic, double seconds = 20) {
    const Instant began = this_instant();
    while (seconds_since(began) < seconds)
        if (const auto m = client.next(0.5); m && m->topic == topic) return m->payload;
    return {};
}

} // namespace

TEST_SUITE("monitoring/alive") {
    TEST_CASE(
        "a monitor gives signs of life, knows nothing before it has judged, and is gone within "
        "seconds when it is killed") {
        TestBroker broker;
        if (!broker.runs()) return;
        const TemporaryDirectory folder;
        const auto in = [&](const char* name) { return (folder.path() / name).string(); };
        REQUIRE(run_process({"monitor", "--write-example", in("example"), "--example-sensors", "2",
                             "--example-duration", "8", "--out", in("made"), "--quiet"})
                    .code == 0);
        const auto settings = broker.settings("model");
        const std::vector<std::string> words{"monitor",
                                             "--broker",
                                             settings.address,
                                             "--broker-user",
                                             "model",
                                             "--broker-password-file",
                                             settings.password_file.string(),
                                             "--baseline",
                                             in("example/baseline"),
                                             "--out",
                                             in("day"),
                                             "--quiet"};
        BrokerClient page(broker.settings("page"), "page", {"bris/run/#", "smartrock/+/alarm"});
        {
            Process day(words);
            std::map<std::string, std::string> alarms;
            std::string beat;
            unsigned beats = 0;
            const Instant began = this_instant();
            while (beats < 3 && seconds_since(began) < 30) {
                const auto m = page.next(0.5);
                if (!m) continue;
                if (m->topic.ends_with("/alarm")) alarms[m->topic] = m->payload;
                if (m->topic == "bris/run/monitor/gone") CHECK(has(m->payload, "false"));
                if (m->topic != "bris/run/monitor") continue;
                CHECK(has(m->payload, R"("state":"running")"));
                ++beats;
                beat = m->payload;
            }
            CHECK(beats == 3);
            CHECK(has(beat, "nothing judged yet"));
            REQUIRE(alarms.size() == 2);
            for (const auto& [topic, alarm] : alarms) CHECK(has(alarm, R"("state":"unknown")"));
            day.send(SIGKILL);
            const Instant killed = this_instant();
            CHECK(has(next_of(page, "bris/run/monitor/gone"), "true"));
            CHECK(seconds_since(killed) < 5);
        }
        { // for who comes later, too; and the next run is there again
            BrokerClient late(broker.settings("page"), "late", {"bris/run/monitor/gone"});
            CHECK(has(next_of(late, "bris/run/monitor/gone"), "true"));
            Process again(words);
            CHECK(has(next_of(late, "bris/run/monitor/gone"), "false"));
            again.send(SIGTERM);
            CHECK(again.wait(30).code == 130);
        }
        BrokerClient later(broker.settings("page"), "later", {"bris/run/monitor"});
        CHECK(has(next_of(later, "bris/run/monitor"), R"("state":"stopped")"));
    }
}
