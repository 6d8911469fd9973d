// Does the ballast beside a sensor rock foul or loosen? Compares recordings of train passages with
// a baseline and writes one page with the verdict.
#include "engine/errors.hpp"
#include "engine/interrupt.hpp"
#include "engine/scenario.hpp"
#include "engine/signal/fft.hpp"
#include "engine/summary.hpp"
#include "scenarios/monitoring/monitor_page.hpp"
#include "scenarios/monitoring/passage_log.hpp"
#include "scenarios/monitoring/passage_stream.hpp"
#include "scenarios/monitoring/sensor_verdict.hpp"
#include "scenarios/monitoring/state_publisher.hpp"
#include "scenarios/monitoring/synthetic_vibration.hpp"
#include "scenarios/stream/run_broker.hpp"

#include <fmt/format.h>

#include <cstdio>
#include <memory>
#include <optional>
#include <sys/resource.h>

namespace bris {

namespace {

struct Monitor {
    std::filesystem::path recordings, baseline, stream, columns, example;
    std::string example_state = "fouled";
    unsigned example_passages = 3;
    SyntheticVibration synthetic;
    MonitorSettings settings;
    PassageStreamSettings of_stream;
    RunBrokerSettings broker;
    double speed = 0;

    void describe(auto& option) {
        option.group("Recordings");
        option(
            "recordings", recordings, "",
            "Folder with the metadata rock_NN.txt of the sensors and a file recordings.csv or "
            "recordings.h5 for each passage, in the folder or its subfolders. Default: synthetic "
            "recordings.");
        option("baseline", baseline, "",
               "Folder of the same form, recorded where and when the ballast was good. Default: "
               "synthetic recordings.");
        option("stream", stream, "",
               "Source of records instead of --recordings: - (standard input), a pipe or a growing "
               "file; or monitor.h5, the history of a run over a broker. Sensors are those of the "
               "metadata of --baseline.");
        option("columns", columns, "", "Column map of CSV files of other programs.");
        option("window", of_stream.window, "s", "Recorded time of a stream in one passage.",
               within(1, 1e6));
        option("late", of_stream.late, "s",
               "Recorded time for which a window of a stream waits for late records.",
               within(0, 1e6));
        option("timeout", of_stream.timeout, "s",
               "Time without a record after which the stream counts as ended.", above(0, 1e7));
        option.group("Broker");
        broker.describe(option);
        option("speed", speed, "",
               "Speed at which a history is given again, relative to the times of arrival. 0: as "
               "fast as possible.",
               within(0, 1e6));
        option.group("Synthetic recordings");
        option("write_example", example, "",
               "Write synthetic recordings, FOLDER/baseline and FOLDER/recordings, and end.");
        option("example_state", example_state, "", "State of the ballast in the recordings.",
               {"clean", "fouled", "loosened"});
        option("example_passages", example_passages, "", "Number of passages in the recordings.",
               within(1, 1000));
        option("example_sensors", synthetic.sensors, "", "Number of sensors.", within(1, 100));
        option("example_duration", synthetic.duration, "s", "Time that a passage takes.",
               within(2, 3600));
        option.group("Comparison");
        settings.describe(option);
    }
};

/// s of processor time that this process and the programs that it started have used.
double processor_time() {
    double seconds = 0;
    for (const int who : {RUSAGE_SELF, RUSAGE_CHILDREN}) {
        rusage usage{};
        getrusage(who, &usage);
        for (const timeval& t : {usage.ru_utime, usage.ru_stime})
            seconds += static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
    }
    return seconds;
}

/// s, of the sensor that recorded longest.
double recorded_time(const Passage& passage) {
    double longest = 0;
    for (const Recording& r : passage.recordings)
        if (r.size() > 1 && std::isfinite(r.time.back() - r.time.front()))
            longest = std::max(longest, r.time.back() - r.time.front());
    return longest;
}

constexpr unsigned baseline_passages = 12;

void write_example(const std::filesystem::path& folder, const Monitor& m, std::uint64_t seed) {
    const char* const comment = "Synthetic recordings of train passages, not measured in a track.";
    std::vector<Passage> good, now;
    for (unsigned k = 1; k <= baseline_passages; ++k)
        good.push_back(synthetic_passage(m.synthetic, synthetic_state("clean"), seed, k,
                                         fmt::format("passage_{:02}", k)));
    for (unsigned k = 1; k <= m.example_passages; ++k)
        now.push_back(synthetic_passage(m.synthetic, synthetic_state(m.example_state), seed,
                                        baseline_passages + k,
                                        fmt::format("passage_{:02}", baseline_passages + k)));
    write_passages(folder / "baseline", good, comment);
    write_passages(folder / "recordings", now, comment);
}

void check(const Monitor& m) {
    const MonitorSettings& s = m.settings;
    require(s.band_high > s.band_low,
            fmt::format("--band-low, --band-high: expected a band, found {:g} to {:g} Hz",
                        s.band_low, s.band_high));
    require(is_fast_length(s.segment),
            fmt::format("--segment: expected a number without other prime factors than 2, 3 and 5, "
                        "such as {}, found {}",
                        fast_length_for(s.segment), s.segment));
    require(m.stream.empty() || m.recordings.empty(),
            "--stream, --recordings: expected one of the two, found both");
    const bool given =
        !m.recordings.empty() || !m.stream.empty() || !m.broker.client.address.empty();
    require(given == !m.baseline.empty(),
            fmt::format("--baseline: expected together with --recordings, --stream or --broker, "
                        "found {}",
                        given ? "none" : "it alone"));
    if (!m.stream.empty() && m.stream != "-" && !std::filesystem::exists(m.stream))
        throw OutputError(fmt::format("--stream: cannot read '{}'", m.stream.string()));
}

/// A spectrum ends at half of the sampling rate.
void check_band(const std::vector<SensorBaseline>& baselines, const MonitorSettings& s) {
    for (const SensorBaseline& b : baselines)
        require(b.rate == 0 || s.band_low < 0.5 * b.rate, // 0: it is no baseline
                fmt::format("--band-low: expected less than half of the sampling rate of sensor "
                            "{}, {:g} Hz, found {:g} Hz",
                            b.id, b.rate, s.band_low));
}

class MonitorRun {
public:
    MonitorRun(const Monitor& monitor, const Common& common)
        : m_(monitor), common_(common), settings_(monitor.settings) {}

    void run() {
        check(m_);
        if (!m_.example.empty()) return write_example(m_.example, m_, common_.seed);
        auto baseline = m_.baseline, recordings = m_.recordings;
        if (baseline.empty()) {
            write_example(common_.out / "example", m_, common_.seed);
            baseline = common_.out / "example" / "baseline";
            recordings = common_.out / "example" / "recordings";
            what_ = fmt::format("synthetic recordings ({})", m_.example_state);
        } else {
            what_ = !m_.recordings.empty() ? recordings.string()
                    : !m_.stream.empty()   ? "stream " + m_.stream.string()
                                           : "broker " + m_.broker.client.address;
        }
        baseline_ = baseline.string();
        baselines_ = baselines_of(read_passages(baseline, m_.columns, "--baseline"), settings_);
        check_band(baselines_, settings_);
        if (RunBroker::is_needed(m_.broker, m_.stream)) connect();
        log_.emplace(common_.out);
        if (m_.broker.client.address.empty() ? m_.stream.empty() : !m_.recordings.empty())
            for (const Passage& p : read_passages(recordings, m_.columns, "--recordings")) take(p);
        else
            follow(baseline);
        finish();
    }

private:
    /// Connects, and keeps what passes in monitor.h5, the run file.
    void connect() {
        const auto& source = m_.recordings.empty() ? m_.stream : m_.recordings;
        broker_.emplace(m_.broker, source, m_.speed, common_);
        run_file_.emplace(Hdf5File::create(common_.out / "monitor.h5"));
        broker_->keep_in(*run_file_);
        publisher_.emplace(broker_->link());
    }

    void publish(const PassageResult& passage) {
        if (!publisher_) return;
        for (const SensorResult& s : passage.sensors) {
            publisher_->publish(
                {s.id, s.verdict == Verdict::changed, text_of(s.verdict), s.reason, recorded_});
            publisher_->publish_state({{"sensor", static_cast<double>(s.id)},
                                       {"recorded_time_s", recorded_},
                                       {"outlier_share", s.outlier_share},
                                       {"rms_ratio", s.level_ratio},
                                       {"power_ratio", s.power_ratio}});
        }
    }

    std::unique_ptr<Lines> lines_of(const std::vector<SensorInfo>& infos) {
        if (!broker_ || !broker_->gives_records()) return std::make_unique<LineSource>(m_.stream);
        auto lines = broker_->lines(infos);
        from_broker_ = lines.get();
        return lines;
    }

    void take(const Passage& passage) {
        recorded_ += recorded_time(passage);
        const PassageResult result = judge_passage(passage, baselines_, settings_);
        log_->add(result);
        publish(result);
        if (common_.quiet) return;
        const OverallVerdict v = overall_verdict({result});
        fmt::print("{}: {}: {}\n", passage.name, text_of(v.verdict), v.reason);
        std::fflush(stdout);
    }

    void follow(const std::filesystem::path& metadata) {
        saves_.emplace("the results so far are written");
        settings_.rest = m_.of_stream.window; // a train may pass when a window begins
        const auto infos = sensor_infos_in(metadata, "--baseline");
        PassageStream stream(lines_of(infos), infos, m_.of_stream);
        began_ = processor_time();
        while (const auto passage = stream.next()) {
            stream_report_ = report_of(stream);
            const double recorded = recorded_time(*passage);
            if (stream.over() && log_->count() > 0 &&
                recorded < settings_.least_duration + m_.of_stream.late) {
                ended_ = fmt::format("the stream ended {:.3g} s after the last window, too soon "
                                     "for a verdict on that time\n",
                                     recorded);
                break;
            }
            take(*passage);
            write_page(common_.out, report());
        }
        stream_report_ = report_of(stream) + ended_;
        from_broker_ = nullptr; // it ends with the stream
    }

    std::string report_of(const PassageStream& stream) const {
        return stream.report() + (from_broker_ != nullptr ? from_broker_->report() : "") +
               (broker_ ? broker_->report() : "");
    }

    MonitorReport report() const {
        return {what_,        baseline_,     settings_,     baselines_,
                log_->kept(), log_->count(), stream_report_};
    }

    void finish() {
        if (broker_) broker_->finish();
        if (run_file_) run_file_->close();
        write_page(common_.out, report());
        draw_pictures(common_.out, report());
        Summary summary;
        add_results(summary, report());
        const double used = processor_time() - began_;
        summary.add("recorded_time_s", recorded_);
        summary.add("processor_time_s", used);
        summary.add("processor_share", recorded_ > 0 ? used / recorded_ : std::nan(""));
        report_results(common_, summary);
    }

    std::optional<SavesWhenInterrupted> saves_; // until the files below are closed
    const Monitor& m_;
    const Common& common_;
    MonitorSettings settings_;
    std::string what_, baseline_, stream_report_, ended_;
    std::vector<SensorBaseline> baselines_;
    std::optional<PassageLog> log_;
    std::optional<Hdf5File> run_file_;
    std::optional<RunBroker> broker_; // none: no broker. It writes into the run file
    std::optional<StatePublisher> publisher_;
    const BrokerLines* from_broker_ = nullptr; // while a stream is followed
    double recorded_ = 0, began_ = 0;          // s; of a stream without the time for the baseline
};

void run(const Monitor& monitor, const Common& common) { MonitorRun(monitor, common).run(); }

} // namespace

} // namespace bris

int main(int argc, char** argv) {
    return bris::run_scenario<bris::Monitor>(
        argc, argv,
        {.name = "monitor",
         .description = "Compares recordings of SmartRocks under trains with a baseline and says "
                        "whether the ballast beside them has changed.",
         .cannot_resume = "recordings are read in seconds, and a stream goes on by itself",
         .cannot_explain = "it runs no time steps"},
        bris::run);
}
