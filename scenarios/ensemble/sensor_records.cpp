#include "scenarios/ensemble/sensor_records.hpp"

#include "engine/signal/median.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace bris {

namespace {

constexpr std::size_t fewest_times = 3; // from which a segment is placed
constexpr double shortest_step = 0.01;  // s between segments that would overlap

bool same_number(double a, double b) { return a == b || (std::isnan(a) && std::isnan(b)); }

constexpr std::uint64_t bits_of(std::size_t first, std::size_t count) {
    return ((std::uint64_t{1} << count) - 1) << first;
}

} // namespace

bool SensorSample::has(std::size_t first, std::size_t numbers_from_it) const {
    return (sent & bits_of(first, numbers_from_it)) != 0;
}

SensorSample sample_of(const StreamRecord& record) {
    SensorSample sample;
    for (std::size_t k = 0; k < channel_columns.size(); ++k) {
        const double number = record.number(channel_columns[k]);
        sample.numbers.push_back(number);
        // without a valid number the strain comes from the machine
        const bool needs_number = k == in_sample::strain || k == in_sample::phase;
        if (record.has(channel_columns[k]) && (!needs_number || std::isfinite(number)))
            sample.sent |= bits_of(k, 1);
    }
    return sample;
}

bool same_numbers(const SensorSample& a, const SensorSample& b) {
    return a.sent == b.sent && std::ranges::equal(a.numbers, b.numbers, same_number);
}

namespace {

/// Places segments beside each other, beginning with the one whose times are known.
class Placement {
public:
    Placement(const std::vector<SegmentEvidence>& segments, double clock_offset, double tolerance)
        : segments_(segments), tolerance_(tolerance), clock_offset_(clock_offset),
          shifts_(segments.size()) {}

    std::vector<std::optional<double>> run() {
        const auto known = std::ranges::find_if(segments_, [](const SegmentEvidence& s) {
            return s.by_strain.has_value() || s.stands;
        });
        const auto first =
            known == segments_.end() ? 0 : static_cast<std::size_t>(known - segments_.begin());
        shifts_[first] = 0;
        to_machine_ = segments_[first].by_strain.value_or(-clock_offset_);
        for (std::size_t k = first + 1; k < segments_.size(); ++k) place(k);
        for (std::size_t k = first; k-- > 0;) place(k);
        return shifts_;
    }

private:
    void place(std::size_t k) {
        auto shift = shift_of(k);
        if (shift && k > 0 && shifts_[k - 1])
            *shift += needed(segments_[k - 1].last + *shifts_[k - 1], segments_[k].first + *shift);
        else if (shift && k + 1 < segments_.size() && shifts_[k + 1])
            *shift -= needed(segments_[k].last + *shift, segments_[k + 1].first + *shifts_[k + 1]);
        if (shift && is_free(k, *shift)) shifts_[k] = shift;
    }

    /// s by which two segments have to be moved apart; 0 also where they are too far in each other.
    double needed(double end, double begin) const {
        const double overlap = end - begin;
        return overlap >= 0 && overlap <= tolerance_ ? overlap + shortest_step : 0;
    }

    std::optional<double> shift_of(std::size_t k) const {
        const SegmentEvidence& s = segments_[k];
        if (s.by_strain) return *s.by_strain - to_machine_;
        if (s.stands) return -clock_offset_ - to_machine_;
        for (std::size_t other = k; other-- > 0;) // the nearest before
            if (shifts_[other])
                if (const double step = s.offset_at_first - segments_[other].offset_at_last;
                    std::isfinite(step))
                    return step + *shifts_[other];
        for (std::size_t other = k + 1; other < segments_.size(); ++other)
            if (shifts_[other])
                if (const double step = s.offset_at_last - segments_[other].offset_at_first;
                    std::isfinite(step))
                    return step + *shifts_[other];
        // the clock with which a sensor began, as long as nothing contradicts it
        return k == 0 ? std::optional{-clock_offset_ - to_machine_} : std::nullopt;
    }

    /// Whether no other segment recorded in the time of this one.
    bool is_free(std::size_t k, double shift) const {
        for (std::size_t other = 0; other < segments_.size(); ++other)
            if (shifts_[other] &&
                segments_[k].first + shift <= segments_[other].last + *shifts_[other] &&
                segments_[other].first + *shifts_[other] <= segments_[k].last + shift)
                return false;
        return true;
    }

    const std::vector<SegmentEvidence>& segments_;
    double tolerance_, clock_offset_, to_machine_ = 0;
    std::vector<std::optional<double>> shifts_;
};

} // namespace

std::vector<std::optional<double>> shifts_of(const std::vector<SegmentEvidence>& segments,
                                             double clock_offset, double tolerance) {
    if (segments.empty()) return {};
    return Placement(segments, clock_offset, tolerance).run();
}

bool SensorRecords::add(const GatedRecord& record, double machine_t) {
    SensorSample sample = sample_of(record.record);
    sample.count = record.count;
    Segment& segment = segments_[record.segment];
    segment.turns = record.turns;
    return enter(segment, record.t, std::move(sample), machine_t);
}

bool SensorRecords::enter(Segment& segment, double t, SensorSample sample, double machine_t) {
    const std::uint64_t sent = sample.sent;
    if (!segment.by_time.emplace(t, std::move(sample)).second) return false;
    sent_ |= sent;
    if (std::isfinite(machine_t)) segment.ahead.push_back(t - clock_offset_ - machine_t);
    return true;
}

bool SensorRecords::add_between(const StreamRecord& record, double machine_t) {
    if (segments_.empty()) return false;
    Segment& segment = segments_.rbegin()->second;
    const double t = record.number("t") + segment.turns;
    const auto after = segment.by_time.upper_bound(t);
    if (after == segment.by_time.begin() || after == segment.by_time.end()) return false;
    const SensorSample &earlier = std::prev(after)->second, &later = after->second;
    SensorSample sample = sample_of(record);
    const auto is_between = [&](std::size_t number) {
        return sample.has(number) && earlier.numbers[number] < sample.numbers[number] &&
               sample.numbers[number] < later.numbers[number];
    };
    const bool fits = !sample.has(in_sample::strain) || !earlier.has(in_sample::strain) ||
                      !later.has(in_sample::strain) ||
                      (earlier.numbers[in_sample::strain] <= sample.numbers[in_sample::strain] &&
                       sample.numbers[in_sample::strain] <= later.numbers[in_sample::strain]);
    if (!fits) return false; // as after a restart of both
    if (!is_between(sample.has(in_sample::sequence) ? in_sample::sequence : in_sample::strain))
        return false;
    if (earlier.count >= 0 && sample.has(in_sample::sequence))
        sample.count = earlier.count + std::llround(sample.numbers[in_sample::sequence] -
                                                    earlier.numbers[in_sample::sequence]);
    return enter(segment, t, std::move(sample), machine_t);
}

const SensorSample* SensorRecords::recorded_at(double raw_t) const {
    for (auto s = segments_.rbegin(); s != segments_.rend(); ++s) {
        const auto found = s->second.by_time.find(raw_t + s->second.turns);
        if (found != s->second.by_time.end()) return &found->second;
    }
    return nullptr;
}

void SensorRecords::update(const Gate& gate, unsigned id, std::size_t number) {
    Segment& segment = segments_.at(number);
    const auto offset_at = [&](double t) {
        const Gate::Offset o = gate.offset(id, number, t);
        return o.basis == TimeBasis::arrival ? o.seconds : SegmentEvidence::unknown;
    };
    segment.offset_at_first = offset_at(segment.by_time.begin()->first);
    segment.offset_at_last = offset_at(segment.by_time.rbegin()->first);
    segment.is_too_short = gate.is_too_short(id, number);
}

SegmentEvidence SensorRecords::evidence_of(const Segment& segment, const TestTimes& times) const {
    SegmentEvidence e{.first = segment.by_time.begin()->first,
                      .last = segment.by_time.rbegin()->first,
                      .offset_at_first = segment.offset_at_first,
                      .offset_at_last = segment.offset_at_last};
    std::vector<double> by_strain;
    for (const auto& [t, sample] : segment.by_time) {
        const double strain = times.own_strain(sample);
        if (!(strain > 0)) continue; // at rest a strain does not determine a time
        if (const double at = times.time_at(strain); std::isfinite(at)) by_strain.push_back(at - t);
    }
    if (by_strain.size() >= fewest_times) e.by_strain = median(std::move(by_strain));
    e.stands =
        segment.ahead.size() >= fewest_times && std::abs(median(segment.ahead)) <= times.uncertain;
    return e;
}

SensorTimeline SensorRecords::timeline(const TestTimes& times) const {
    constexpr double scatter = 5; // s, of times of arrival
    std::vector<SegmentEvidence> evidence;
    if (segments_.size() > 1) // else its own times count, and nothing has to be looked for
        for (const auto& [number, segment] : segments_)
            evidence.push_back(evidence_of(segment, times));
    else
        evidence.resize(segments_.size());
    const double uncertain = std::isfinite(times.uncertain) ? times.uncertain : 0;
    const auto shifts = shifts_of(evidence, clock_offset_, scatter + uncertain);
    SensorTimeline timeline;
    std::vector<std::pair<double, const Segment*>> placed; // shift
    for (std::size_t k = 0; const auto& [number, segment] : segments_) {
        if (shifts[k])
            placed.emplace_back(*shifts[k], &segment);
        else if (timeline.of_unknown_time == 0)
            timeline.first_unknown =
                fmt::format("t = {:.10g} s to {:.10g} s of its clock",
                            segment.by_time.begin()->first, segment.by_time.rbegin()->first);
        if (!shifts[k++]) timeline.of_unknown_time += segment.by_time.size();
    }
    std::ranges::stable_sort(
        placed, {}, [](const auto& one) { return one.second->by_time.begin()->first + one.first; });
    for (const auto& [shift, segment] : placed) append(timeline, *segment, shift, times);
    return timeline;
}

/// Adds the records of a segment. Its counts go on behind those before it, at the nominal rate.
void SensorRecords::append(SensorTimeline& timeline, const Segment& segment, double shift,
                           const TestTimes& times) const {
    std::int64_t more = 0; // counts to be added
    if (!timeline.samples.empty()) {
        const PlacedSample& before = timeline.samples.back();
        const double gap = segment.by_time.begin()->first + shift - before.t;
        more = before.count + std::max<std::int64_t>(1, std::llround(gap * rate_)) -
               segment.by_time.begin()->second.count;
    }
    for (const auto& [t, sample] : segment.by_time) {
        if (segment.is_too_short && std::isnan(times.own_strain(sample))) {
            if (timeline.of_unknown_time++ == 0)
                timeline.first_unknown = fmt::format("t = {:.10g} s of its clock", t);
            continue;
        }
        timeline.samples.push_back(
            {t + shift, sample.count < 0 ? -1 : sample.count + more, &sample});
    }
    for (const double ahead : segment.ahead) timeline.ahead.push_back(ahead + shift);
}

} // namespace bris
