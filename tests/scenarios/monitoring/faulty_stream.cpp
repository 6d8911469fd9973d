#include "tests/scenarios/monitoring/faulty_stream.hpp"

#include "scenarios/stream/logged_lines.hpp"
#include "scenarios/stream/logged_link.hpp"
#include "tests/temporary_directory.hpp"

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

namespace {

std::string details_of(const StreamPassage& given, const PassageResult& passage) {
    std::string text = fmt::format("{} {} {} {} {}", given.id, given.passage.name, given.revision,
                                   given.is_final, given.time_is_known);
    for (const Recording& r : given.passage.recordings) text += fmt::format(" {}", r.size());
    for (const SensorResult& s : passage.sensors)
        text += fmt::format(" {} {} {} {} {}", s.id, text_of(s.verdict), s.outlier_shares[0],
                            s.level_ratio(), s.seen_above());
    return text;
}

std::deque<Lines::Line> lines_of(const std::vector<Sent>& samples, Way way) {
    std::deque<Lines::Line> lines;
    for (const Sent& s : samples)
        lines.push_back({lines.size() + 1, json_of(s), Instant{}, true,
                         way == Way::pipe ? s.arrival : no_arrival});
    return lines;
}

DayResult judge(const TrainDay& day, std::unique_ptr<Lines> lines, PassageStreamSettings settings) {
    for (const SensorBaseline& b : day.baselines) settings.thresholds[b.id] = b.train_threshold;
    PassageStream stream(std::move(lines), day.infos, settings);
    MonitorSettings judged = day.settings;
    judged.rest = settings.window + 10;
    DayResult result;
    while (const auto given = stream.next()) {
        const PassageResult passage = judge_passage(given->passage, day.baselines, judged);
        result.given.push_back(details_of(*given, passage));
        if (!given->is_final) continue;
        std::string text = given->time_is_known ? "" : "time unknown:";
        for (const SensorResult& s : passage.sensors) {
            if (!given->time_is_known && s.id != given->passage.recordings.front().info.id)
                continue;
            text += fmt::format("{}{} {}", text.empty() ? "" : ", ", s.id, text_of(s.verdict));
            result.all_clear += given->time_is_known && s.verdict == Verdict::as_baseline;
            result.changed += given->time_is_known && is_change(s.verdict);
            result.not_enough_data += given->time_is_known && s.verdict == Verdict::not_enough_data;
            result.time_unknown += !given->time_is_known;
        }
        result.passages.push_back(text);
    }
    result.counts = stream.counts();
    result.report = stream.report();
    return result;
}

DayResult judge(const TrainDay& day, BrokerLink& link, const PassageStreamSettings& settings) {
    return judge(day, std::make_unique<BrokerLines>(link, day.infos), settings);
}

} // namespace

DayResult follow(const TrainDay& day, std::vector<Sent> samples, Way way,
                 PassageStreamSettings settings) {
    if (way != Way::broker)
        return judge(day, std::make_unique<GivenLines>(lines_of(samples, way)), settings);
    GivenLink link(messages_of(samples));
    return judge(day, link, settings);
}

RestartedDay follow_restarted(const TrainDay& day, std::vector<Sent> samples, Way way,
                              PassageInterval down, double ahead) {
    const TemporaryDirectory folder;
    const auto path = folder / "stream.ndjson";
    const auto records = way == Way::broker ? LoggedRecords::messages : LoggedRecords::lines;
    const auto resumed =
        std::ranges::find_if(samples, [&](const Sent& s) { return s.arrival >= down.begin; });
    const double by = anchor_after({.last = std::prev(resumed)->arrival}, "another boot", down.end,
                                   ahead); // of a clock that shows the time since then
    for (auto s = resumed; s != samples.end(); ++s)
        s->arrival = std::max(s->arrival, down.end) + by;
    RestartedDay day_found;
    for (const auto& part :
         {std::vector<Sent>(samples.begin(), resumed), std::vector<Sent>(resumed, samples.end())}) {
        auto log = std::make_shared<StreamLog>(path, records, std::uint64_t{1} << 40);
        if (way == Way::broker) {
            GivenLink link(messages_of(part));
            LoggedLink logged(link, log);
            day_found.found = judge(day, logged, {});
        } else {
            day_found.found = judge(day,
                                    std::make_unique<LoggedLines>(
                                        std::make_unique<GivenLines>(lines_of(part, way)), log),
                                    {});
        }
    }
    if (way == Way::broker) {
        ReplayedLink again(path, 0, nullptr);
        day_found.replayed = judge(day, again, {});
    } else {
        day_found.replayed = judge(day, open_lines(path), {});
    }
    return day_found;
}

} // namespace bris::testing
