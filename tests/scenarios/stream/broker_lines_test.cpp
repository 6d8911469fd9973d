#include "scenarios/stream/broker_lines.hpp"
#include "scenarios/stream/gate.hpp"

#include <doctest/doctest.h>
#include <fmt/format.h>

#include <deque>
#include <string>
#include <vector>

using namespace bris;

namespace {

/// A link that gives nothing: messages are handed to the lines.
class NoLink : public BrokerLink {
public:
    std::optional<BrokerMessage> next(double) override { return {}; }
    bool over() const override { return true; }
    double now() const override { return no_arrival; }
    bool publish(const std::string&, const std::string&, Delivery) override { return true; }
    BrokerCounters counters() const override { return {}; }
};

/// Ten samples at 100 Hz, as sensor 1 sends them every 0.1 s.
struct Batch {
    std::uint32_t sequence;
    double time, arrival;
    float content = 0;
};

struct Delivered {
    std::vector<std::string> lines;
    std::string report;

    bool says(const std::string& text) const { return report.find(text) != std::string::npos; }
};

Delivered delivered(const std::vector<Batch>& batches) {
    NoLink link;
    std::vector<SensorInfo> infos(1);
    infos[0].id = 1;
    BrokerLines lines(link, infos);
    Delivered all;
    for (const Batch& b : batches) {
        SensorPayload p{.channels = 1,
                        .sequence = b.sequence,
                        .time = b.time,
                        .interval = 0.01f,
                        .numbers = {}};
        for (int k = 0; k < 30; ++k)
            p.numbers.push_back(static_cast<float>(b.sequence) + static_cast<float>(k) + b.content);
        lines.take({"smartrock/1/imu", bytes_of(p), false, {}, b.arrival});
        while (!lines.over()) all.lines.push_back(lines.next(0)->text);
    }
    all.report = lines.report();
    return all;
}

} // namespace

TEST_SUITE("stream/broker_lines") {
    TEST_CASE("what was sent again, and a sensor whose counts and clock begin again at 0, is for "
              "the gate: all of it becomes lines") {
        std::vector<Batch> batches;
        for (std::uint32_t k = 0; k < 200; ++k)
            batches.push_back({10 * k, 0.1 * k, 1000 + 0.1 * k});
        for (std::uint32_t k = 190; k < 200; ++k)
            batches.push_back({10 * k, 0.1 * k, 1020}); // again
        for (std::uint32_t k = 0; k < 100; ++k)
            batches.push_back({10 * k, 0.1 * k, 1025 + 0.1 * k, 0.5f});
        const Delivered all = delivered(batches);
        CHECK(all.lines.size() == 3100);
        CHECK(all.says("10 again, 1 restarts"));
        CHECK(all.says("3000 samples, 0 missing"));
    }

    TEST_CASE("of two sensors with one id and the same time the first one is used, and the report "
              "names them") {
        std::vector<Batch> batches;
        for (std::uint32_t k = 0; k < 50; ++k) {
            batches.push_back({10 * k, 0.1 * k, 1000 + 0.1 * k});
            batches.push_back({7000 + 10 * k, 0.1 * k + 0.03, 1000.03 + 0.1 * k, 0.5f});
        }
        const Delivered all = delivered(batches);
        CHECK(all.lines.size() == 500);
        CHECK(all.says("expected one sensor with this id, found two: sequence 7"));
        CHECK(all.says("48 of another sensor"));
    }

    TEST_CASE("counts of 8 bits that wrap lose no line") {
        std::vector<Batch> batches;
        for (std::uint32_t k = 0; k < 300; ++k)
            batches.push_back({10 * k % 256, 0.1 * k, 1000 + 0.1 * k, static_cast<float>(k)});
        batches.resize(298); // the last wrap is decided
        CHECK(delivered(batches).lines.size() == 2980);
    }

    TEST_CASE("a restart among messages of before that come late loses no line") {
        std::vector<Batch> batches;
        for (std::uint32_t k = 0; k < 300; ++k)
            if (k % 10 != 5) batches.push_back({10 * k, 0.1 * k, 1000 + 0.1 * k});
        for (std::uint32_t k = 0; k < 100; ++k) {
            batches.push_back({10 * k, 0.1 * k - 500, 1035 + 0.1 * k, 0.5f});
            if (k % 4 == 2 && k < 90)
                batches.push_back({10 * k + 50, 0.1 * k + 0.5, 1035 + 0.1 * k});
        }
        CHECK(delivered(batches).lines.size() == 10 * batches.size());
    }

    TEST_CASE("counts that begin again while the clock goes on wait for three messages, and none "
              "is lost") {
        std::vector<Batch> batches;
        for (std::uint32_t k = 0; k < 100; ++k)
            batches.push_back({k < 50 ? 5000 + 10 * k : 10 * (k - 50), 0.1 * k, 1000 + 0.1 * k});
        CHECK(delivered(batches).lines.size() == 1000);
    }
}
