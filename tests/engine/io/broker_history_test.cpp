#include "engine/errors.hpp"
#include "engine/io/broker_history.hpp"
#include "engine/io/whole_file.hpp"
#include "tests/temporary_directory.hpp"

#include <doctest/doctest.h>
#include <fmt/format.h>

#include <deque>

using namespace bris;

namespace {

/// A link that gives some messages and remembers what is published.
class ScriptedLink : public BrokerLink {
public:
    std::deque<BrokerMessage> coming;
    std::vector<std::string> published;
    std::optional<BrokerMessage> next(double) override {
        if (coming.empty()) return {};
        BrokerMessage m = coming.front();
        coming.pop_front();
        return m;
    }
    bool publish(const std::string& topic, const std::string& payload, Delivery) override {
        published.push_back(topic + " " + payload);
        return true;
    }
    BrokerCounters counters() const override { return {}; }
};

std::vector<std::string> all_in(const std::filesystem::path& path) {
    std::vector<std::string> found;
    HistoryReader reader(path);
    while (const auto m = reader.next())
        found.push_back(fmt::format("{} {}{} {}={}", m->time, m->retained ? "r" : "-",
                                    m->published ? "p" : "-", m->topic, m->payload));
    return found;
}

constexpr std::uint64_t no_limit = std::uint64_t{1} << 40;

} // namespace

TEST_SUITE("engine/io/broker_history") {
    TEST_CASE("a history gives back every message with its bytes, times and flags") {
        const TemporaryDirectory folder;
        const auto path = folder.path() / "run.h5";
        const std::string binary("\0\1\n\xff", 4);
        {
            Hdf5File file = Hdf5File::create(path);
            BrokerHistory history(file, no_limit);
            history.add({1.5, "a/b", binary});
            history.add({2.5, "", "", true, false});
            history.add({3.5, "bris/state", "{}", true, true});
            history.close();
            history.add({4.5, "after", "the end"}); // the file may be closed by now
            file.close();
        }
        HistoryReader reader(path);
        CHECK(reader.next()->payload == binary);
        CHECK(all_in(path) ==
              std::vector<std::string>{"1.5 -- a/b=" + binary, "2.5 r- =", "3.5 rp bris/state={}"});
    }

    TEST_CASE("a history of many parts stays in order, and a second run goes on with it") {
        const TemporaryDirectory folder;
        const auto path = folder.path() / "run.h5";
        constexpr int count = 500;
        const std::string large(1 << 16, 'x'); // 32 MB in all: several parts
        for (int run = 0; run < 2; ++run) {
            Hdf5File file = run == 0 ? Hdf5File::create(path) : Hdf5File::open_to_write(path);
            BrokerHistory history(file, no_limit);
            for (int k = 0; k < count; ++k) history.add({1.0 * k + run * count, "t", large});
            history.close();
            file.close();
        }
        CHECK(Hdf5File::open(path).names("/broker").size() > 4);
        HistoryReader reader(path);
        int found = 0;
        while (const auto m = reader.next()) {
            if (m->time != found || m->payload != large) FAIL("message " << found << " is wrong");
            ++found;
        }
        CHECK(found == 2 * count);
    }

    TEST_CASE("beyond its largest size a history leaves messages out and counts them") {
        const TemporaryDirectory folder;
        Hdf5File file = Hdf5File::create(folder.path() / "run.h5");
        BrokerHistory history(file, 1000);
        for (int k = 0; k < 10; ++k) history.add({1.0, "topic", std::string(178, 'x')}); // 200 each
        CHECK(history.left_out() == 5);
    }

    TEST_CASE("a file without a history is refused, and its unfinished end is left out") {
        const TemporaryDirectory folder;
        const auto path = folder.path() / "run.h5";
        {
            Hdf5File file = Hdf5File::create(path);
            file.make_group("/other");
            file.close();
        }
        CHECK_THROWS_AS(HistoryReader{path}, InputError);
        CHECK(is_hdf5(path));
        write_whole(folder.path() / "lines", "{\"t\": 1}\n");
        CHECK_FALSE(is_hdf5(folder.path() / "lines"));
        CHECK_FALSE(is_hdf5(folder.path()));
        {
            Hdf5File file = Hdf5File::create(path);
            BrokerHistory history(file, no_limit);
            history.add({1, "a", "b"});
            history.close();
            const std::vector<double> time{2}; // of a message of which nothing else was written
            file.append("/broker/part_000000/time", std::span<const double>(time));
            file.close();
        }
        CHECK(all_in(path) == std::vector<std::string>{"1 -- a=b"});
    }

    TEST_CASE("a history whose numbers are no sizes of texts is refused") {
        const TemporaryDirectory folder;
        const auto path = folder.path() / "run.h5";
        Hdf5File file = Hdf5File::create(path);
        for (const char* column : {"time", "flags", "topic_bytes", "payload_bytes", "bytes"}) {
            const std::string dataset = std::string("/broker/part_000000/") + column;
            file.make_growing<double>(dataset, {}, 16);
            const std::vector<double> value{column == std::string("topic_bytes") ? -1.0 : 1.0};
            file.append(dataset, std::span<const double>(value));
        }
        file.close();
        CHECK_THROWS_AS(all_in(path), InputError);
    }

    TEST_CASE("what passes a recorded link is what a replayed link gives again") {
        const TemporaryDirectory folder;
        const auto path = folder.path() / "run.h5";
        {
            Hdf5File file = Hdf5File::create(path);
            BrokerHistory history(file, no_limit);
            ScriptedLink link;
            link.coming = {{"smartrock/1/imu", "one", false, this_instant(), 10},
                           {BrokerLink::own_topic, "broken", false, this_instant(), 11},
                           {"smartrock/1/status", "two", true, this_instant(), 12}};
            RecordedLink recorded(link, history);
            CHECK(recorded.next(0)->payload == "one");
            CHECK(recorded.publish("bris/state", "{}", BrokerLink::Delivery::retained));
            CHECK(recorded.next(0)->payload == "broken");
            CHECK(recorded.next(0)->payload == "two");
            CHECK_FALSE(recorded.next(0));
            CHECK(link.published == std::vector<std::string>{"bris/state {}"});
        }
        ScriptedLink page;
        ReplayedLink replayed(path, 0, &page);
        CHECK(replayed.next(0)->payload == "began");
        const auto one = replayed.next(0);
        CHECK(one->payload == "one");
        CHECK(one->time == 10);
        CHECK(replayed.next(0)->payload == "broken");
        CHECK(replayed.counters().breaks == 1);
        CHECK_FALSE(replayed.over());
        const auto two = replayed.next(0);
        CHECK(two->payload == "two");
        CHECK(two->retained);
        CHECK(replayed.over());
        CHECK_FALSE(replayed.next(0));
        CHECK(replayed.publish("bris/state", "{}", BrokerLink::Delivery::retained));
        CHECK(page.published == std::vector<std::string>{"bris/state {}"});
    }
}
