// A day over a real broker, and the same day again from its log.
#include "engine/errors.hpp"
#include "engine/io/whole_file.hpp"
#include "scenarios/stream/recording_replay.hpp"
#include "scenarios/stream/stream_log.hpp"
#include "tests/scenarios/faults/process.hpp"
#include "tests/scenarios/monitoring/passage_lines.hpp"
#include "tests/scenarios/monitoring/test_broker.hpp"

#include <doctest/doctest.h>
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <fstream>
#include <optional>
#include <thread>

using namespace bris;
using bris::testing::lines_of_passages;
using bris::testing::TestBroker;

namespace {

namespace fs = std::filesystem;

/// What a run published of alarms and numbers of sensors, one after the other, with every byte.
std::vector<std::string> verdicts_in(const fs::path& file) {
    std::vector<std::string> found;
    StreamLogReader reader(file);
    while (const auto m = reader.next())
        if (m->kind == LogEntry::Kind::published &&
            (m->topic.starts_with("bris/sensor/") || m->topic.ends_with("/alarm")))
            found.push_back(m->topic + " " + m->text);
    return found;
}

std::vector<std::string> topics() { return {"bris/#", "smartrock/+/status"}; }

} // namespace

TEST_SUITE("monitoring/history") {
    TEST_CASE("a day is replayed from its log with the same alarms and states, bit for bit") {
        TestBroker broker;
        if (!broker.runs()) return;
        const TemporaryDirectory folder;
        const auto in = [&](const char* name) { return (folder.path() / name).string(); };
        REQUIRE(run_process({"monitor", "--write-example", in("example"), "--example-sensors", "2",
                             "--example-duration", "8", "--example-passages", "2", "--out",
                             in("made"), "--quiet"})
                    .code == 0);
        const auto settings = broker.settings("model");
        Process day({"monitor", "--broker", settings.address, "--broker-user", "model",
                     "--broker-password-file", settings.password_file.string(), "--baseline",
                     in("example/baseline"), "--window", "20", "--out", in("day"), "--quiet"});
        BrokerClient page(broker.settings("page"), "page", {"bris/health", "smartrock/+/alarm"});
        REQUIRE(page.next(60)); // bris/health: the monitor is there
        auto topics = RecordingReplay::topics();
        BrokerClient rocks(broker.settings("rocks"), "rocks", topics);
        page.publish(
            "smartrock/1/config",
            R"({"revision": 1, "rate_hz": 5000, "strategy": "continuous", "threshold": 1})",
            BrokerLink::Delivery::retained);
        std::this_thread::sleep_for(std::chrono::milliseconds(300));
        RecordingReplay replay(rocks, lines_of_passages(folder.path() / "example" / "recordings"),
                               1e4);
        rocks.publish("smartrock/1/imu", "no payload", BrokerLink::Delivery::at_least_once);
        while (replay.advance()) std::this_thread::sleep_for(std::chrono::milliseconds(1));
        rocks.flush(20); // or the end could be refused behind all that waits to be confirmed
        REQUIRE(rocks.publish("test_machine/record", "{\"end\": 1}",
                              BrokerLink::Delivery::at_least_once));
        rocks.flush(20);
        const Outcome ended = day.wait(60);
        CAPTURE(ended.err);
        REQUIRE(ended.code == 0);

        const Outcome again = run_process({"monitor", "--stream", in("day/stream.ndjson"),
                                           "--baseline", in("example/baseline"), "--window", "20",
                                           "--out", in("again"), "--quiet"});
        CAPTURE(again.err);
        REQUIRE(again.code == 0);
        const auto then = verdicts_in(in("day/stream.ndjson"));
        CHECK(then.size() >= 8); // two sensors in two windows or more: numbers, and alarms
        CHECK(std::ranges::any_of(then, [](const std::string& text) {
            return text.find("\"state\":\"active\"") != std::string::npos;
        }));
        CHECK(verdicts_in(in("again/stream.ndjson")) == then);
        CHECK(read_whole(in("again/history.csv")) == read_whole(in("day/history.csv")));

        // everything else that passed is there too
        std::size_t payloads = 0, settings_of_rock = 0, acknowledged = 0, health = 0;
        StreamLogReader reader(in("day/stream.ndjson"));
        double last = 0;
        while (const auto m = reader.next()) {
            payloads += static_cast<std::size_t>(m->topic.ends_with("/imu"));
            settings_of_rock += static_cast<std::size_t>(m->topic == "smartrock/1/config");
            acknowledged += static_cast<std::size_t>(m->topic == "smartrock/1/config/ack");
            health += static_cast<std::size_t>(m->topic == "bris/health");
            if (m->kind != LogEntry::Kind::message && m->kind != LogEntry::Kind::tick) continue;
            if (m->arrival < last) FAIL("a time of arrival goes back");
            last = m->arrival;
        }
        CHECK(payloads == replay.sent() + 1);
        CHECK(settings_of_rock == 1);
        CHECK(acknowledged == 1);
        CHECK(health >= 1);

        const Outcome over_itself =
            run_process({"monitor", "--stream", in("day/stream.ndjson"), "--baseline",
                         in("example/baseline"), "--out", in("day"), "--quiet"});
        CHECK(over_itself.code == 2);
        CHECK(is_one_line_of(over_itself.err, "monitor"));
    }

    TEST_CASE("live_demo shows a log again: every message of it, in order, at its times") {
        if (!TestBroker().runs()) return;
        const TemporaryDirectory folder;
        const auto path = folder.path() / "log";
        std::vector<std::string> expected;
        {
            using Kind = LogEntry::Kind;
            StreamLog log(path, LoggedRecords::messages, 1 << 30);
            log.add({Kind::message, log.began(), BrokerLink::own_topic, "broken"});
            for (int k = 0; k < 40; ++k) {
                const auto state = fmt::format("{{\"axial_strain\":{}}}", 1e-4 * k);
                log.add({Kind::published, log.began() + k, "bris/state", state});
                log.add({Kind::message, log.began() + k + 0.5, "smartrock/3/status", "online"});
                expected.push_back("bris/state " + state);
                expected.emplace_back("smartrock/3/status online");
            }
        }
        const auto out = folder.path() / "out";
        const Instant began = this_instant();
        Process demo({"live_demo", "--history", path.string(), "--speed", "20", "--start-after",
                      "3", "--out", out.string(), "--quiet"});
        const auto port = [&]() -> std::string {
            std::ifstream in(out / "broker.conf");
            for (std::string line; std::getline(in, line);)
                if (line.starts_with("listener ")) return line.substr(9, line.find(' ', 9) - 9);
            return "";
        };
        BrokerSettings settings;
        std::optional<BrokerClient> page;
        for (int k = 0; k < 200 && !page; ++k) {
            std::this_thread::sleep_for(std::chrono::milliseconds(50));
            settings.address = "127.0.0.1:" + port();
            try {
                if (settings.address.back() != ':') page.emplace(settings, "page", topics());
            } catch (const OutputError&) { // it does not listen yet
            }
        }
        REQUIRE(page);
        std::vector<std::string> shown;
        while (shown.size() < expected.size()) {
            const auto m = page->next(10);
            if (!m) break;
            if (m->topic.starts_with("bris/run/") || m->topic == "bris/numbers") continue;
            shown.push_back(m->topic + " " + m->payload);
        }
        CHECK(shown == expected);
        CHECK(seconds_since(began) > 3 + 39.5 / 20 - 0.1);
        CHECK(demo.wait(30).code == 0);
    }
}
