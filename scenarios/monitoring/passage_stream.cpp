#include "scenarios/monitoring/passage_stream.hpp"

#include "engine/errors.hpp"
#include "engine/interrupt.hpp"
#include "engine/signal/median.hpp"
#include "engine/stopwatch.hpp"
#include "scenarios/recordings/device_channels.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace bris {

namespace {

/// Whether a record of the window has one of the numbers.
template <std::size_t N>
bool any_has(const std::vector<const StreamRecord*>& records,
             const std::array<const char*, N>& names) {
    return std::ranges::any_of(records, [&](const StreamRecord* r) {
        return std::ranges::any_of(names, [&](const char* name) { return r->has(name); });
    });
}

Vec3 vector_of(const StreamRecord& r, const std::array<const char*, 3>& names) {
    return {r.number(names[0]), r.number(names[1]), r.number(names[2])};
}

constexpr std::array force_names{"ax", "ay", "az"}, rate_names{"gx", "gy", "gz"},
    field_names{"mx", "my", "mz"};
constexpr double latest_time = 1e11; // s, where a window still has a length
constexpr std::array attitude_names{"qw", "qx", "qy", "qz"};

} // namespace

PassageStream::PassageStream(const std::filesystem::path& source, std::vector<SensorInfo> infos,
                             const PassageStreamSettings& settings)
    : PassageStream(std::make_unique<LineSource>(source), std::move(infos), settings) {}

PassageStream::PassageStream(std::unique_ptr<Lines> lines, std::vector<SensorInfo> infos,
                             const PassageStreamSettings& settings)
    : lines_(std::move(lines)), infos_(std::move(infos)), settings_(settings) {
    require(!infos_.empty(), "stream: expected at least one file rock_NN.txt, found none");
}

void PassageStream::note(const std::string& kind, const std::string& text) {
    auto& [count, first] = notes_[kind];
    if (count++ == 0) first = text;
}

std::optional<Passage> PassageStream::next() {
    Instant waiting_since = this_instant();
    while (true) {
        if (interrupted()) throw Interrupted("interrupted; the results so far are written");
        if (origin_ && !over_ && reached() > begin_ + settings_.window + settings_.late)
            return close_window();
        const bool pending = std::ranges::any_of(
            samples_, [](const auto& sensor) { return !sensor.second.empty(); });
        if (over_ && !pending) return {};
        if (over_) return close_window();
        const auto line =
            lines_->next(std::max(0.0, settings_.timeout - seconds_since(waiting_since)));
        if (line) {
            waiting_since = this_instant();
            take(*line);
        } else if (!interrupted() &&
                   (lines_->over() || seconds_since(waiting_since) >= settings_.timeout)) {
            over_ = true;
        }
    }
}

void PassageStream::take(const LineSource::Line& line) {
    ++taken_;
    try {
        auto record = parser_.parse(line);
        if (!record) return;
        if (record->has("end"))
            over_ = record->number("end") != 0;
        else
            take_record(std::move(*record));
    } catch (const InputError& e) {
        note("unreadable", e.what());
    }
}

void PassageStream::take_record(StreamRecord record) {
    const double id = record.number("id"), t = record.number("t");
    const auto info = std::ranges::find_if(
        infos_, [&](const SensorInfo& one) { return static_cast<double>(one.id) == id; });
    if (info == infos_.end())
        return note("unknown", fmt::format("line {}: id: expected the id of a file rock_NN.txt, "
                                           "found {}",
                                           record.line, id));
    if (!(std::abs(t) < latest_time)) // a NaN too
        return note("no time", fmt::format("line {}: sensor {}: t: expected a number, found {}",
                                           record.line, id, t));
    const double time = t - info->clock_offset;
    if (!origin_) origin_ = begin_ = time - settings_.late; // earlier records may follow
    if (time < begin_)
        return note("late", fmt::format("line {}: sensor {}: t = {:.10g} s is before the present "
                                        "window",
                                        record.line, id, t));
    last_[info->id] = std::max(last_.emplace(info->id, time).first->second, time);
    if (!samples_[info->id].emplace(t, std::move(record)).second)
        note("again", fmt::format("sensor {}: t = {:.10g} s was sent before; the first record is "
                                  "used",
                                  id, t));
}

/// Time that the median sensor has reached, of those heard in the window.
double PassageStream::reached() const {
    std::vector<double> times;
    for (const auto& [id, time] : last_) times.push_back(time);
    return times.empty() ? -std::numeric_limits<double>::infinity() : median(std::move(times));
}

Passage PassageStream::close_window() {
    const double end = begin_ + settings_.window;
    Passage passage{fmt::format("{:.6g} to {:.6g} s", begin_ - *origin_, end - *origin_), {}};
    for (const SensorInfo& info : infos_) passage.recordings.push_back(recording_of(info, end));
    double earliest = std::numeric_limits<double>::infinity();
    for (const SensorInfo& info : infos_)
        if (const auto& samples = samples_[info.id]; !samples.empty())
            earliest = std::min(earliest, samples.begin()->first - info.clock_offset);
    begin_ = end;
    if (std::isfinite(earliest) && earliest >= end + settings_.window) // nothing came in between
        begin_ += settings_.window * std::floor((earliest - end) / settings_.window);
    last_.clear();
    for (const SensorInfo& info : infos_)
        if (const auto& samples = samples_[info.id]; !samples.empty())
            last_[info.id] = samples.rbegin()->first - info.clock_offset;
    return passage;
}

/// The samples of a sensor before `end`, which are taken out of those that wait.
Recording PassageStream::recording_of(const SensorInfo& info, double end) {
    Samples& all = samples_[info.id];
    const auto stop = all.lower_bound(end + info.clock_offset);
    std::vector<const StreamRecord*> records;
    for (auto at = all.begin(); at != stop; ++at) records.push_back(&at->second);
    Recording r;
    r.info = info;
    const bool force = any_has(records, force_names), rate = any_has(records, rate_names),
               field = any_has(records, field_names), attitude = any_has(records, attitude_names),
               flags = any_has(records, std::array{"flags"});
    std::vector<const DeviceChannel*> device;
    for (const DeviceChannel& channel : device_channels())
        if (any_has(records, std::array{channel.column})) device.push_back(&channel);
    const bool counted = !records.empty() && std::ranges::all_of(records, [](const auto* one) {
        return is_count(one->number("seq"));
    });
    for (const StreamRecord* one : records) {
        r.time.push_back(one->number("t"));
        if (counted) r.sequence.push_back(static_cast<std::uint64_t>(one->number("seq")));
        if (force) r.force.push_back(info.force_of(vector_of(*one, force_names)));
        if (rate) r.rate.push_back(info.rate_of(vector_of(*one, rate_names)));
        if (field) r.field.push_back(info.field_of(vector_of(*one, field_names)));
        if (attitude)
            r.attitude.emplace_back(one->number("qw"), one->number("qx"), one->number("qy"),
                                    one->number("qz"));
        if (flags) {
            const double bits = one->has("flags") ? one->number("flags") : 0;
            r.flags.push_back(is_count(bits) ? static_cast<std::uint64_t>(bits) : 1);
        }
        for (const DeviceChannel* channel : device)
            (r.*channel->values)
                .push_back(channel->value_of_file(info, one->number(channel->column)));
    }
    all.erase(all.begin(), stop);
    reject_flagged(r);
    return r;
}

bool PassageStream::over() const {
    return over_ &&
           std::ranges::all_of(samples_, [](const auto& sensor) { return sensor.second.empty(); });
}

std::string PassageStream::report() const {
    std::string text = fmt::format("{} lines read\n", taken_);
    for (const auto& [kind, what] : notes_)
        text += fmt::format("{} time{}: {}\n", what.first, what.first == 1 ? "" : "s", what.second);
    return text;
}

} // namespace bris
