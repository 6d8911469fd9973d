// What passes a logged source is what a replay of its log gives again.
#include "scenarios/stream/logged_lines.hpp"
#include "scenarios/stream/logged_link.hpp"
#include "tests/temporary_directory.hpp"

#include <doctest/doctest.h>
#include <fmt/format.h>

#include <cmath>
#include <deque>
#include <string>
#include <vector>

using namespace bris;

namespace {

namespace fs = std::filesystem;

std::shared_ptr<StreamLog> log_at(const fs::path& path, LoggedRecords records) {
    return std::make_shared<StreamLog>(path, records, std::uint64_t{1} << 30);
}

/// A source of lines with a clock of its own: a line, or nothing for some time.
class ScriptedLines : public Lines {
public:
    struct Event {
        double time;
        std::string text; // empty: nothing
    };
    explicit ScriptedLines(std::deque<Event> events) : coming_(std::move(events)) {}
    std::optional<Line> next(double) override {
        if (coming_.empty()) return {};
        const Event event = coming_.front();
        coming_.pop_front();
        now_ = event.time;
        if (event.text.empty()) return {};
        return Line{++lines_, event.text, this_instant(), event.text != "cut", event.time};
    }
    bool over() const override { return coming_.empty(); }
    double now() const override { return now_; }

private:
    std::deque<Event> coming_;
    std::uint64_t lines_ = 0;
    double now_ = no_arrival;
};

/// All that a user of lines can see, as far as it depends on what arrived.
std::vector<std::string> seen(Lines& lines) {
    std::vector<std::string> all;
    double now = no_arrival;
    while (!lines.over()) {
        if (const auto line = lines.next(0))
            all.push_back(
                fmt::format("{} {} {} {}", line->number, line->text, line->whole, line->arrival));
        else if (!(lines.now() == now))
            all.push_back(fmt::format("nothing until {}", lines.now()));
        now = lines.now();
    }
    return all;
}

/// A link that gives some messages, or nothing, and remembers what is published.
class ScriptedLink : public BrokerLink {
public:
    std::deque<BrokerMessage> coming;
    std::vector<std::string> published;
    std::optional<BrokerMessage> next(double) override {
        if (coming.empty()) return {};
        BrokerMessage m = coming.front();
        coming.pop_front();
        now_ = m.time;
        if (m.topic.empty()) return {};
        return m;
    }
    bool over() const override { return coming.empty(); }
    double now() const override { return now_; }
    bool publish(const std::string& topic, const std::string& payload, Delivery) override {
        published.push_back(topic + " " + payload);
        return true;
    }
    BrokerCounters counters() const override { return {}; }

private:
    double now_ = no_arrival;
};

std::vector<std::string> seen(BrokerLink& link) {
    std::vector<std::string> all;
    double now = no_arrival;
    while (!link.over()) {
        if (const auto m = link.next(0))
            all.push_back(fmt::format("{} {} {} {}", m->topic, m->payload, m->retained, m->time));
        else if (!(link.now() == now))
            all.push_back(fmt::format("nothing until {}", link.now()));
        now = link.now();
    }
    return all;
}

} // namespace

TEST_SUITE("stream/logged") {
    TEST_CASE(
        "a replay shows the lines, their arrival and the passing of time that the user of the "
        "lines saw") {
        const TemporaryDirectory folder;
        const fs::path path = folder / "log";
        std::vector<std::string> live, resumed;
        {
            LoggedLines lines(std::make_unique<ScriptedLines>(std::deque<ScriptedLines::Event>{
                                  {0.1 + 0.2, "one"},
                                  {0.5, ""}, // too soon for a tick
                                  {2.7, ""},
                                  {2.6, "it arrived before the tick was logged"},
                                  {1e9 / 3, "cut"},
                                  {1e9, ""}}),
                              log_at(path, LoggedRecords::lines));
            live = seen(lines);
        }
        CHECK(live == std::vector<std::string>{
                          "1 one true 0.30000000000000004", "nothing until 2.7",
                          "2 it arrived before the tick was logged true 2.7",
                          "3 cut false 333333333.3333333", "nothing until 1000000000"});
        {
            ReplayedLines replayed(path, 0);
            CHECK(seen(replayed) == live);
        }
        {
            LoggedLines lines(std::make_unique<ScriptedLines>(std::deque<ScriptedLines::Event>{
                                  {1e9 + 5, ""}, {1e9 + 6, "four"}}),
                              log_at(path, LoggedRecords::lines));
            resumed = seen(lines);
        }
        live.emplace_back("nothing until 1000000005");
        live.emplace_back("4 four true 1000000006");
        CHECK(resumed == live);
        ReplayedLines replayed(path, 0);
        CHECK(seen(replayed) == live);
    }

    TEST_CASE("lines of a file have no arrival, and what was not taken is logged at the end") {
        const TemporaryDirectory folder;
        const fs::path path = folder / "log";
        {
            LoggedLines lines(std::make_unique<ScriptedLines>(std::deque<ScriptedLines::Event>{
                                  {no_arrival, "one"}, {no_arrival, "two"}, {no_arrival, "three"}}),
                              log_at(path, LoggedRecords::lines));
            CHECK(lines.next(0)->text == "one");
            CHECK(std::isnan(lines.now()));
        }
        ReplayedLines replayed(path, 0);
        CHECK(seen(replayed) ==
              std::vector<std::string>{"1 one true nan", "2 two true nan", "3 three true nan"});
    }

    TEST_CASE("a resumed run sees the lines of its earlier session first, and knows them") {
        const TemporaryDirectory folder;
        for (int session = 0; session < 3; ++session) {
            LoggedLines lines(std::make_unique<ScriptedLines>(
                                  std::deque<ScriptedLines::Event>{{session + 1.0, "line"}}),
                              log_at(folder / "log", LoggedRecords::lines));
            for (int before = 0; before < session; ++before)
                CHECK(lines.next(0)->arrived == Instant{});
            CHECK(lines.next(0)->arrived != Instant{});
            CHECK_FALSE(lines.next(0));
        }
    }

    TEST_CASE(
        "a replay of a link shows the messages and the passing of time that its user saw, and "
        "publishes where it is told") {
        const TemporaryDirectory folder;
        const fs::path path = folder / "log";
        std::vector<std::string> live;
        {
            ScriptedLink link;
            link.coming = {{"smartrock/1/imu", std::string("\0\xff", 2), false, this_instant(), 10},
                           {BrokerLink::own_topic, "broken", false, this_instant(), 11},
                           {"", "", false, {}, 12.5},
                           {"smartrock/1/status", "two", true, this_instant(), 13}};
            LoggedLink logged(link, log_at(path, LoggedRecords::messages));
            CHECK(logged.publish("bris/state", "{}", BrokerLink::Delivery::retained));
            live = seen(logged);
            CHECK(link.published == std::vector<std::string>{"bris/state {}"});
        }
        REQUIRE(live.size() == 5);
        CHECK(live[0].starts_with("$link began"));
        CHECK(live[3] == "nothing until 12.5");
        ScriptedLink page;
        {
            ReplayedLink replayed(path, 0, &page);
            CHECK(seen(replayed) == live);
            CHECK(replayed.counters().breaks == 1);
            CHECK(replayed.counters().received == 2);
            CHECK(replayed.publish("bris/state", "{}", BrokerLink::Delivery::retained));
            CHECK(page.published == std::vector<std::string>{"bris/state {}"});
        }
        ScriptedLink more;
        more.coming = {{"smartrock/1/imu", "three", false, this_instant(), 2e9}};
        std::vector<std::string> resumed;
        {
            LoggedLink logged(more, log_at(path, LoggedRecords::messages));
            resumed = seen(logged);
        }
        CHECK(resumed.size() == live.size() + 2); // a session began, and one message came
        ReplayedLink replayed(path, 0, nullptr);
        CHECK(seen(replayed) == resumed);
    }

    TEST_CASE("a replay goes at its speed") {
        const TemporaryDirectory folder;
        {
            auto log = log_at(folder / "log", LoggedRecords::lines);
            for (int k = 0; k < 3; ++k)
                log->add({LogEntry::Kind::line, log->began() + 10.0 * k, {}, "line"});
        }
        ReplayedLines replayed(folder / "log", 100);
        const Instant began = this_instant();
        while (!replayed.over()) (void)replayed.next(1);
        CHECK(seconds_since(began) > 0.19);
        CHECK(seconds_since(began) < 5);
    }
}
