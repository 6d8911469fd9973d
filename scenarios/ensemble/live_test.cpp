#include "scenarios/ensemble/live_test.hpp"

#include "engine/errors.hpp"
#include "engine/interrupt.hpp"
#include "engine/printable.hpp"
#include "engine/signal/median.hpp"
#include "scenarios/records/quality_control_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <thread>
#include <utility>

namespace bris {

namespace {

constexpr double same_strain = MachineTimes::same_strain;
constexpr std::size_t most_kinds = 40;  // of faults that are listed apart
constexpr std::size_t fewest_times = 3; // number of differences from which a clock is judged

/// What faults of the same kind have in common: the message without the number of the line, without
/// what was found, and without numbers and quoted texts.
std::string fault_of(const std::string& message) {
    std::string fault;
    bool is_quoted = false;
    const std::size_t start = message.starts_with("line ") ? message.find(": ") + 2 : 0;
    for (const char c : std::string_view(message).substr(start, message.find(", found") - start)) {
        if (c == '"') is_quoted = !is_quoted;
        if (!is_quoted && (c < '0' || c > '9')) fault += c;
    }
    return fault;
}

/// By how much (s) a clock may differ from the machine's.
double uncertain(const SensorInfo& info, double step_of_machine) {
    return 3 * info.clock_offset_deviation + step_of_machine;
}

std::string unknown_times(const SensorTimeline& timeline) {
    return fmt::format("expected strain in its records, or steady times of arrival, from when its "
                       "clock was set or began again, found neither: {} records of unknown time "
                       "are left out",
                       timeline.of_unknown_time);
}

/// Adds what the machine measured as a row.
void add_record(MeasuredCurves& curves, const StreamRecord& record) {
    const auto row = curves.add_row();
    for (const Quantity* q :
         {&quantity::axial_strain, &quantity::deviatoric_stress, &quantity::volumetric_strain})
        row[*q] = record.number(title_of(*q));
    for (std::size_t r = 0; record.has(title_of(quantity::ring_radius, r)); ++r)
        row.part(quantity::ring_radius, r) = record.number(title_of(quantity::ring_radius, r));
}

} // namespace

LiveTest::LiveTest(std::unique_ptr<Lines> lines, std::vector<SensorInfo> infos,
                   const LiveSettings& settings)
    : lines_(std::move(lines)), infos_(std::move(infos)), settings_(settings), gate_(infos_) {
    require(!infos_.empty(), "stream: expected at least one SmartRock, found none");
    for (const SensorInfo& info : infos_) sensors_.emplace(info.id, info);
}

void LiveTest::note(const std::string& kind, const std::string& text) {
    // a stream of noise could have any number of kinds
    const bool is_new = !notes_.contains(kind);
    auto& [count, first] = notes_[is_new && notes_.size() >= most_kinds ? "others" : kind];
    if (count++ == 0) first = printable(text);
}

void LiveTest::end(const std::string& why) {
    over_ = true;
    gate_.end();
    note("end", why);
}

bool LiveTest::follow_to(double strain) {
    waiting_since_ = this_instant();
    while (!over_ && (machine_.empty() ||
                      machine_.rbegin()->first < strain + settings_.analysis_delay - same_strain)) {
        if (interrupted())
            throw Interrupted("interrupted; all lines so far are logged: continue with --resume "
                              "and the folder of the results");
        const double left = settings_.timeout - seconds_since(waiting_since_);
        if (auto line = lines_->next(std::max(0.0, left)))
            take_line(std::move(*line));
        else if (interrupted())
            continue;
        else if (lines_->over())
            end(fmt::format("the stream ended after {} lines", taken_));
        else if (seconds_since(waiting_since_) >= settings_.timeout)
            end(fmt::format("no {} arrived for {:g} s after {} lines",
                            machine_.empty() ? "line" : "record of the test machine",
                            settings_.timeout, taken_));
    }
    followed_ = std::max(followed_, strain);
    return !machine_.empty() && machine_.rbegin()->first >= strain - same_strain;
}

void LiveTest::take_line(Lines::Line line) {
    line.number = ++taken_;
    const bool is_of_earlier_session = line.arrived == Instant{};
    // before the first record of the machine any line keeps the stream alive
    if (machine_.empty()) waiting_since_ = this_instant();
    std::optional<StreamRecord> record;
    try {
        record = parser_.parse(line);
    } catch (const InputError& e) {
        note(fault_of(e.what()), e.what());
    }
    if (!record) return;
    if (record->has("end")) { // 0: the test goes on
        if (record->number("end") != 0)
            end(fmt::format("the sender ended the test after {} lines", taken_));
        return;
    }
    if (!is_of_earlier_session) {
        wait_for_its_time(*record);
        arrivals_.push_back(record->arrived);
    }
    take(std::move(*record));
}

/// Delays a record of a replay until it is due.
void LiveTest::wait_for_its_time(StreamRecord& record) {
    constexpr double longest = 600; // s; a record whose t is wrong does not wait longer
    if (settings_.speed <= 0 || !std::isfinite(record.number("t"))) return;
    if (!begun_) {
        begun_ = true;
        began_ = this_instant();
        first_t_ = record.number("t");
    }
    const double due = (record.number("t") - first_t_) / settings_.speed;
    if (due < 0 || due > seconds_since(began_) + longest) return;
    while (seconds_since(began_) < due && !interrupted())
        std::this_thread::sleep_for(
            std::chrono::duration<double>(std::clamp(due - seconds_since(began_), 0.0, 0.1)));
    record.arrived =
        began_ + std::chrono::duration_cast<Instant::duration>(std::chrono::duration<double>(due));
}

void LiveTest::take(StreamRecord record) {
    if (record.has("id"))
        take_of_sensor(std::move(record));
    else if (record.has("axial_strain") && record.has("deviatoric_stress_Pa"))
        take_of_machine(record);
    else
        note("unknown",
             fmt::format(
                 "line {}: expected an id, or axial_strain and deviatoric_stress_Pa, found neither",
                 record.line));
}

void LiveTest::take_of_sensor(StreamRecord record) {
    const double id = record.number("id"), t = record.number("t");
    const auto found = id >= 0 && id == std::floor(id) && id < 1e9
                           ? sensors_.find(static_cast<unsigned>(id))
                           : sensors_.end();
    if (found == sensors_.end())
        return note(fmt::format("id {}", id),
                    fmt::format("line {}: expected the id of a file rock_NN.txt, found {}",
                                record.line, id));
    look_for_numbers(record);
    if (!std::isfinite(t))
        return note("no time", fmt::format("line {}: sensor {}: t: expected a number, found {}",
                                           record.line, id, t));
    // one wrong strain would be taken for the end of the test
    if (record.number("strain") > track_.reached() + MachineTrack::largest_jump)
        return note_far_off(record, "a sensor", record.number("strain"));
    pass_gate(std::move(record), found->second);
}

/// Keeps the records that pass the gate with this one. A copy never passes, however old it is.
void LiveTest::pass_gate(StreamRecord record, SensorRecords& sensor) {
    const auto id = static_cast<unsigned>(record.number("id"));
    ++sensor.received;
    const SensorSample* known = sensor.recorded_at(record.number("t"));
    if (known != nullptr && same_numbers(*known, sample_of(record))) {
        ++sensor.twice;
        return gate_.leave_out(LeftOut::again, place_of(record, record.number("t")));
    }
    const auto count_if_late = [&](const StreamRecord& r) {
        sensor.late += static_cast<std::uint64_t>(r.number("strain") < followed_ - same_strain);
    };
    if (known == nullptr && sensor.add_between(record, times_.last_t_at(record.line)))
        return count_if_late(record);
    const std::uint64_t again = gate_.accounts().count(LeftOut::again);
    for (const GatedRecord& passed : gate_.take(std::move(record))) {
        if (!sensor.add(passed, times_.last_t_at(passed.record.line))) {
            gate_.leave_out(LeftOut::contradiction, place_of(passed.record, passed.t));
            continue;
        }
        count_if_late(passed.record);
        sensor.update(gate_, id, passed.segment);
    }
    sensor.twice += gate_.accounts().count(LeftOut::again) - again;
}

/// Reports entries that are not valid numbers. They are stored as they are and left to quality
/// control, but strain, phase, seq and flags are treated as if they had not been sent.
void LiveTest::look_for_numbers(const StreamRecord& record) {
    for (const std::string_view name : channel_columns) {
        const double number = record.number(name);
        const bool whole = name == "seq" || name == "flags";
        if (!record.has(name) || (std::isfinite(number) && !(whole && !is_count(number)))) continue;
        const double id = record.number("id");
        note(fmt::format("{} of {}", name, id),
             fmt::format("line {}: sensor {}: {}: expected a {}number, found {}", record.line, id,
                         name, whole ? "whole " : "", number));
    }
}

void LiveTest::note_far_off(const StreamRecord& record, const char* who, double strain) {
    note(std::string("far off, ") + who,
         fmt::format(
             "line {}: {}: expected an axial strain near {:.4g}, found {:.4g}: is it in per cent?",
             record.line, who, track_.reached(), strain));
}

void LiveTest::take_of_machine(const StreamRecord& record) {
    const double strain = record.number("axial_strain");
    if (!std::isfinite(strain) || !std::isfinite(record.number("deviatoric_stress_Pa")))
        return note(
            "not finite",
            fmt::format(
                "line {}: axial_strain, deviatoric_stress_Pa: expected numbers, found {} and {}",
                record.line, strain, record.number("deviatoric_stress_Pa")));
    const auto decision = track_.take(record);
    if (decision.is_ahead) note_far_off(record, "the machine", strain);
    if (decision.is_gap)
        note("gap", fmt::format("line {}: the machine continues at an axial strain of {:.4g}; the "
                                "records in between are lost",
                                record.line, decision.used.front().number("axial_strain")));
    for (const StreamRecord& one : decision.used) accept(one);
}

void LiveTest::accept(const StreamRecord& record) {
    const double strain = record.number("axial_strain");
    waiting_since_ = this_instant();
    if (!machine_.emplace(strain, record).second)
        return note(
            "twice",
            fmt::format("line {}: the machine sent axial_strain = {} before; the first record is "
                        "used",
                        record.line, strain));
    if (const double t = record.number("t");
        std::isfinite(t) && !times_.enter_time(t, strain, taken_))
        note("machine's t", fmt::format("line {}: the machine: t: expected a time after "
                                        "those of smaller strains, found {}",
                                        record.line, t));
    if (const double phase = record.number("phase");
        std::isfinite(phase) && !times_.enter_phase(phase, strain))
        note("phase", fmt::format("line {}: the machine's phase: expected increasing numbers, "
                                  "found {:.4g} after {:.4g}",
                                  record.line, phase, times_.last_phase()));
}

/// Whether the strain of a sample without one is found by its phase.
bool LiveTest::goes_by_phase(const SensorSample& sample) const {
    return !sample.has(in_sample::strain) && sample.has(in_sample::phase) &&
           !times_.strain_at().by_phase.empty();
}

/// Axial strain of a sample by its own strain or phase; NaN: it has neither.
double LiveTest::own_strain(const SensorSample& sample) const {
    if (sample.has(in_sample::strain)) return sample.numbers[in_sample::strain];
    if (goes_by_phase(sample))
        return strain_between(times_.strain_at().by_phase, sample.numbers[in_sample::phase]);
    return std::nan("");
}

double LiveTest::strain_of(double t, const SensorSample& sample) const {
    const bool has_own = sample.has(in_sample::strain) || goes_by_phase(sample);
    return has_own ? own_strain(sample) : strain_between(times_.strain_at().by_time, t);
}

LiveTest::Timelines LiveTest::timelines() const {
    TestTimes times{.own_strain = [this](const SensorSample& one) { return own_strain(one); },
                    .time_at = [this](double strain) { return times_.time_at(strain); }};
    const double step = times_.step();
    Timelines all;
    for (const SensorInfo& info : infos_) {
        times.uncertain = uncertain(info, step);
        all.emplace(info.id, sensors_.at(info.id).timeline(times));
    }
    return all;
}

Recording LiveTest::recording_of(const SensorInfo& info, const SensorTimeline& timeline) const {
    Recording r;
    r.info = info;
    const bool counted = std::ranges::all_of(
        timeline.samples, [](const PlacedSample& one) { return one.count >= 0; });
    const SensorSample sent{.sent = sensors_.at(info.id).sent()};
    std::vector<const Channel*> measured;
    for (const Channel& channel : all_channels)
        if (!channel.is_count() && !channel.is(Channel::of_test) &&
            sent.has(channel.place, channel.size()))
            measured.push_back(&channel);
    for (const auto& [t, count, sample] : timeline.samples) {
        const double strain = strain_of(t - info.clock_offset, *sample);
        if (std::isnan(strain)) continue;
        r.time.push_back(t);
        r.strain.push_back(strain);
        if (counted) r.sequence.push_back(static_cast<std::uint64_t>(count));
        for (const Channel* channel : measured)
            channel->append(r, sample->numbers.data() + channel->place);
        if (const double flags = sample->numbers[in_sample::flags]; sent.has(in_sample::flags))
            r.flags.push_back(is_count(flags) ? static_cast<std::uint64_t>(flags) : 0);
    }
    reject_flagged(r);
    return r;
}

/// How far (s) a sensor's clock is ahead of the machine's, the median over its records with strain;
/// nothing if there are too few. The interval between the machine's records limits the resolution.
std::optional<double> LiveTest::clock_ahead(const SensorInfo& info,
                                            const SensorTimeline& timeline) const {
    std::vector<double> ahead;
    for (const auto& [t, count, sample] : timeline.samples) {
        const double strain =
            sample->has(in_sample::strain) ? sample->numbers[in_sample::strain] : std::nan("");
        if (!(strain > 0)) continue; // at rest a strain does not determine a time
        const auto passed = machine_.lower_bound(strain - same_strain);
        if (passed != machine_.end() && std::isfinite(passed->second.number("t")))
            ahead.push_back(t - info.clock_offset - passed->second.number("t"));
    }
    if (ahead.size() < fewest_times) return {};
    return median(std::move(ahead));
}

/// Checks the clocks of the sensors against the machine's: a wrong clock gives records without
/// strain the wrong strain. A clock that is behind cannot be distinguished from records that arrive
/// late, and clocks that are all ahead cannot be distinguished from late records of the machine:
/// these cases are reported, not refused.
void LiveTest::check_clocks(RecordedTest& test, const Timelines& timelines) const {
    std::vector<double> of_all;
    const double step = times_.step();
    for (const auto& [id, timeline] : timelines)
        if (timeline.ahead.size() >= fewest_times) of_all.push_back(median(timeline.ahead));
    for (std::size_t k = 0; k < test.recordings.size(); ++k) {
        const SensorInfo& info = test.recordings[k].info;
        const SensorTimeline& timeline = timelines.at(info.id);
        std::vector<double> phases; // of records whose strain is found by phase
        bool needed = false;        // whether a record's strain is found by t
        for (const PlacedSample& one : timeline.samples) {
            if (one.sample->has(in_sample::strain)) continue;
            if (goes_by_phase(*one.sample))
                phases.push_back(one.sample->numbers[in_sample::phase]);
            else
                needed = true;
        }
        const auto refuse = [&](const std::string& why) {
            std::erase_if(test.findings, [&](const Finding& f) {
                return f.sensor == info.id && f.check == "length";
            }); // the same fault, described less clearly
            test.findings.push_back({Finding::Kind::refusal, info.id, "clock", why});
            test.trajectories[k] = {};
        };
        if (const auto reason = reason_against_phases(phases)) refuse(*reason);
        if (gate_.passed(info.id) == 0 && sensors_.at(info.id).received > 0)
            refuse(fmt::format("expected records whose times follow each other, at {:.4g} samples "
                               "a second (sampling_rate), found none",
                               info.sampling_rate));
        if (timeline.of_unknown_time > 0) {
            const auto text = unknown_times(timeline);
            if (std::ranges::none_of(test.recordings[k].strain, [](double e) { return e > 0; }))
                refuse(text);
            else
                test.findings.push_back({Finding::Kind::note, info.id, "clock", text});
        }
        const bool none = needed && test.recordings[k].size() == 0;
        if (none && times_.strain_at().by_time.empty())
            refuse("expected strain in its records, or t in the machine's, found neither");
        if (std::isnan(step) || timeline.samples.empty()) continue;
        const auto by_strain = clock_ahead(info, timeline);
        if (!by_strain && timeline.ahead.size() < fewest_times && !none) continue;
        const double ahead = by_strain ? *by_strain
                             : timeline.ahead.empty()
                                 ? timeline.samples.front().t - info.clock_offset -
                                       times_.strain_at().by_time.begin()->first
                                 : median(timeline.ahead);
        const double limit = uncertain(info, step);
        if (std::abs(ahead) <= limit) continue;
        const auto text =
            fmt::format("t is {:.3g} s {} the machine's {}, expected {:.2g} s at most",
                        std::abs(ahead), ahead > 0 ? "ahead of" : "behind",
                        by_strain ? "at the same strain" : "on arrival", limit);
        const bool alone = !of_all.empty() && ahead > 0 && ahead - median(of_all) > limit;
        if (none || (needed && (by_strain || alone)))
            refuse(text + ": give clock_offset");
        else
            test.findings.push_back(
                {Finding::Kind::note, info.id, "clock",
                 text + (by_strain ? "; its strains are used" : ": wrong clock, or late records")});
    }
}

RecordedTest LiveTest::so_far() const { return test_of(timelines()); }

RecordedTest LiveTest::test_of(const Timelines& timelines) const {
    RecordedTest test;
    test.pressure = settings_.pressure;
    for (const SensorInfo& info : infos_)
        test.recordings.push_back(recording_of(info, timelines.at(info.id)));
    for (const auto& [strain, record] : machine_) add_record(test.curves, record);
    examine(test, settings_.quality_control);
    check_clocks(test, timelines);
    return test;
}

std::vector<double> LiveTest::ages() {
    std::vector<double> all;
    for (const Instant arrived : arrivals_) all.push_back(seconds_since(arrived));
    arrivals_.clear();
    return all;
}

std::string LiveTest::report() const {
    std::string text = fmt::format(
        "{} lines read, {} records of the test machine up to {:.3f} % of axial strain\n", taken_,
        machine_.size(), machine_.empty() ? 0 : 100 * machine_.rbegin()->first);
    for (const auto& [kind, what] : notes_)
        text += fmt::format("{} time{}: {}\n", what.first, what.first == 1 ? "" : "s", what.second);
    const Timelines all = timelines();
    return text + parser_.ignored() + report_on_sensors(all) + quality_control_report(test_of(all));
}

/// What was received of the sensors, and what the gate left out.
std::string LiveTest::report_on_sensors(const Timelines& timelines) const {
    std::vector<std::pair<unsigned, std::string>> received;
    Accounts accounts = gate_.accounts();
    for (const auto& [id, timeline] : timelines) {
        const SensorRecords& sensor = sensors_.at(id);
        std::string until;
        if (!timeline.samples.empty()) {
            const PlacedSample& last = timeline.samples.back();
            const double offset = std::ranges::find(infos_, id, &SensorInfo::id)->clock_offset;
            until = fmt::format(", the last at {:.3f} % of axial strain",
                                100 * strain_of(last.t - offset, *last.sample));
        }
        received.emplace_back(id, fmt::format("{} records, {} late, {} sent again{}{}",
                                              timeline.samples.size(), sensor.late, sensor.twice,
                                              until, gate_.changes(id)));
        accounts.add(LeftOut::time_unknown,
                     fmt::format("sensor {}: {}", id, timeline.first_unknown),
                     timeline.of_unknown_time);
    }
    std::string text = lines_by_sensor(received) + accounts.report();
    if (const Gate::Waiting waiting = gate_.waiting(); waiting.records > 0)
        text += fmt::format("{} record{} until others agree with {}: {}\n", waiting.records,
                            waiting.records == 1 ? " waits" : "s wait",
                            waiting.records == 1 ? "it" : "them", waiting.first);
    return text;
}

} // namespace bris
