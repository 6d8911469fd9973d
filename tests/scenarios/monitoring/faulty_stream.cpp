#include "tests/scenarios/monitoring/faulty_stream.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace bris::testing {

namespace {

constexpr double rate = 200, lead = 8; // Hz, s of quiet on either side of a train

/// Messages from memory, as a broker would deliver them.
class GivenLink : public BrokerLink {
public:
    explicit GivenLink(std::deque<BrokerMessage> messages) : messages_(std::move(messages)) {}
    std::optional<BrokerMessage> next(double) override {
        if (messages_.empty()) return {};
        BrokerMessage first = std::move(messages_.front());
        messages_.pop_front();
        now_ = first.time;
        return first;
    }
    bool over() const override { return messages_.empty(); }
    double now() const override { return now_; }
    bool publish(const std::string&, const std::string&, Delivery) override { return true; }
    BrokerCounters counters() const override { return {}; }

private:
    std::deque<BrokerMessage> messages_;
    double now_ = no_arrival;
};

std::string json_of(const Sent& s) {
    return fmt::format("{{\"id\": {}, \"t\": {}, \"seq\": {}, \"ax\": {}, \"ay\": {}, \"az\": {}, "
                       "\"gx\": {}, \"gy\": {}, \"gz\": {}}}",
                       s.sensor, s.t, s.seq, s.force.x(), s.force.y(), s.force.z(), s.rate.x(),
                       s.rate.y(), s.rate.z());
}

SensorPayload payload_of(const Sent& s) {
    SensorPayload p{.channels = 3,
                    .sequence = static_cast<std::uint32_t>(s.seq),
                    .time = s.t,
                    .interval = static_cast<float>(1 / rate)};
    for (const Vec3* v : {&s.force, &s.rate})
        for (int k = 0; k < 3; ++k) p.numbers.push_back(static_cast<float>((*v)[k]));
    return p;
}

/// Samples of one sensor that follow each other are one message, as long as they arrive together.
std::deque<BrokerMessage> messages_of(const std::vector<Sent>& samples) {
    struct Waiting {
        SensorPayload payload;
        Sent last;
        std::size_t order = 0;
    };
    std::map<unsigned, Waiting> waiting;
    std::vector<std::pair<std::size_t, BrokerMessage>> all;
    const auto send = [&](unsigned id, const Waiting& w) {
        all.push_back({w.order,
                       {fmt::format("smartrock/{}/imu", id), bytes_of(w.payload), w.last.retained,
                        Instant{}, w.last.arrival}});
    };
    for (std::size_t k = 0; k < samples.size(); ++k) {
        const Sent& s = samples[k];
        const auto found = waiting.find(s.sensor);
        if (found != waiting.end()) {
            const Waiting& w = found->second;
            const bool together = s.arrival == w.last.arrival && s.seq == w.last.seq + 1 &&
                                  s.retained == w.last.retained &&
                                  std::abs(s.t - w.last.t - 1 / rate) < 1e-4 &&
                                  w.payload.samples() < 40;
            if (!together) {
                send(s.sensor, w);
                waiting.erase(found);
            }
        }
        if (const auto at = waiting.find(s.sensor); at == waiting.end()) {
            waiting[s.sensor] = {payload_of(s), s, k};
        } else {
            const SensorPayload one = payload_of(s);
            at->second.payload.numbers.insert(at->second.payload.numbers.end(), one.numbers.begin(),
                                              one.numbers.end());
            at->second.last = s;
        }
    }
    for (const auto& [id, w] : waiting) send(id, w);
    std::ranges::stable_sort(all, {}, [](const auto& one) { return one.first; });
    std::deque<BrokerMessage> messages;
    for (auto& [order, message] : all) messages.push_back(std::move(message));
    return messages;
}

} // namespace

TrainDay make_day(unsigned sensors, unsigned trains, double interval, std::uint64_t seed) {
    TrainDay day;
    const SyntheticVibration synthetic{.sensors = sensors, .lead = lead};
    std::vector<Passage> good;
    for (unsigned k = 1; k <= 4; ++k)
        good.push_back(synthetic_passage(synthetic, synthetic_state("clean"), seed, k, "good"));
    day.baselines = baselines_of(good, day.settings);
    Random random(seed, 77);
    std::map<unsigned, std::uint64_t> seq;
    for (unsigned k = 0; k < trains; ++k) {
        const Passage p =
            synthetic_passage(synthetic, synthetic_state("clean"), seed, 5 + k, "train");
        for (const Recording& r : p.recordings) {
            if (k == 0) day.infos.push_back(r.info);
            double sent = 0;
            for (std::size_t n = 0; n < r.size(); ++n) {
                const double time = interval * k + static_cast<double>(n) / rate;
                if (n % 40 == 0) sent = time + 0.2 + 0.2 * random.uniform(); // of a message
                day.samples.push_back(
                    {r.info.id, time, time, seq[r.info.id]++, sent, false, r.force[n], r.rate[n]});
            }
        }
    }
    std::ranges::stable_sort(day.samples, {}, &Sent::arrival);
    return day;
}

DayResult follow(const TrainDay& day, std::vector<Sent> samples, Way way,
                 PassageStreamSettings settings) {
    for (const SensorBaseline& b : day.baselines) settings.thresholds[b.id] = b.train_threshold;
    std::unique_ptr<Lines> lines;
    std::optional<GivenLink> link;
    if (way == Way::broker) {
        link.emplace(messages_of(samples));
        lines = std::make_unique<BrokerLines>(*link, day.infos);
    } else {
        std::deque<Lines::Line> given;
        for (const Sent& s : samples)
            given.push_back({given.size() + 1, json_of(s), Instant{}, true,
                             way == Way::pipe ? s.arrival : no_arrival});
        lines = std::make_unique<GivenLines>(std::move(given));
    }
    PassageStream stream(std::move(lines), day.infos, settings);
    MonitorSettings judged = day.settings;
    judged.rest = settings.window + 10;
    DayResult result;
    while (const auto given = stream.next()) {
        if (!given->is_final) continue;
        const PassageResult passage = judge_passage(given->passage, day.baselines, judged);
        std::string text = given->time_is_known ? "" : "time unknown:";
        for (const SensorResult& s : passage.sensors) {
            if (!given->time_is_known && s.id != given->passage.recordings.front().info.id)
                continue;
            text += fmt::format("{}{} {}", text.empty() ? "" : ", ", s.id, text_of(s.verdict));
            result.all_clear += given->time_is_known && s.verdict == Verdict::as_baseline;
            result.changed += given->time_is_known && s.verdict == Verdict::changed;
            result.not_enough_data += given->time_is_known && s.verdict == Verdict::not_enough_data;
            result.time_unknown += !given->time_is_known;
        }
        result.passages.push_back(text);
    }
    result.counts = stream.counts();
    result.report = stream.report();
    return result;
}

} // namespace bris::testing
