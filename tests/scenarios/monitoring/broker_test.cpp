// Recordings over a real broker: mosquitto on a free port of the loopback, with users and an ACL.
#include "engine/errors.hpp"
#include "engine/io/broker_client.hpp"
#include "engine/io/whole_file.hpp"
#include "scenarios/stream/broker_lines.hpp"
#include "tests/scenarios/monitoring/test_broker.hpp"

#include <doctest/doctest.h>
#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <string>
#include <thread>
#include <tuple>
#include <vector>

using namespace bris;
using bris::testing::TestBroker;
using bris::testing::TestLink;
using Delivery = BrokerLink::Delivery;

namespace {

SensorPayload payload(std::uint32_t sequence, double time, int samples = 10) {
    SensorPayload p{.channels = 0x0f, .sequence = sequence, .time = time, .interval = 0.01f};
    for (int k = 0; k < 10 * samples; ++k)
        p.numbers.push_back(static_cast<float>(sequence) + 0.25f * static_cast<float>(k));
    return p;
}

std::vector<SensorInfo> two_sensors() {
    std::vector<SensorInfo> infos(2);
    infos[0].id = 1;
    infos[1].id = 2;
    return infos;
}

void publish(BrokerClient& client, const std::string& topic, const std::string& bytes) {
    client.publish(topic, bytes, Delivery::at_least_once);
}

std::vector<std::string> all_lines(BrokerLines& lines, std::size_t expected) {
    std::vector<std::string> texts;
    while (texts.size() < expected) {
        const auto line = lines.next(5);
        if (!line) break;
        texts.push_back(line->text);
    }
    if (const auto more = lines.next(0.3)) texts.push_back(more->text);
    return texts;
}

/// The same without copies: a message that was on its way when a connection broke may come again,
/// and a Gate behind the lines leaves it out.
std::vector<std::string> all_different_lines(BrokerLines& lines, std::size_t expected) {
    std::vector<std::string> texts;
    const auto add = [&](const std::string& text) {
        if (std::ranges::find(texts, text) == texts.end()) texts.push_back(text);
    };
    while (texts.size() < expected) {
        const auto line = lines.next(5);
        if (!line) break;
        add(line->text);
    }
    while (const auto more = lines.next(0.3)) add(more->text);
    return texts;
}

/// The next message of the broker.
std::optional<BrokerMessage> next_of_broker(BrokerClient& client) {
    auto message = client.next(5);
    while (message && message->topic == BrokerLink::own_topic) message = client.next(5);
    return message;
}

template <class Condition>
bool soon(Condition&& condition) {
    for (int k = 0; k < 400 && !condition(); ++k)
        std::this_thread::sleep_for(std::chrono::milliseconds(50));
    return condition();
}

/// The message of the error with which a client cannot connect.
std::string error_of(const BrokerSettings& settings) {
    try {
        const BrokerClient client(settings, "client", {});
    } catch (const OutputError& e) {
        return e.what();
    }
    return "connected";
}

bool contains(const std::string& text, const std::string& part) {
    const bool found = text.find(part) != std::string::npos;
    if (!found) MESSAGE("expected \"" << part << "\" in:\n" << text);
    return found;
}

/// Lines of one sensor whose sequence numbers count from 0.
void require_all_in_order(const std::vector<std::string>& lines, std::uint32_t count) {
    REQUIRE(lines.size() == count);
    for (std::uint32_t k = 0; k < count; ++k)
        if (lines[k].find(fmt::format("\"seq\": {},", k)) == std::string::npos)
            FAIL("line " << k << ": " << lines[k]);
}

} // namespace

TEST_SUITE("monitoring/broker") {
    TEST_CASE("records of sensors and of the machine arrive as lines, hostile ones are counted") {
        TestBroker broker;
        if (!broker.runs()) return;
        BrokerClient receiver(broker.settings("model"), "receiver", BrokerLines::topics());
        BrokerClient sender(broker.settings("rocks"), "sender", {});
        BrokerLines lines(receiver, two_sensors());
        std::this_thread::sleep_for(std::chrono::milliseconds(300)); // for the subscription

        publish(sender, "smartrock/1/imu", bytes_of(payload(0, 1.0)));
        publish(sender, "smartrock/1/imu", bytes_of(payload(20, 1.2)));      // after a gap of 10
        publish(sender, "smartrock/1/imu", bytes_of(payload(10, 1.1)));      // which it fills
        publish(sender, "smartrock/1/imu", bytes_of(payload(20, 1.2)));      // again: for the gate
        publish(sender, "smartrock/9/imu", bytes_of(payload(0, 1.0)));       // unknown
        publish(sender, "smartrock/one/imu", bytes_of(payload(0, 1.0)));     // no id
        publish(sender, "smartrock/2/imu", bytes_of(payload(0, 1.0)) + "x"); // a length that lies
        publish(sender, "smartrock/2/imu", "");
        publish(sender, "test_machine/record", "{\"axial_strain\": 0.001}");
        publish(sender, "test_machine/record", "{\"axial_strain\": ");
        publish(sender, "smartrock/2/imu", bytes_of(payload(0, 2.0, 1)));
        const auto texts = all_lines(lines, 42);
        REQUIRE(texts.size() == 42);
        CHECK(texts[0] == "{\"t\": 1, \"id\": 1, \"seq\": 0, \"ax\": 0, \"ay\": 0.25, \"az\": 0.5, "
                          "\"gx\": 0.75, \"gy\": 1, \"gz\": 1.25, \"mx\": 1.5, \"my\": 1.75, "
                          "\"mz\": 2, \"strain\": 2.25}");
        CHECK(texts[40] == "{\"axial_strain\": 0.001}");
        const std::string report = lines.report();
        CHECK(contains(report,
                       "sensor 1: 30 samples, 0 missing in 1 gaps, 1 messages late, 1 again"));
        CHECK(contains(report, "sensor 2: 1 samples"));
        CHECK(contains(report, "2 unreadable"));
        CHECK(contains(report, "expected 420 bytes for 10 samples of 10 columns, found 421"));
        CHECK(contains(report, "2 times: smartrock/9/imu: expected the id of a file rock_NN.txt"));
        CHECK(contains(report, "test_machine/record: expected"));
    }

    TEST_CASE("wrong passwords are refused, and forbidden topics lead nowhere") {
        TestBroker broker;
        if (!broker.runs()) return;
        BrokerSettings wrong = broker.settings("model");
        write_whole(broker.folder() / "wrong", "not the password\n");
        wrong.password_file = broker.folder() / "wrong";
        CHECK_THROWS_AS(BrokerClient(wrong, "wrong", {}), OutputError);
        BrokerSettings nobody = broker.settings("model");
        nobody.user.clear();
        nobody.password_file.clear();
        CHECK_THROWS_AS(BrokerClient(nobody, "nobody", {}), OutputError);

        BrokerClient model(broker.settings("model"), "model", BrokerLines::topics());
        BrokerClient rocks(broker.settings("rocks"), "rocks", {"bris/#"});
        std::this_thread::sleep_for(std::chrono::milliseconds(300));
        rocks.publish("bris/state", "{}", Delivery::retained); // not a rock's
        rocks.publish("smartrock/1/status", "online", Delivery::retained);
        model.publish("bris/state", "{}", Delivery::retained);
        const auto got = next_of_broker(model);
        REQUIRE(got);
        CHECK(got->topic == "smartrock/1/status");
        rocks.flush(5);
        CHECK(rocks.counters().refused == 1);
        CHECK_FALSE(rocks.next(0.5)); // it may not read bris/
        CHECK(model.counters().refused == 0);
    }

    TEST_CASE("of two programs with one session the second one goes on, and the first one ends in "
              "one line instead of throwing the other out") {
        TestBroker broker;
        if (!broker.runs()) return;
        BrokerSettings settings = broker.settings("model");
        settings.session = "site";
        BrokerClient first(settings, "first", BrokerLines::topics());
        BrokerLines lines(first, two_sensors());
        BrokerClient second(settings, "second", BrokerLines::topics());
        std::string end;
        for (int k = 0; k < 300 && end.empty(); ++k)
            end = message_of<OutputError>([&] { (void)lines.next(0.1); });
        CHECK(contains(end, "another client has taken the session over (client \"site\")"));
        std::this_thread::sleep_for(
            std::chrono::milliseconds(1500)); // a new try would be after 1 s
        CHECK(second.connected());
        CHECK(second.counters().breaks <= 3); // 0 where the broker says why it closes
        CHECK_FALSE(first.connected());
        BrokerClient rocks(broker.settings("rocks"), "rocks", {});
        publish(rocks, "smartrock/1/imu", bytes_of(payload(0, 1, 1)));
        const auto got = next_of_broker(second);
        REQUIRE(got);
        CHECK(got->topic == "smartrock/1/imu");
    }

    TEST_CASE("retained records of sensors and of the machine are of another time: they are "
              "ignored and counted") {
        TestBroker broker;
        if (!broker.runs()) return;
        BrokerClient rocks(broker.settings("rocks"), "rocks", {});
        rocks.publish("smartrock/1/imu", bytes_of(payload(7, 1e6, 1)), Delivery::retained);
        rocks.publish("test_machine/record", "{\"axial_strain\": 0.5}", Delivery::retained);
        rocks.flush(5);
        BrokerClient model(broker.settings("model"), "model", BrokerLines::topics());
        BrokerLines lines(model, two_sensors());
        std::this_thread::sleep_for(std::chrono::milliseconds(300)); // for the subscription
        publish(rocks, "smartrock/1/imu", bytes_of(payload(0, 1, 1)));
        const auto texts = all_lines(lines, 1);
        REQUIRE(texts.size() == 1);
        CHECK(contains(texts[0], "\"seq\": 0,"));
        const std::string report = lines.report();
        CHECK(contains(report, "1 time: smartrock/1/imu: a retained record is of another time"));
        CHECK(contains(report, "1 time: test_machine/record: a retained record is of another"));
        CHECK(contains(report, "sensor 1: 1 samples"));
    }

    TEST_CASE("after a restart of the broker the client is back, with its retained messages") {
        TestBroker broker;
        if (!broker.runs()) return;
        BrokerClient model(broker.settings("model"), "model", BrokerLines::topics());
        BrokerLines lines(model, two_sensors());
        model.publish("bris/scene", "{\"title\": 1}", Delivery::retained);
        model.flush(5);
        broker.stop();
        for (int k = 0; k < 100 && model.connected(); ++k)
            std::this_thread::sleep_for(std::chrono::milliseconds(50));
        REQUIRE_FALSE(model.connected());
        model.publish("bris/state", "{}", Delivery::once_at_most); // nobody there
        broker.start();
        REQUIRE(broker.runs());
        for (int k = 0; k < 200 && !model.connected(); ++k)
            std::this_thread::sleep_for(std::chrono::milliseconds(50));
        REQUIRE(model.connected());
        BrokerClient page(broker.settings("page"), "page", {"bris/#"});
        const auto scene = page.next(5);
        REQUIRE(scene);
        CHECK(scene->payload == "{\"title\": 1}");
        std::this_thread::sleep_for(std::chrono::milliseconds(300));
        BrokerClient rocks(broker.settings("rocks"), "rocks", {});
        publish(rocks, "smartrock/2/imu", bytes_of(payload(5, 3, 1)));
        CHECK(all_lines(lines, 1).size() == 1);
        CHECK(model.counters().breaks == 1);
        CHECK(model.counters().unpublished == 1);
        CHECK(model.counters().lost_sessions == 1); // this broker keeps nothing on the disk
        CHECK(contains(lines.report(), "the broker kept nothing while the connection was broken"));
    }

    TEST_CASE("what the broker takes while the link is down arrives afterwards, in order") {
        TestBroker broker;
        if (!broker.runs()) return;
        TestLink link(broker.port());
        BrokerSettings through_link = broker.settings("model");
        through_link.address = link.address();
        BrokerClient model(through_link, "model", BrokerLines::topics());
        BrokerClient rocks(broker.settings("rocks"), "rocks", {});
        BrokerLines lines(model, two_sensors());
        std::this_thread::sleep_for(std::chrono::milliseconds(300)); // for the subscription
        constexpr std::uint32_t count = 300;
        for (std::uint32_t k = 0; k < count; ++k) {
            if (k == 50 || k == 150) {
                link.cut(true);
                REQUIRE(soon([&] { return !model.connected(); }));
            }
            if (k == 120) { // back in between, with what was sent from 50 on
                link.cut(false);
                REQUIRE(soon([&] { return model.connected(); }));
            }
            publish(rocks, "smartrock/1/imu", bytes_of(payload(k, 0.01 * k, 1)));
        }
        rocks.flush(5);
        CHECK(rocks.counters().acknowledged == count);
        link.cut(false);
        const auto texts = all_different_lines(lines, count);
        require_all_in_order(texts, count);
        CHECK(model.counters().breaks == 2);
        CHECK(model.counters().lost_sessions == 0);
        CHECK(contains(lines.report(),
                       "sensor 1: 300 samples, 0 missing in 0 gaps, 0 messages late"));
    }

    TEST_CASE("after each of several breaks the client is back after a second") {
        TestBroker broker;
        if (!broker.runs()) return;
        TestLink link(broker.port());
        BrokerSettings through_link = broker.settings("model");
        through_link.address = link.address();
        BrokerClient model(through_link, "model", {});
        for (int k = 0; k < 3; ++k) {
            link.cut(true);
            REQUIRE(soon([&] { return !model.connected(); }));
            link.cut(false);
            const Instant began = this_instant();
            REQUIRE(soon([&] { return model.connected(); }));
            CHECK(seconds_since(began) < 2.5); // waits that grew would be 1, 2 and 4 s
        }
        CHECK(model.counters().breaks == 3);
    }

    TEST_CASE("what a sender publishes while its link is down is sent afterwards, in order") {
        TestBroker broker;
        if (!broker.runs()) return;
        TestLink link(broker.port());
        BrokerSettings through_link = broker.settings("rocks");
        through_link.address = link.address();
        BrokerClient rocks(through_link, "rocks", {});
        BrokerClient model(broker.settings("model"), "model", BrokerLines::topics());
        BrokerLines lines(model, two_sensors());
        std::this_thread::sleep_for(std::chrono::milliseconds(300)); // for the subscription
        constexpr std::uint32_t count = 200;
        for (std::uint32_t k = 0; k < count; ++k) {
            if (k == 50) {
                link.cut(true);
                REQUIRE(soon([&] { return !rocks.connected(); }));
            }
            if (k == 150) link.cut(false); // it connects again while the others are published
            CHECK(rocks.publish("smartrock/1/imu", bytes_of(payload(k, 0.01 * k, 1)),
                                Delivery::at_least_once));
            if (k > 150) std::this_thread::sleep_for(std::chrono::milliseconds(50));
        }
        const auto texts = all_different_lines(lines, count);
        require_all_in_order(texts, count);
        CHECK(rocks.counters().unpublished == 0);
        CHECK(soon([&] { return rocks.counters().acknowledged == count; }));
    }

    TEST_CASE("a named session keeps records for the next client with its name") {
        TestBroker broker;
        if (!broker.runs()) return;
        BrokerSettings settings = broker.settings("model");
        settings.session = "test-12";
        const std::vector<std::string> topics{"smartrock/+/imu"};
        { BrokerClient before(settings, "model", topics); }
        BrokerClient rocks(broker.settings("rocks"), "rocks", {});
        publish(rocks, "smartrock/1/imu", "between");
        rocks.flush(5);
        {
            BrokerClient after(settings, "model", topics);
            const auto got = after.next(5);
            REQUIRE(got);
            CHECK(got->payload == "between");
            after.end_session();
        }
        std::this_thread::sleep_for(std::chrono::milliseconds(300)); // for the end of the session
        publish(rocks, "smartrock/1/imu", "too late");
        rocks.flush(5);
        BrokerClient another(settings, "model", topics);
        CHECK_FALSE(another.next(0.5));
        another.end_session();
    }

    TEST_CASE("a session is ended although records keep coming") {
        TestBroker broker;
        if (!broker.runs()) return;
        BrokerSettings settings = broker.settings("model");
        settings.session = "test-13";
        const std::vector<std::string> topics{"smartrock/+/imu"};
        for (int k = 0; k < 3; ++k) {
            std::atomic<bool> ends = false;
            std::thread rocks([&] {
                BrokerClient client(broker.settings("rocks"), "rocks", {});
                while (!ends) {
                    publish(client, "smartrock/1/imu", std::string(1000, 'x'));
                    std::this_thread::sleep_for(std::chrono::microseconds(200));
                }
                client.flush(5);
            });
            {
                BrokerClient model(settings, "model", topics);
                CHECK(model.next(5));
                model.end_session();
            }
            std::this_thread::sleep_for(std::chrono::milliseconds(100)); // records that nobody has
            ends = true;
            rocks.join();
            BrokerClient next(settings, "model", topics);
            CHECK_FALSE(next.next(0.3));
            next.end_session();
        }
    }

    TEST_CASE("with TLS only the broker that its authority vouches for is accepted") {
        TestBroker broker(TestBroker::Kind::with_tls);
        if (!broker.runs()) return;
        BrokerSettings right = broker.settings("model");
        right.ca_file = broker.folder() / "right.pem";
        BrokerClient model(right, "model", {"bris/#"}); // the ACL forbids to read it
        CHECK(model.connected());
        BrokerSettings rocks = broker.settings("rocks");
        rocks.ca_file = right.ca_file;
        BrokerClient sender(rocks, "rocks", {});
        publish(sender, "smartrock/1/imu", "x");
        sender.flush(5);
        CHECK(sender.counters().acknowledged == 1);

        const std::string not_trusted = "the broker's certificate is not signed by them, has "
                                        "expired, or is not valid yet";
        BrokerSettings wrong = right;
        wrong.ca_file = broker.folder() / "wrong.pem";
        CHECK(contains(error_of(wrong), not_trusted));
        CHECK(contains(error_of(wrong), "--broker: " + right.address));
        BrokerSettings plain = right;
        plain.ca_file.clear();
        CHECK(contains(error_of(plain), "the broker closed the connection without an answer; does "
                                        "it expect TLS (--broker-ca-file)?"));
        const TestBroker without_tls;
        BrokerSettings to_plain = without_tls.settings("model");
        to_plain.ca_file = right.ca_file;
        CHECK(contains(error_of(to_plain), "no TLS connection with the authorities of"));

        for (const auto& [host, days, expected] :
             {std::tuple{"127.0.0.1", -3, not_trusted},
              {"elsewhere.example", 9,
               std::string("the broker's certificate is of another host than 127.0.0.1")}}) {
            broker.stop();
            TestBroker::make_certificates(broker.folder(), host, days);
            broker.start();
            CHECK(contains(error_of(right), expected));
        }
    }

    TEST_CASE(
        "an address that never answers costs the timeout at most, and a run goes on without") {
        if (!has_broker_client()) return;
        const TestBroker absent(TestBroker::Kind::absent);
        BrokerSettings s;
        s.address = absent.address();
        s.timeout = 0.5;
        const std::string expected =
            fmt::format("--broker: {}: expected an answer, found none within 0.5 s", s.address);
        const Instant began = this_instant();
        CHECK(error_of(s) == expected);
        {
            BrokerClient client(s, "client", {}, BrokerClient::Start::any);
            CHECK(client.problem() == expected);
            for (int k = 0; k < 1000; ++k)
                CHECK_FALSE(client.publish("bris/state", "{}", Delivery::once_at_most));
            CHECK(client.counters().unpublished == 1000);
        }
        CHECK(seconds_since(began) < 8); // twice the timeout and the farewell, not minutes
        BrokerSettings nobody = s;
        nobody.address = "no.such.host.invalid:1883";
        nobody.timeout = 20;
        CHECK(contains(error_of(nobody), "no.such.host.invalid"));
    }

    TEST_CASE("a broker that is not there, and one that never answers, are errors of one line") {
        if (!has_broker_client()) return;
        TestBroker silent(TestBroker::Kind::silent);
        BrokerSettings s;
        s.address = silent.address();
        s.timeout = 0.5;
        CHECK_THROWS_WITH_AS(BrokerClient(s, "client", {}),
                             fmt::format("--broker: {}: expected an answer, found none within "
                                         "0.5 s",
                                         s.address)
                                 .c_str(),
                             OutputError);
        s.address = "127.0.0.1:1"; // reserved, nothing listens there
        CHECK_THROWS_AS(BrokerClient(s, "client", {}), OutputError);
        for (const char* bad : {"127.0.0.1", "host:", ":1883", "host:0", "host:65536", "host:1.5"})
            CHECK_THROWS_AS(host_and_port(bad), InputError);
        CHECK(host_and_port("[::1]:1883") == std::pair<std::string, int>{"::1", 1883});
    }
}
