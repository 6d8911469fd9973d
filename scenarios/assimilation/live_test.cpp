#include "scenarios/assimilation/live_test.hpp"

#include "engine/errors.hpp"
#include "engine/interrupt.hpp"
#include "engine/printable.hpp"
#include "engine/signal/median.hpp"
#include "scenarios/recordings/device_channels.hpp"
#include "scenarios/recordings/quality_control_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <thread>
#include <utility>

namespace bris {

namespace {

// of the machine's strain while time goes on
constexpr double largest_step_back = 5e-4;
constexpr std::ptrdiff_t most_wrong_times = 2;
constexpr double same_strain = 1e-9;    // tolerance of comparisons of axial strain
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

/// Names of the numbers of a sample: those below, then the device channels.
const std::vector<std::string>& sample_names() {
    static const std::vector<std::string> all = [] {
        std::vector<std::string> names{"strain", "seq", "ax", "ay", "az",    "gx",   "gy",
                                       "gz",     "ux",  "uy", "uz", "qw",    "qx",   "qy",
                                       "qz",     "mx",  "my", "mz", "flags", "phase"};
        for (const DeviceChannel& channel : device_channels()) names.emplace_back(channel.column);
        return names;
    }();
    return all;
}
namespace in_sample {
constexpr std::size_t strain = 0, sequence = 1, force = 2, rate = 5, displacement = 8,
                      attitude = 11, field = 15, flags = 18, phase = 19, device = 20;
}
constexpr std::uint64_t bits_of(std::size_t first, std::size_t count) {
    return ((std::uint64_t{1} << count) - 1) << first;
}
bool same_number(double a, double b) { return a == b || (std::isnan(a) && std::isnan(b)); }
} // namespace

LiveTest::LiveTest(std::unique_ptr<Lines> lines, std::vector<SensorInfo> infos,
                   const LiveSettings& settings)
    : lines_(std::move(lines)), infos_(std::move(infos)), settings_(settings) {
    require(!infos_.empty(), "stream: expected at least one SmartRock, found none");
    for (const SensorInfo& info : infos_) sensors_[info.id].clock_offset = info.clock_offset;
}

void LiveTest::note(const std::string& kind, const std::string& text) {
    // a stream of noise could have any number of kinds
    const bool is_new = !notes_.contains(kind);
    auto& [count, first] = notes_[is_new && notes_.size() >= most_kinds ? "others" : kind];
    if (count++ == 0) first = printable(text);
}

void LiveTest::end(const std::string& why) {
    over_ = true;
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
    take(*record);
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

void LiveTest::take(const StreamRecord& record) {
    if (record.has("id"))
        take_of_sensor(record);
    else if (record.has("axial_strain") && record.has("deviatoric_stress_Pa"))
        take_of_machine(record);
    else
        note("unknown",
             fmt::format(
                 "line {}: expected an id, or axial_strain and deviatoric_stress_Pa, found neither",
                 record.line));
}

void LiveTest::take_of_sensor(const StreamRecord& record) {
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
    SensorRecords& sensor = found->second;
    const Sample sample = sample_of(record);
    const auto [entry, is_new] = sensor.by_time.emplace(t, sample);
    if (is_new) {
        sensor.sent |= sample.sent;
        if (!clock_.by_time.empty())
            sensor.ahead.push_back(t - sensor.clock_offset - clock_.by_time.rbegin()->first);
        sensor.late +=
            static_cast<std::uint64_t>(record.number("strain") < followed_ - same_strain);
        return;
    }
    ++sensor.twice;
    if (entry->second.sent != sample.sent ||
        !std::ranges::equal(entry->second.numbers, sample.numbers, same_number))
        note(
            "contradicts",
            fmt::format(
                "line {}: sensor {}: t = {} was sent before with other numbers; the first are used",
                record.line, id, t));
}

/// Reports entries that are not valid numbers. They are stored as they are and left to quality
/// control, but strain, phase, seq and flags are treated as if they had not been sent.
void LiveTest::look_for_numbers(const StreamRecord& record) {
    for (const std::string& name : sample_names()) {
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
    if (std::isfinite(record.number("t"))) enter_time(record, strain);
    const double phase = record.number("phase");
    if (!std::isfinite(phase)) return;
    const auto last = clock_.by_phase.rbegin();
    if (last == clock_.by_phase.rend() || phase >= last->first || strain < last->second)
        clock_.by_phase.emplace(phase, strain);
    else
        note("phase", fmt::format("line {}: the machine's phase: expected increasing numbers, "
                                  "found {:.4g} after {:.4g}",
                                  record.line, phase, last->first));
}

/// Enters the time at which the machine had a strain. Strain and time increase together: a record
/// that contradicts many others has a wrong time, one or two that contradict it have had one.
void LiveTest::enter_time(const StreamRecord& record, double strain) {
    const double t = record.number("t");
    auto& times = clock_.by_time;
    const auto later = times.upper_bound(t);
    auto first = later, last = later;
    while (first != times.begin() && std::prev(first)->second > strain + largest_step_back) --first;
    while (last != times.end() && last->second < strain - largest_step_back) ++last;
    if (std::distance(first, last) > most_wrong_times)
        return note("machine's t", fmt::format("line {}: the machine: t: expected a time after "
                                               "those of smaller strains, found {}",
                                               record.line, t));
    times.erase(first, last);
    times.emplace(t, strain);
}

LiveTest::Sample LiveTest::sample_of(const StreamRecord& record) {
    Sample sample{{}, 0};
    for (std::size_t k = 0; k < sample_names().size(); ++k) {
        const double number = record.number(sample_names()[k]);
        sample.numbers.push_back(number);
        // without a valid number the strain comes from the machine
        const bool needs_number = k == in_sample::strain || k == in_sample::phase;
        if (record.has(sample_names()[k]) && (!needs_number || std::isfinite(number)))
            sample.sent |= bits_of(k, 1);
    }
    return sample;
}

double LiveTest::strain_of(double t, const Sample& sample) const {
    if ((sample.sent & bits_of(in_sample::strain, 1)) != 0)
        return sample.numbers[in_sample::strain];
    if ((sample.sent & bits_of(in_sample::phase, 1)) != 0 && !clock_.by_phase.empty())
        return strain_between(clock_.by_phase, sample.numbers[in_sample::phase]);
    return strain_between(clock_.by_time, t);
}

Recording LiveTest::recording_of(const SensorInfo& info) const {
    Recording r;
    r.info = info;
    const SensorRecords& sensor = sensors_.at(info.id);
    const bool counted = std::ranges::all_of(sensor.by_time, [&](const auto& one) {
        return is_count(one.second.numbers[in_sample::sequence]);
    });
    const auto any = [&](std::size_t first, std::size_t count) {
        return (sensor.sent & bits_of(first, count)) != 0;
    };
    const bool force = any(in_sample::force, 3), rate = any(in_sample::rate, 3),
               displacement = any(in_sample::displacement, 3),
               attitude = any(in_sample::attitude, 4);
    const bool field = any(in_sample::field, 3), flags = any(in_sample::flags, 1);
    for (const auto& [t, one] : sensor.by_time) {
        const double strain = strain_of(t - sensor.clock_offset, one);
        if (std::isnan(strain)) continue;
        const double* n = one.numbers.data();
        r.time.push_back(t);
        r.strain.push_back(strain);
        if (counted) r.sequence.push_back(static_cast<std::uint64_t>(n[in_sample::sequence]));
        if (force) r.force.push_back(info.force_of(Vec3(n + in_sample::force)));
        if (rate) r.rate.push_back(info.rate_of(Vec3(n + in_sample::rate)));
        if (displacement) r.displacement.emplace_back(n + in_sample::displacement);
        if (attitude)
            r.attitude.emplace_back(n[in_sample::attitude], n[in_sample::attitude + 1],
                                    n[in_sample::attitude + 2], n[in_sample::attitude + 3]);
        if (field) r.field.push_back(info.field_of(Vec3(n + in_sample::field)));
        for (std::size_t k = 0; k < device_channels().size(); ++k) {
            const DeviceChannel& channel = device_channels()[k];
            if (any(in_sample::device + k, 1))
                (r.*channel.values)
                    .push_back(channel.value_of_file(info, n[in_sample::device + k]));
        }
        if (flags)
            r.flags.push_back(is_count(n[in_sample::flags])
                                  ? static_cast<std::uint64_t>(n[in_sample::flags])
                                  : 0);
    }
    reject_flagged(r);
    return r;
}

/// How far (s) a sensor's clock is ahead of the machine's, the median over its records with strain;
/// nothing if there are too few. The interval between the machine's records limits the resolution.
std::optional<double> LiveTest::clock_ahead(const SensorRecords& sensor) const {
    std::vector<double> ahead;
    for (const auto& [t, one] : sensor.by_time) {
        const double strain = (one.sent & bits_of(in_sample::strain, 1)) != 0
                                  ? one.numbers[in_sample::strain]
                                  : std::nan("");
        if (!(strain > 0)) continue; // at rest a strain does not determine a time
        const auto passed = machine_.lower_bound(strain - same_strain);
        if (passed != machine_.end() && std::isfinite(passed->second.number("t")))
            ahead.push_back(t - sensor.clock_offset - passed->second.number("t"));
    }
    if (ahead.size() < fewest_times) return {};
    return median(std::move(ahead));
}

/// Checks the clocks of the sensors against the machine's: a wrong clock gives records without
/// strain the wrong strain. A clock that is behind cannot be distinguished from records that arrive
/// late, and clocks that are all ahead cannot be distinguished from late records of the machine:
/// these cases are reported, not refused.
void LiveTest::check_clocks(RecordedTest& test) const {
    std::vector<double> steps, of_all;
    for (auto at = clock_.by_time.begin();
         at != clock_.by_time.end() && std::next(at) != clock_.by_time.end(); ++at)
        steps.push_back(std::next(at)->first - at->first);
    for (const auto& [id, sensor] : sensors_)
        if (sensor.ahead.size() >= fewest_times) of_all.push_back(median(sensor.ahead));
    for (std::size_t k = 0; k < test.recordings.size(); ++k) {
        const SensorInfo& info = test.recordings[k].info;
        const SensorRecords& sensor = sensors_.at(info.id);
        std::vector<double> phases; // of records whose strain is found by phase
        bool needed = false;        // whether a record's strain is found by t
        for (const auto& [t, one] : sensor.by_time) {
            if ((one.sent & bits_of(in_sample::strain, 1)) != 0) continue;
            if ((one.sent & bits_of(in_sample::phase, 1)) != 0 && !clock_.by_phase.empty())
                phases.push_back(one.numbers[in_sample::phase]);
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
        const bool none = needed && test.recordings[k].size() == 0;
        if (none && clock_.by_time.empty())
            refuse("expected strain in its records, or t in the machine's, found neither");
        if (steps.empty()) continue;
        const auto by_strain = clock_ahead(sensor);
        if (!by_strain && sensor.ahead.size() < fewest_times && !none) continue;
        const double ahead = by_strain ? *by_strain
                             : sensor.ahead.empty()
                                 ? sensor.by_time.begin()->first - sensor.clock_offset -
                                       clock_.by_time.begin()->first
                                 : median(sensor.ahead);
        const double uncertain = 3 * info.clock_offset_deviation + median(steps);
        if (std::abs(ahead) <= uncertain) continue;
        const auto text =
            fmt::format("t is {:.3g} s {} the machine's {}, expected {:.2g} s at most",
                        std::abs(ahead), ahead > 0 ? "ahead of" : "behind",
                        by_strain ? "at the same strain" : "on arrival", uncertain);
        const bool alone = !of_all.empty() && ahead > 0 && ahead - median(of_all) > uncertain;
        if (none || (needed && (by_strain || alone)))
            refuse(text + ": give clock_offset");
        else
            test.findings.push_back(
                {Finding::Kind::note, info.id, "clock",
                 text + (by_strain ? "; its strains are used" : ": wrong clock, or late records")});
    }
}

TriaxialPoint LiveTest::point_of(const StreamRecord& record) const {
    TriaxialPoint p;
    p.axial_strain = record.number("axial_strain");
    p.deviatoric_stress = record.number("deviatoric_stress_Pa");
    p.volumetric_strain = record.number("volumetric_strain");
    for (std::size_t r = 1; record.has(fmt::format("ring_{}_radius_m", r)); ++r)
        p.ring_radius.push_back(record.number(fmt::format("ring_{}_radius_m", r)));
    return p;
}

RecordedTest LiveTest::so_far() const {
    RecordedTest test;
    test.pressure = settings_.pressure;
    for (const SensorInfo& info : infos_) test.recordings.push_back(recording_of(info));
    for (const auto& [strain, record] : machine_) test.measured.push_back(point_of(record));
    examine(test, settings_.quality_control);
    check_clocks(test);
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
    std::vector<std::pair<unsigned, std::string>> received;
    for (const auto& [id, sensor] : sensors_) {
        const double last = sensor.by_time.empty()
                                ? std::nan("")
                                : strain_of(sensor.by_time.rbegin()->first - sensor.clock_offset,
                                            sensor.by_time.rbegin()->second);
        const std::string until =
            sensor.by_time.empty()
                ? ""
                : fmt::format(", the last at {:.3f} % of axial strain", 100 * last);
        received.emplace_back(id,
                              fmt::format("{} records, {} late, {} sent again{}",
                                          sensor.by_time.size(), sensor.late, sensor.twice, until));
    }
    return text + parser_.ignored() + lines_by_sensor(received) + quality_control_report(so_far());
}

} // namespace bris
