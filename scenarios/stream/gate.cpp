#include "scenarios/stream/gate.hpp"

#include "engine/printable.hpp"
#include "engine/running_hash.hpp"
#include "engine/signal/median.hpp"

#include <fmt/format.h>

#include <bit>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

namespace bris {

namespace {

constexpr double latest_time = 1e11;                   // s, that is still counted in milliseconds
constexpr double first_epoch = 1e9, last_epoch = 1e10; // s since 1970: a clock that knows the date
constexpr double together = 3600;                      // s between recordings of one test at most
constexpr double steady_for = 10; // s, of times that go with those of the others
constexpr double nan = std::numeric_limits<double>::quiet_NaN();

/// Of the numbers of a record, which tells copies from others.
std::uint64_t content_of(const StreamRecord& record) {
    std::uint64_t hash = 0;
    for (const double number : record.values())
        hash = mix(hash, std::bit_cast<std::uint64_t>(number));
    return hash;
}

std::string place_of(const StreamRecord& record) { return place_of(record, record.number("t")); }

} // namespace

std::string place_of(const StreamRecord& record, double t) {
    return fmt::format("line {}: sensor {}: t = {:.10g} s", record.line, record.number("id"), t);
}

void Accounts::add(LeftOut reason, const std::string& example, std::uint64_t count) {
    const auto k = static_cast<std::size_t>(reason);
    if (counts_[k] == 0 && count > 0) examples_[k] = printable(example);
    counts_[k] += count;
}

std::uint64_t Accounts::total() const {
    return std::accumulate(counts_.begin(), counts_.end(), std::uint64_t{0});
}

std::uint64_t Accounts::lost() const { return total() - count(LeftOut::again); }

std::string Accounts::report() const {
    std::string text;
    for (std::size_t k = 0; k < counts_.size(); ++k)
        if (counts_[k] > 0)
            text += fmt::format("{} record{} {}: {}\n", counts_[k], counts_[k] == 1 ? "" : "s",
                                text_of(static_cast<LeftOut>(k)), examples_[k]);
    return text;
}

Gate::Gate(const std::vector<SensorInfo>& infos) {
    for (const SensorInfo& info : infos)
        sources_.emplace(
            info.id, Source{info, SensorClock(info.sampling_rate), Counter(info.sampling_rate)});
}

void Gate::tick(double arrival) {
    if (!(now_ >= arrival)) now_ = arrival;
}

std::vector<GatedRecord> Gate::take(StreamRecord record) {
    ++received_;
    tick(record.arrival);
    const double id = record.number("id"), t = record.number("t");
    const auto found = id >= 0 && id < 1e9 && id == std::floor(id)
                           ? sources_.find(static_cast<unsigned>(id))
                           : sources_.end();
    if (found == sources_.end()) {
        accounts_.add(LeftOut::unknown_id,
                      fmt::format("line {}: id: expected the id of a file rock_NN.txt, found {}",
                                  record.line, id));
        return {};
    }
    if (!(std::abs(t) < latest_time)) { // a NaN too
        accounts_.add(
            LeftOut::no_time,
            fmt::format("line {}: sensor {}: t: expected a number, found {}", record.line, id, t));
        return {};
    }
    Source& source = found->second;
    const SensorClock::Decision decision = source.clock.take(
        {t, record.arrival, std::isfinite(record.arrival) ? nan : time_of_others(found->first),
         content_of(record)});
    std::vector<GatedRecord> passed;
    const auto taken_out = [&](std::uint64_t chain) {
        auto held = source.held.extract(chain);
        return held.empty() ? std::vector<StreamRecord>{} : std::move(held.mapped());
    };
    if (decision.held != SensorClock::Action::hold)
        for (StreamRecord& before : taken_out(decision.chain)) {
            if (decision.held == SensorClock::Action::keep)
                passed.push_back(pass(source, std::move(before), decision));
            else
                accounts_.add(decision.reason, place_of(before));
        }
    if (decision.forgotten != 0) forget(source, taken_out(decision.forgotten));
    if (decision.record == SensorClock::Action::hold)
        source.held[decision.chain].push_back(std::move(record));
    else if (decision.record == SensorClock::Action::keep)
        passed.push_back(pass(source, std::move(record), decision));
    else
        accounts_.add(decision.reason, place_of(record));
    return passed;
}

GatedRecord Gate::pass(Source& source, StreamRecord record, const SensorClock::Decision& decision) {
    GatedRecord gated{source.info.id,    decision.segment, record.number("t") + decision.turns, -1,
                      std::move(record), decision.turns};
    const bool is_first = source.passed++ == 0;
    const bool began = source.ranges.size() <= decision.segment;
    if (began) {
        source.ranges.resize(decision.segment + 1, {gated.t, gated.t});
        if (!is_first) source.counter.restart();
    }
    const double elapsed =
        is_first || began ? 1 / source.info.sampling_rate : gated.t - source.latest;
    auto& [first, last] = source.ranges[decision.segment];
    first = std::min(first, gated.t);
    last = std::max(last, gated.t);
    const bool is_current = source.clock.current()->number == decision.segment;
    if (const double raw = gated.record.number("seq"); is_count(raw) && is_current)
        gated.count = source.counter.take(static_cast<std::uint64_t>(raw), elapsed);
    if (began || (is_current && gated.t > source.latest)) source.latest = gated.t;
    return gated;
}

void Gate::end() {
    ended_ = true;
    for (auto& [id, source] : sources_)
        for (const auto& [chain, records] : std::exchange(source.held, {})) forget(source, records);
}

/// Accounts for records that were held and with which no others agreed.
void Gate::forget(const Source& source, const std::vector<StreamRecord>& held) {
    for (const StreamRecord& record : held)
        accounts_.add(source.clock.has_recorded(record.number("t")) ? LeftOut::contradiction
                                                                    : LeftOut::impossible,
                      place_of(record));
}

Gate::Waiting Gate::waiting() const {
    Waiting all;
    for (const auto& [id, source] : sources_)
        for (const auto& [chain, records] : source.held) {
            if (all.records == 0) all.first = place_of(records.front());
            all.records += records.size();
        }
    return all;
}

bool Gate::goes_by_arrival() const {
    for (const auto& [id, source] : sources_)
        if (const auto* s = source.clock.current(); s != nullptr && s->confirmed) return true;
    return false;
}

/// Time that the other sources have reached, if most of all sources are there together; NaN: they
/// are not.
double Gate::time_of_others(unsigned id) const {
    std::vector<double> times;
    std::size_t heard = 1;
    for (const auto& [other, source] : sources_) {
        const SensorClock::Segment* s = source.clock.current();
        if (other == id || s == nullptr) continue;
        ++heard;
        if (!s->went_back) times.push_back(s->last - source.info.clock_offset);
    }
    if (times.empty()) return nan;
    const double middle = median(times);
    std::erase_if(times, [&](double t) { return std::abs(t - middle) > together; });
    return 2 * times.size() > heard ? median(std::move(times)) : nan;
}

/// Whether the own times of a segment are those at which most sources recorded something.
bool Gate::agrees_with_most(const Source& source, const SensorClock::Segment& segment) const {
    std::size_t heard = 0, agreeing = 0;
    const double first = segment.first - source.info.clock_offset,
                 last = segment.last - source.info.clock_offset;
    for (const auto& [id, other] : sources_) {
        if (other.ranges.empty()) continue;
        ++heard;
        const double offset = other.info.clock_offset;
        agreeing += std::ranges::any_of(other.ranges, [&](const auto& range) {
            return range.first - offset <= last + together &&
                   range.second - offset >= first - together;
        });
    }
    return 2 * agreeing > heard;
}

Gate::Offset Gate::offset(unsigned id, std::size_t number, double t) const {
    const Source& source = sources_.at(id);
    const SensorClock::Segment* s = source.clock.segment(number);
    if (s == nullptr || s->is_too_short()) return {};
    if (const double by_arrival = s->offset_at(t); std::isfinite(by_arrival))
        return {TimeBasis::arrival, by_arrival};
    if (goes_by_arrival()) { // only a clock that knows the date tells when it recorded
        const bool knows_date =
            s->first > first_epoch && s->last < last_epoch && s->last <= now_ + together;
        return knows_date ? Offset{TimeBasis::own, 0} : Offset{};
    }
    if (!s->went_back && agrees_with_most(source, *s))
        return {TimeBasis::own, -source.info.clock_offset};
    if (s->most_to_others >= s->least_to_others && s->last - s->first_with_others >= steady_for)
        return {TimeBasis::others, 0.5 * (s->most_to_others + s->least_to_others)};
    return {};
}

double Gate::common_time(unsigned id, std::size_t segment, double t) const {
    const Offset o = offset(id, segment, t);
    return o.basis == TimeBasis::unknown ? nan : t + o.seconds;
}

double Gate::reached(unsigned id) const {
    const SensorClock::Segment* s = sources_.at(id).clock.current();
    return s == nullptr ? nan : common_time(id, s->number, s->last);
}

double Gate::coverage(unsigned id, double from, double to) const {
    const Source& source = sources_.at(id);
    double covered = 0;
    for (std::size_t k = 0; k < source.ranges.size(); ++k) {
        const SensorClock::Segment* s = source.clock.segment(k);
        if (s == nullptr) continue;
        const Offset o = offset(id, k, 0.5 * (from + to));
        if (o.basis == TimeBasis::unknown) continue;
        for (const auto& [first, last] : s->covered)
            covered +=
                std::max(0.0, std::min(last + o.seconds, to) - std::max(first + o.seconds, from));
    }
    return to > from ? covered / (to - from) : 0;
}

bool Gate::is_too_short(unsigned id, std::size_t segment) const {
    const SensorClock::Segment* s = sources_.at(id).clock.segment(segment);
    return s != nullptr && s->is_too_short();
}

std::string Gate::changes(unsigned id) const {
    const Source& source = sources_.at(id);
    const SensorClock::Segment* s = source.clock.current();
    std::string text;
    if (source.clock.restarts() > 0)
        text += fmt::format(", its clock was set or began again {} times", source.clock.restarts());
    if (source.clock.wraps() > 0)
        text += fmt::format(", its clock wrapped {} times", source.clock.wraps());
    if (s != nullptr && s->is_too_short())
        text += ", which is too often for its delays: clock too short";
    if (source.counter.wraps() > 0)
        text += fmt::format(", its counts wrapped {} times", source.counter.wraps());
    if (source.counter.restarts() > 0)
        text += fmt::format(", its counts began again {} times", source.counter.restarts());
    return text;
}

std::string Gate::report() const {
    std::string text;
    for (const auto& [id, source] : sources_) {
        const SensorClock::Segment* s = source.clock.current();
        if (s == nullptr) continue;
        const Offset o = offset(id, s->number, s->last);
        const char* const basis = o.basis == TimeBasis::arrival  ? "times by arrival"
                                  : o.basis == TimeBasis::own    ? "its own times"
                                  : o.basis == TimeBasis::others ? "times by the other sensors"
                                                                 : "time unknown";
        text += fmt::format("sensor {}: {} records passed, {}{}\n", id, source.passed, basis,
                            changes(id));
    }
    return text;
}

} // namespace bris
