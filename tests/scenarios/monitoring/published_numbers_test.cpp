#include "engine/io/whole_file.hpp"
#include "scenarios/monitoring/published_numbers.hpp"
#include "scenarios/monitoring/publisher.hpp"

#include <doctest/doctest.h>

#include <filesystem>
#include <set>
#include <string>

using namespace bris;

namespace {

/// Keeps what is published.
class Listener : public BrokerLink {
public:
    std::optional<BrokerMessage> next(double) override { return {}; }
    bool publish(const std::string& topic, const std::string& payload, Delivery delivery) override {
        messages.push_back({topic, payload, delivery == Delivery::retained, Instant{}, 0.0});
        return true;
    }
    BrokerCounters counters() const override { return {}; }
    std::vector<BrokerMessage> messages;
};

} // namespace

TEST_SUITE("monitoring/published_numbers") {
    TEST_CASE(
        "no message has two numbers of one name, and every curve is of numbers in the table") {
        std::set<std::string> names;
        for (const PublishedNumber& n : published_numbers)
            CHECK(names.insert(std::to_string(static_cast<int>(n.message)) + std::string(n.name))
                      .second);
        CHECK(curves_are_published());
        CHECK_FALSE(is_published(NumbersOf::test, "friction")); // what the page once asked for
        CHECK(is_published(NumbersOf::test, "learned_friction"));
    }

    TEST_CASE("the documents have the table of published numbers") {
        const auto readme =
            std::filesystem::path(BRIS_SOURCE) / "assets" / "live_page" / "README.md";
        const std::string expected = published_table_for_documents();
        INFO("expected in " << readme.string() << ":\n" << expected);
        CHECK(read_whole(readme).find(expected) != std::string::npos);
    }

    TEST_CASE("a publisher gives the table first, and a number that is not known as null") {
        Listener listener;
        Publisher publisher(listener, "model");
        REQUIRE(listener.messages.size() == 1);
        CHECK(listener.messages[0].topic == "bris/numbers");
        CHECK(listener.messages[0].payload == published_table());
        CHECK(listener.messages[0].retained);
        publisher.publish_timing({{"axial_strain", 0.01}, {"latency_s", std::nan("")}});
        CHECK(listener.messages.back().topic == "bris/timing");
        CHECK(listener.messages.back().payload == R"({"axial_strain":0.01,"latency_s":null})");
        publisher.publish_sensor(7, {{"recorded_time_s", 20.0}, {"rms_ratio", 1.5}});
        CHECK(listener.messages.back().topic == "bris/sensor/7");
    }

    TEST_CASE("an alarm that nobody has judged is unknown, and is published once as long as it is "
              "the same") {
        Listener listener;
        Publisher publisher(listener, "model");
        publisher.publish_alarm(3, PublishedAlarm{});
        CHECK(listener.messages.back().topic == "smartrock/3/alarm");
        CHECK(listener.messages.back().retained);
        CHECK(
            listener.messages.back().payload ==
            R"({"reason":"","run":"model","state":"unknown","t":null,"verdict":"not judged yet"})");
        publisher.publish_alarm(3, PublishedAlarm{});
        CHECK(listener.messages.size() == 2);
        publisher.publish_alarm(3, PublishedAlarm{AlarmState::clear, "in use", "", 0.1});
        publisher.publish_alarm(3, PublishedAlarm{AlarmState::clear, "in use", "", 0.2});
        CHECK(listener.messages.size() == 3);
        publisher.publish_alarm("agreement",
                                PublishedAlarm{AlarmState::active, "", "a \xff byte", 0.2});
        CHECK(listener.messages.back().topic == "bris/alarm/agreement");
        CHECK(listener.messages.back().payload.find("\xff") == std::string::npos);
    }
}
