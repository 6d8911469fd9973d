#include "scenarios/monitoring/passage_stream.hpp"

#include "engine/errors.hpp"
#include "engine/interrupt.hpp"
#include "engine/signal/median.hpp"
#include "engine/stopwatch.hpp"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace bris {

namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr double reordered = 2;     // s of own time for which rows wait for those before them
constexpr double look_interval = 1; // s of own time
constexpr double waiting = 10;      // s after a passage before it is given without all sensors
constexpr double glance = 1;        // s between ticks while no record comes
constexpr double shortest = 0.5;    // s; what is shorter is a knock and no train
constexpr std::size_t most_final = 10000;

} // namespace

PassageStream::PassageStream(const std::filesystem::path& source, std::vector<SensorInfo> infos,
                             const PassageStreamSettings& settings)
    : PassageStream(std::make_unique<LineSource>(source), std::move(infos), settings) {}

PassageStream::PassageStream(std::unique_ptr<Lines> lines, std::vector<SensorInfo> infos,
                             const PassageStreamSettings& settings)
    : lines_(std::move(lines)), gate_(infos), settings_(settings) {
    require(!infos.empty(), "stream: expected at least one file rock_NN.txt, found none");
    for (const SensorInfo& info : infos) {
        const auto threshold = settings_.thresholds.find(info.id);
        sensors_[info.id] = {.info = info,
                             .settings = {.quantity = settings_.quantity,
                                          .threshold = threshold == settings_.thresholds.end()
                                                           ? 0
                                                           : threshold->second,
                                          .quiet = settings_.quiet,
                                          .longest = settings_.window}};
    }
}

std::optional<StreamPassage> PassageStream::next() {
    Instant waiting_since = this_instant();
    while (true) {
        if (interrupted()) throw Interrupted("interrupted; the results so far are written");
        if (!ready_.empty()) {
            StreamPassage first = std::move(ready_.front());
            ready_.pop_front();
            return first;
        }
        if (over_) return {};
        const double left = settings_.timeout - seconds_since(waiting_since);
        const auto line = lines_->next(std::clamp(left, 0.0, glance));
        if (line) {
            waiting_since = this_instant();
            take(*line);
        } else if (!interrupted() && (lines_->over() || left <= 0)) {
            over_ = true;
        } else {
            gate_.tick(lines_->now());
        }
        if (over_) gate_.end();
        update();
    }
}

void PassageStream::take(const Lines::Line& line) {
    ++taken_;
    try {
        auto record = parser_.parse(line);
        if (!record) return;
        if (record->has("end")) {
            over_ = record->number("end") != 0;
            return;
        }
        for (GatedRecord& passed : gate_.take(std::move(*record))) keep(std::move(passed));
    } catch (const InputError& e) {
        ++unreadable_;
        gate_.leave_out(LeftOut::unreadable, e.what());
    }
}

void PassageStream::keep(GatedRecord record) {
    Sensor& sensor = sensors_.at(record.id);
    if (record.t > sensor.last) {
        if (record.t < sensor.last + sensor.settings.quiet)
            sensor.recorded += record.t - sensor.last;
    }
    sensor.last = record.t;
    if (join(sensor, record.segment, record)) return;
    Open& open = open_segment(sensor, record.segment);
    if (is_too_late(sensor, open, record))
        return gate_.leave_out(LeftOut::too_late, place_of(record.record, record.t));
    open.newest = std::max(open.newest, record.t);
    open.latest = open.samples.empty() ? record.t : std::max(open.latest, record.t);
    open.samples.add(record);
    if (open.latest - open.looked_at >= look_interval) look(sensor, record.segment, open, false);
}

/// The records of a segment that wait. With a new segment those before it have ended.
PassageStream::Open& PassageStream::open_segment(Sensor& sensor, std::size_t segment) {
    if (const auto found = sensor.open.find(segment); found != sensor.open.end())
        return found->second;
    for (auto& [before, open] : sensor.open) look(sensor, before, open, true);
    return sensor.open[segment];
}

/// Whether the verdict on a record's time is final. Only what comes late can be.
bool PassageStream::is_too_late(const Sensor& sensor, const Open& open,
                                const GatedRecord& record) const {
    if (final_.empty() || record.t >= open.newest - reordered) return false;
    return was_final(gate_.common_time(sensor.info.id, record.segment, record.t));
}

/// Whether the verdict on a common time is final; not on one that is unknown (NaN).
bool PassageStream::was_final(double common) const {
    const auto after = std::ranges::upper_bound(final_, common, {}, &PassageInterval::begin);
    return after != final_.begin() && common <= std::prev(after)->end;
}

/// Finds the common times of activities as far as they are known by now, and forgets those on whose
/// time the verdict is final.
void PassageStream::find_offsets() {
    for (auto& [id, sensor] : sensors_)
        std::erase_if(sensor.activities, [&](Activity& a) {
            if (a.offset) return false;
            const Gate::Offset o = gate_.offset(id, a.segment, a.own.end);
            if (o.basis == TimeBasis::unknown) return false;
            a.offset = o.seconds;
            if (a.passage != 0 || !was_final(0.5 * (a.own.begin + a.own.end) + o.seconds))
                return false;
            gate_.leave_out(LeftOut::too_late,
                            fmt::format("sensor {}: t = {:.10g} s", id, a.own.begin),
                            a.samples.size());
            return true;
        });
}

/// Adds a late record to the activity in whose time it lies. Returns false if there is none.
bool PassageStream::join(Sensor& sensor, std::size_t segment, const GatedRecord& record) {
    for (auto a = sensor.activities.rbegin(); a != sensor.activities.rend(); ++a)
        if (a->segment == segment && record.t >= a->own.begin - sensor.settings.margin &&
            record.t <= a->own.end + sensor.settings.margin) {
            a->samples.add(record);
            return true;
        }
    return false;
}

/// Finds the passages that have ended among the records that wait, and forgets what is quiet.
void PassageStream::look(Sensor& sensor, std::size_t segment, Open& open, bool at_end) {
    open.looked_at = open.latest;
    const std::size_t twice = open.samples.sort();
    if (twice > 0)
        gate_.leave_out(LeftOut::contradiction,
                        fmt::format("sensor {}: two records of one time", sensor.info.id), twice);
    const double settled = at_end ? open.latest + sensor.settings.quiet + 1
                                  : open.latest - reordered - activity_context;
    find_activity(open.samples, sensor.info, sensor.settings, settled);
    double needed = settled;
    for (const PassageInterval& passage : passages_in(open.samples, sensor.settings)) {
        const bool has_ended = settled - passage.end >= sensor.settings.quiet ||
                               settled - passage.begin > sensor.settings.longest;
        if (!has_ended) {
            needed = passage.begin;
            break;
        }
        if (passage.end - passage.begin >= shortest) close(sensor, segment, open, passage);
    }
    open.done = std::max(open.done, needed);
    const double keep_from = needed - activity_context - sensor.settings.margin - look_interval;
    const std::size_t old = at_end ? open.samples.size() : open.samples.row_at(keep_from);
    quiet_ += open.samples.extract(0, old).size();
}

/// Makes an activity of a passage, together with those of the same sensor that it touches.
void PassageStream::close(Sensor& sensor, std::size_t segment, Open& open,
                          const PassageInterval& passage) {
    const double margin = sensor.settings.margin, quiet = sensor.settings.quiet;
    const std::size_t begin = open.samples.row_at(passage.begin - margin),
                      end = open.samples.row_at(std::nextafter(passage.end + margin, 1e300));
    Activity made{segment, passage, {}, open.samples.extract(begin, end)};
    for (auto a = sensor.activities.begin(); a != sensor.activities.end();) {
        const bool touches =
            a->segment == segment && a->own.begin - made.own.end < quiet &&
            made.own.begin - a->own.end < quiet &&
            std::max(a->own.end, made.own.end) - std::min(a->own.begin, made.own.begin) <=
                sensor.settings.longest;
        if (!touches) {
            ++a;
            continue;
        }
        made.own = {std::min(a->own.begin, made.own.begin), std::max(a->own.end, made.own.end)};
        made.samples.merge(std::move(a->samples));
        if (made.passage == 0) made.passage = a->passage;
        a = sensor.activities.erase(a);
    }
    sensor.activities.push_back(std::move(made));
}

/// Gives the passages that have become due, changed or final.
void PassageStream::update() {
    double progress = gate_.now();
    if (std::isnan(progress)) progress = static_cast<double>(taken_) / 1000; // a file
    if (!over_ && progress - updated_ < glance) return;
    updated_ = progress;
    if (over_)
        for (auto& [id, sensor] : sensors_)
            for (auto& [segment, open] : sensor.open) look(sensor, segment, open, true);
    find_offsets();
    for (const Group& group : groups()) {
        const bool is_final = over_ || is_complete(group) || is_over_late(group);
        if (is_final || is_due(group)) give(group, is_final);
        if (is_final) release(group);
    }
    forget_released(); // groups point to them
    if (over_) give_unknown();
    limit_memory();
}

/// The activities whose times are known, those together that have less than `quiet` between them.
std::vector<PassageStream::Group> PassageStream::groups() {
    std::vector<std::pair<PassageInterval, std::pair<Sensor*, Activity*>>> all;
    for (auto& [id, sensor] : sensors_)
        for (Activity& a : sensor.activities) {
            if (!a.offset) continue;
            all.push_back({{a.own.begin + *a.offset, a.own.end + *a.offset}, {&sensor, &a}});
        }
    std::ranges::stable_sort(all, {}, [](const auto& one) { return one.first.begin; });
    std::vector<Group> found;
    for (const auto& [time, member] : all) {
        if (found.empty() || time.begin - found.back().time.end >= settings_.quiet ||
            time.begin - found.back().time.begin > settings_.window)
            found.push_back({time, {}});
        found.back().time.end = std::max(found.back().time.end, time.end);
        found.back().members.push_back(member);
    }
    return found;
}

/// Common time before which the records of a sensor's present segment are all in activities or
/// quiet; NaN: unknown.
double PassageStream::looked_through(const Sensor& sensor) const {
    if (sensor.open.empty()) return nan;
    const auto& [segment, open] = *sensor.open.rbegin();
    return gate_.common_time(sensor.info.id, segment, open.done);
}

/// Whether every sensor has recorded the whole time of a passage.
bool PassageStream::is_complete(const Group& group) const {
    return std::ranges::all_of(sensors_, [&](const auto& sensor) {
        return looked_through(sensor.second) >= group.time.end + settings_.quiet &&
               gate_.coverage(sensor.first, group.time.begin, group.time.end) >= all_recorded;
    });
}

/// Whether a passage can be judged for now: the sensors that go on have passed its end.
bool PassageStream::is_due(const Group& group) const {
    const double end = group.time.end + settings_.quiet + reordered;
    if (gate_.goes_by_arrival()) return gate_.now() >= end + waiting;
    std::size_t heard = 0, passed = 0;
    for (const auto& [id, sensor] : sensors_) {
        const double reached = gate_.reached(id);
        heard += std::isfinite(reached);
        passed += reached >= end;
    }
    return 2 * passed > heard;
}

bool PassageStream::is_over_late(const Group& group) const {
    if (gate_.goes_by_arrival()) return gate_.now() >= group.time.end + settings_.late + waiting;
    std::vector<double> reached;
    for (const auto& [id, sensor] : sensors_)
        if (const double t = gate_.reached(id); std::isfinite(t)) reached.push_back(t);
    return !reached.empty() &&
           median(std::move(reached)) >= group.time.end + settings_.late + waiting;
}

void PassageStream::give(const Group& group, bool is_final) {
    StreamPassage given{.is_final = is_final};
    std::size_t samples = 0;
    for (const auto& [sensor, activity] : group.members) {
        (void)activity->samples.sort();
        samples += activity->samples.size();
        if (activity->passage == 0) continue;
        if (given.id == 0) given.id = activity->passage;
        if (activity->passage != given.id) given.replaces.push_back(activity->passage);
    }
    if (given.id == 0) given.id = ++passages_;
    std::ranges::sort(given.replaces);
    const auto [first, last] = std::ranges::unique(given.replaces);
    given.replaces.erase(first, last);
    Given& before = given_[given.id];
    for (const std::uint64_t other : given.replaces) given_.erase(other);
    const bool has_changed = before.samples != samples || before.time.begin != group.time.begin ||
                             before.time.end != group.time.end || !given.replaces.empty();
    for (const auto& [sensor, activity] : group.members) activity->passage = given.id;
    if (!has_changed && !is_final) return;
    before = {before.revision + (has_changed ? 1u : 0u), samples, group.time};
    given.revision = before.revision;
    given.passage.name = name_of(group.time.begin);
    for (auto& [id, sensor] : sensors_) {
        const auto own = std::ranges::find_if(
            group.members, [&](const auto& member) { return member.first == &sensor; });
        given.passage.recorded[id] = gate_.coverage(id, group.time.begin, group.time.end);
        if (own == group.members.end()) {
            given.passage.recordings.emplace_back().info = sensor.info;
            continue;
        }
        Samples all;
        for (const auto& [of, activity] : group.members)
            if (of == &sensor) // after a final verdict they are not needed any more
                all.merge(is_final ? std::move(activity->samples) : activity->samples);
        (void)all.sort();
        given.passage.recordings.push_back(all.recording(sensor.info));
    }
    ready_.push_back(std::move(given));
}

/// Marks the activities of a final passage, so that `forget_released` forgets them.
void PassageStream::release(const Group& group) {
    std::uint64_t id = 0;
    for (const auto& [sensor, activity] : group.members) {
        id = activity->passage;
        activity->samples = {};
        activity->passage = 0;
        activity->own.end = activity->own.begin - 1; // marked
    }
    in_passages_ += given_[id].samples;
    given_.erase(id);
    final_.insert(std::ranges::upper_bound(final_, group.time.begin, {}, &PassageInterval::begin),
                  group.time);
    if (final_.size() > most_final) final_.erase(final_.begin());
}

void PassageStream::forget_released() {
    for (auto& [id, sensor] : sensors_)
        std::erase_if(sensor.activities, [](const Activity& a) { return a.own.end < a.own.begin; });
}

/// At the end: what vibrated at times that nothing tells.
void PassageStream::give_unknown() {
    for (auto& [id, sensor] : sensors_) {
        for (Activity& a : sensor.activities) {
            StreamPassage given{.id = ++passages_, .is_final = true, .time_is_known = false};
            given.passage.name =
                fmt::format("unknown time, sensor {}, t = {:.6g} s", id, a.own.begin);
            (void)a.samples.sort();
            gate_.leave_out(LeftOut::time_unknown, given.passage.name, a.samples.size());
            given.passage.recordings.push_back(a.samples.recording(sensor.info));
            ready_.push_back(std::move(given));
        }
        sensor.activities.clear();
    }
}

/// Makes the oldest passages final when the records that wait need more than they may.
void PassageStream::limit_memory() {
    const auto limit = static_cast<std::size_t>(1e6 * settings_.memory);
    const auto in_use = [&] {
        std::size_t bytes = 0;
        for (const auto& [id, sensor] : sensors_) {
            for (const Activity& a : sensor.activities) bytes += a.samples.bytes();
            for (const auto& [segment, open] : sensor.open) bytes += open.samples.bytes();
        }
        return bytes;
    };
    while (in_use() > limit) {
        auto all = groups();
        if (!all.empty()) {
            give(all.front(), true);
            release(all.front());
            forget_released();
            continue;
        }
        Sensor* largest = nullptr;
        for (auto& [id, sensor] : sensors_)
            if (!sensor.activities.empty() &&
                (largest == nullptr || sensor.activities.front().samples.size() >
                                           largest->activities.front().samples.size()))
                largest = &sensor;
        if (largest == nullptr) return; // open records alone: `window` bounds them
        gate_.leave_out(LeftOut::no_room,
                        fmt::format("sensor {}: more than {:g} MB of records of unknown time",
                                    largest->info.id, settings_.memory),
                        largest->activities.front().samples.size());
        largest->activities.pop_front();
    }
}

std::string PassageStream::name_of(double common) const {
    if (!gate_.goes_by_arrival()) return fmt::format("{:.1f} s", common);
    return fmt::format("{:%Y-%m-%d %H:%M:%S}",
                       fmt::gmtime(static_cast<std::time_t>(std::floor(common))));
}

StreamCounts PassageStream::counts() const {
    StreamCounts c{.received = gate_.received() + unreadable_,
                   .in_passages = in_passages_,
                   .quiet = quiet_,
                   .left_out = gate_.accounts().total(),
                   .lost = gate_.accounts().lost()};
    c.waiting = c.received - std::min(c.received, c.in_passages + c.quiet + c.left_out);
    return c;
}

double PassageStream::recorded_time() const {
    double longest = 0;
    for (const auto& [id, sensor] : sensors_) longest = std::max(longest, sensor.recorded);
    return longest;
}

std::string PassageStream::report() const {
    const StreamCounts c = counts();
    return fmt::format("{} lines read, {} records: {} in passages, {} quiet, {} left out, {} "
                       "wait\n",
                       taken_, c.received, c.in_passages, c.quiet, c.left_out, c.waiting) +
           gate_.accounts().report() + gate_.report() + parser_.ignored();
}

} // namespace bris
