// Does the ballast beside a sensor rock foul or loosen? Compares recordings of train passages with
// a baseline and writes one page with the verdict.
#include "engine/errors.hpp"
#include "engine/interrupt.hpp"
#include "engine/io/csv.hpp"
#include "engine/not_judged.hpp"
#include "engine/report.hpp"
#include "engine/signal/fft.hpp"
#include "engine/signal/median.hpp"
#include "scenarios/monitoring/monitor_page.hpp"
#include "scenarios/monitoring/passage_log.hpp"
#include "scenarios/monitoring/passage_stream.hpp"
#include "scenarios/monitoring/power.hpp"
#include "scenarios/monitoring/publisher.hpp"
#include "scenarios/monitoring/recorded_passages.hpp"
#include "scenarios/monitoring/site_folder.hpp"
#include "scenarios/monitoring/site_verdict.hpp"
#include "scenarios/monitoring/synthetic_vibration.hpp"
#include "scenarios/monitoring/tie_table.hpp"
#include "scenarios/stream/run_broker.hpp"

#include <fmt/format.h>

#include <cstdio>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <sys/resource.h>
#include <utility>
#include <vector>

namespace bris {

namespace {

struct Monitor {
    RecordingsNamed recordings{.paths = {}, .option = "--recordings"},
        baseline{.paths = {}, .option = "--baseline"};
    std::filesystem::path stream, columns, example, site;
    LoggerSettings logger;
    std::string example_state = "fouled";
    unsigned example_passages = 3;
    SyntheticVibration synthetic;
    MonitorSettings settings;
    TieSettings ties;
    PassageStreamSettings of_stream;
    RunBrokerSettings broker;
    double speed = 0;
    std::string required = "nothing";
    bool plan = false;

    void declare_options(auto& option) {
        option.group("Recordings");
        option("recordings", recordings.paths, "",
               "Files of a logger, or folders of them: one file or many, of one sensor or many. Or "
               "a folder with the metadata rock_NN.txt of the sensors and a file recordings.csv or "
               "recordings.h5 for each passage, in the folder or its subfolders. Default: "
               "synthetic recordings.");
        option("baseline", baseline.paths, "",
               "The same, recorded where and when the ballast was good. Beside both may stand "
               "passages.csv: passage, condition, session, and numbers such as speed_m_s, that "
               "explain differences. Default: synthetic recordings.");
        option("rate", logger.rate, "Hz", "Sampling rate of files that do not say it. 0: they do.",
               within(0, 1e6));
        option("axes", logger.axes, "",
               "Columns of files that cannot be recognised: t=1 ms, ax=3 g, ay=4, az=-5, by number "
               "or title, with the unit. Default: by their titles.");
        option("site", site, "",
               "Folder that keeps baseline and passages of a site from day to day. With --baseline "
               "the first time; from then on --recordings are added to those that it has, and all "
               "are judged.");
        option("stream", stream, "",
               "Source of records instead of --recordings: - (standard input), a pipe or a growing "
               "file; or stream.ndjson, the log of an earlier run. Sensors are those of the "
               "metadata of --baseline.");
        option("columns", columns, "",
               "Column map of CSV files of other programs. Default: columns.txt in the folder, if "
               "it is there.");
        option("quiet_time", of_stream.quiet, "s",
               "Time without vibration that ends a passage in a stream.", within(0.5, 1e4));
        option("window", of_stream.window, "s",
               "Longest passage in a stream; a longer one is cut there.", within(1, 1e4));
        option("late", of_stream.late, "s",
               "Time after a passage for which late records revise its verdict.", within(0, 1e6));
        option("memory_of_stream", of_stream.memory, "MB",
               "Largest size of the records of a stream that wait for their verdict to be final. "
               "Beyond it the oldest verdicts become final.",
               within(1, 1e5));
        option("timeout", of_stream.timeout, "s",
               "Time without a record after which the stream counts as ended.", above(0, 1e7));
        option.group("Broker");
        broker.declare_options(option);
        option("speed", speed, "",
               "Speed at which a log of a broker is given again, relative to the times of arrival. "
               "0: as fast as possible.",
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
        settings.declare_options(option);
        ties.declare_options(option);
        option.group("Result");
        option("plan", plan, "",
               "Only say which lasting changes the sensors of --baseline would find: by how many "
               "sensors, in how many passages.");
        option("require", required, "",
               "all: end with exit code 5 if something that was recorded was not judged.",
               {"nothing", "all"});
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

void check(const Monitor& m, const Common& common) {
    const MonitorSettings& s = m.settings;
    require(
        common.resume.empty() || std::filesystem::exists(common.resume / log_name),
        fmt::format("--resume: expected a folder of results with {}, the log of a stream; files "
                    "are read from their beginning; found '{}'",
                    log_name, common.resume.string()));
    require(is_fast_length(s.segment),
            fmt::format("--segment: expected a number without other prime factors than 2, 3 and 5, "
                        "such as {}, found {}",
                        fast_length_for(s.segment), s.segment));
    const bool has_site_baseline = !m.site.empty() && std::filesystem::exists(m.site / "baseline"),
               was_judged = !m.site.empty() && std::filesystem::exists(m.site / "recordings");
    require(m.site.empty() || has_site_baseline || !m.baseline.paths.empty(),
            fmt::format("--site: expected a folder with a baseline, or --baseline with it, found "
                        "'{}' without one",
                        m.site.string()));
    require(!was_judged || m.baseline.paths.empty(),
            fmt::format(
                "--baseline: expected none, since '{}' has judged passages by its own, found {}",
                m.site.string(), m.baseline.paths));
    require(m.ties.sensors.empty() || !m.plan,
            "--tie-sensors: expected none with --plan, which judges nothing, found some");
    require(m.stream.empty() || m.recordings.paths.empty(),
            "--stream, --recordings: expected one of the two, found both");
    const bool given =
        !m.recordings.paths.empty() || !m.stream.empty() || !m.broker.client.address.empty();
    const bool has_baseline = has_site_baseline || !m.baseline.paths.empty();
    if (!given && has_baseline && (m.plan || !m.site.empty())) return;
    require(given == has_baseline,
            fmt::format("--baseline: expected together with --recordings, --stream or --broker, "
                        "found {}",
                        given ? "none" : "it alone"));
    if (!m.stream.empty() && m.stream != "-" && !std::filesystem::exists(m.stream))
        throw OutputError(fmt::format("--stream: cannot read '{}'", m.stream.string()));
}

/// Lines that tell once when those of earlier sessions have been given again.
class LinesOfSession : public Lines {
public:
    LinesOfSession(std::unique_ptr<Lines> lines, std::function<void()> tell)
        : lines_(std::move(lines)), tell_(std::move(tell)) {}
    std::optional<Line> next(double timeout) override {
        auto line = lines_->next(timeout);
        if (tell_ && !lines_->is_repeating()) std::exchange(tell_, {})();
        return line;
    }
    bool over() const override { return lines_->over(); }
    double now() const override { return lines_->now(); }
    bool is_repeating() const override { return lines_->is_repeating(); }

private:
    std::unique_ptr<Lines> lines_;
    std::function<void()> tell_;
};

/// Only what was judged as the baseline is an all-clear.
AlarmState alarm_state(Verdict verdict) {
    return is_change(verdict)                ? AlarmState::active
           : verdict == Verdict::as_baseline ? AlarmState::clear
                                             : AlarmState::unknown;
}

/// Which lasting changes would be found, before sensors are installed or trusted.
void plan(const std::vector<SensorBaseline>& baselines, const MonitorSettings& settings,
          const Common& common) {
    const LevelScatter scatter = level_scatter(baselines);
    Report summary;
    std::vector<double> deviations;
    for (const ExpectedFeature& level : scatter.levels) deviations.push_back(level.deviation());
    summary.add("level_deviation", median(std::move(deviations)));
    summary.add("correlation_of_sensors", scatter.common); // 0.5: not known of one sensor
    summary.add("correlation_of_passages", scatter.serial);
    std::vector<std::vector<double>> rows;
    for (const double ratio : {0.8, 1.25, 1.5, 2.0})
        for (const std::size_t sensors : {1U, 4U, 8U}) {
            std::string cells;
            for (const std::size_t passages : {1U, 4U, 12U}) {
                const double power =
                    power_of(scatter, {ratio, sensors, passages, settings.false_alarms});
                rows.push_back(
                    {ratio, static_cast<double>(sensors), static_cast<double>(passages), power});
                cells += fmt::format("{}{:.0f} %", cells.empty() ? "" : ", ", 100 * power);
            }
            summary.show_row(
                fmt::format("{:g} times, {} sensor{}", ratio, sensors, sensors == 1 ? "" : "s"),
                cells);
        }
    write_csv(common.out / "power.csv", {"ratio", "sensors", "passages", "power"}, rows,
              {"probability that a lasting change of the level beside all sensors is found"}, 4);
    summary.show({"level_deviation", "correlation_of_sensors"});
    summary.show_sentence(fmt::format(
        "Probability to find a change in 1, 4 and 12 passages, at {:g} % false alarms of a run.",
        100 * settings.false_alarms));
    report_results(common, summary);
}

class MonitorRun {
public:
    MonitorRun(const Monitor& monitor, const Common& common)
        : m_(monitor), common_(common), settings_(monitor.settings), ties_(monitor.ties) {}

    void run() {
        check(m_, common_);
        go_on_with_arrivals(common_);
        if (!m_.example.empty()) return write_example(m_.example, m_, common_.seed);
        RecordingsNamed baseline = m_.baseline, recordings = m_.recordings;
        if (!m_.site.empty()) keep_in_site(baseline, recordings);
        if (baseline.paths.empty()) {
            write_example(common_.out / "example", m_, common_.seed);
            baseline.paths = (common_.out / "example" / "baseline").string();
            recordings.paths = (common_.out / "example" / "recordings").string();
            what_ = fmt::format("synthetic recordings ({})", m_.example_state);
        } else {
            what_ = !recordings.paths.empty() ? recordings.paths
                    : !m_.stream.empty()      ? "stream " + m_.stream.string()
                                              : "broker " + m_.broker.client.address;
        }
        baseline_ = baseline.paths;
        baselines_ = read_baselines(
            [&](const std::function<void(Passage &&)>& take) {
                for_each(baseline, [&](Passage&& passage) {
                    for (const Recording& r : passage.recordings) infos_.emplace(r.info.id, r.info);
                    ties_.add(passage, true);
                    take(std::move(passage));
                });
            },
            settings_);
        ties_.require_in_baseline();
        const bool has_recordings =
            !recordings.paths.empty() || !m_.stream.empty() || !m_.broker.client.address.empty();
        if (m_.plan || !has_recordings) return plan(baselines_, settings_, common_);
        if (RunBroker::is_needed(m_.broker, m_.stream)) connect();
        log_.emplace(common_.out);
        if (m_.broker.client.address.empty() ? m_.stream.empty() : !recordings.paths.empty())
            for_each(recordings, [&](Passage&& p) { take(p); });
        else
            follow(baseline);
        finish();
    }

private:
    /// Gives the passages of files, and notes how they were read.
    void for_each(RecordingsNamed named, const std::function<void(Passage&&)>& take) {
        named.logger = m_.logger;
        named.logger.columns = m_.columns;
        named.cutting.every_recording_holds_a_train = settings_.every_one;
        std::vector<std::string> notes;
        for_each_passage(named, take, notes);
        for (const std::string& note : notes) notes_ += note + "\n";
    }

    /// Adds what is given to the folder of the site, and names what it then has.
    void keep_in_site(RecordingsNamed& baseline, RecordingsNamed& recordings) {
        for (const auto& [named, name] :
             {std::pair{&baseline, "baseline"}, {&recordings, "recordings"}}) {
            const auto folder = m_.site / name;
            std::size_t added = 0, known = 0;
            if (!named->paths.empty())
                for_each(*named, [&](Passage&& passage) {
                    (keep_passage(folder, passage) ? added : known) += 1;
                });
            if (added + known > 0)
                report_news(common_, fmt::format("{}: {} passages added, {} were there", name,
                                                 added, known));
            named->paths = std::filesystem::exists(folder) ? folder.string() : "";
        }
    }

    void connect() {
        const std::filesystem::path source =
            m_.recordings.paths.empty() ? m_.stream : std::filesystem::path(m_.recordings.paths);
        broker_.emplace(m_.broker, source, m_.speed, common_);
        stream_log_ = begin_log(m_.broker, LoggedRecords::messages, source, common_);
        if (stream_log_) broker_->keep_in(stream_log_);
        publisher_.emplace(broker_->link(), broker_->name());
        for (const SensorBaseline& b : baselines_)
            publisher_->publish_alarm(b.id, PublishedAlarm{});
        broker_->report_doing("following " + what_ + ", nothing judged yet");
    }

    void publish(const PassageResult& passage) {
        if (!publisher_) return;
        for (const SensorResult& s : passage.sensors) {
            news_[s.id] = News{
                PublishedAlarm{alarm_state(s.verdict), text_of(s.verdict), s.reason, recorded_},
                {{"recorded_time_s", recorded_},
                 {"rms_ratio", s.level_ratio()},
                 {"rms_ratio_seen_below", s.seen_below()},
                 {"rms_ratio_seen_above", s.seen_above()},
                 {"outlier_share", s.outlier_shares.front()}}};
        }
        if (!is_repeating_) publish_news();
    }
    void publish_news() {
        is_repeating_ = false;
        if (!publisher_) return;
        for (const auto& [id, news] : std::exchange(news_, {})) {
            publisher_->publish_alarm(id, news.alarm);
            publisher_->publish_sensor(id, news.numbers);
        }
    }

    std::unique_ptr<Lines> lines_of(const std::vector<SensorInfo>& infos) {
        if (!broker_ || !broker_->gives_records()) {
            if (std::filesystem::is_regular_file(m_.stream)) return open_lines(m_.stream);
            if (!stream_log_)
                stream_log_ = begin_log(m_.broker, LoggedRecords::lines, m_.stream, common_);
            auto lines = open_lines(m_.stream);
            if (!stream_log_) return lines;
            return std::make_unique<LoggedLines>(std::move(lines), stream_log_);
        }
        auto lines = broker_->lines(infos);
        from_broker_ = lines.get();
        return lines;
    }

    void take(const Passage& passage) {
        recorded_ += recorded_time(passage);
        ties_.add(passage, false);
        add(judge_passage(passage, baselines_, settings_));
    }

    void take(const StreamPassage& given) {
        if (given.is_final) ties_.add(given.passage, false);
        PassageResult result = judge_passage(given.passage, baselines_, settings_);
        result.id = given.id;
        result.revision = given.revision;
        result.is_final = given.is_final;
        if (!given.time_is_known)
            for (SensorResult& s : result.sensors) {
                if (s.id != given.passage.recordings.front().info.id) continue;
                s.reason = fmt::format("nothing says when it was recorded (by itself: {})",
                                       text_of(s.verdict));
                s.verdict = Verdict::time_unknown;
            }
        if (!given.time_is_known) // the others were recorded at another time
            std::erase_if(result.sensors,
                          [](const SensorResult& s) { return s.verdict != Verdict::time_unknown; });
        add(std::move(result), given.replaces);
    }

    void add(PassageResult result, const std::vector<std::uint64_t>& replaces = {}) {
        publish(result);
        const std::vector<PassageResult> alone{result};
        const MostSerious worst = most_serious_result(alone);
        report_news(common_,
                    fmt::format("{}{}: {}{}", result.name, result.is_final ? "" : " (provisional)",
                                text_of(verdict_on(result)),
                                worst.sensor == nullptr
                                    ? ""
                                    : fmt::format(": sensor {}: {}", worst.sensor->id,
                                                  worst.sensor->reason)));
        log_->add(std::move(result), replaces);
        if (broker_)
            broker_->report_doing(
                fmt::format("following {}, {} passages judged", what_, log_->count()));
    }

    void follow(const RecordingsNamed& baseline) {
        saves_.emplace("the results so far are written");
        PassageStreamSettings of_stream = m_.of_stream;
        of_stream.quantity = settings_.quantity;
        for (const SensorBaseline& b : baselines_)
            if (b.impossible_because.empty()) of_stream.thresholds[b.id] = b.train_threshold;
        settings_.rest = of_stream.window + 10; // passages are compared as a whole
        auto infos = baseline.is_own_folder()
                         ? sensor_infos_in(baseline.list().front(), "--baseline")
                         : std::vector<SensorInfo>{};
        if (infos.empty())
            for (const auto& [id, info] : infos_) infos.push_back(info);
        auto lines = lines_of(infos);
        is_repeating_ = lines->is_repeating();
        PassageStream stream(
            std::make_unique<LinesOfSession>(std::move(lines), [this] { publish_news(); }), infos,
            of_stream);
        began_ = processor_time();
        while (const auto passage = stream.next()) {
            recorded_ = stream.recorded_time();
            take(*passage);
            note(stream);
            write_page(common_, report());
        }
        recorded_ = stream.recorded_time();
        note(stream);
        from_broker_ = nullptr; // it ends with the stream
    }

    void note(const PassageStream& stream) {
        stream_report_ = report_of(stream);
        records_ = stream.counts();
    }

    std::string report_of(const PassageStream& stream) const {
        return stream.report() + (from_broker_ != nullptr ? from_broker_->report() : "") +
               report_on_log(stream_log_.get(), m_.broker);
    }

    MonitorReport report() const {
        return {what_,         baseline_,
                settings_,     baselines_,
                log_->kept(),  judge_together(log_->kept(), baselines_, settings_.false_alarms),
                log_->tally(), stream_report_,
                records_,      notes_};
    }

    void finish() {
        if (broker_) broker_->finish();
        const MonitorReport all = report();
        write_page(common_, all);
        draw_pictures(common_.out, all);
        Report summary;
        add_results(summary, all);
        ties_.write(common_.out, summary);
        const double used = processor_time() - began_;
        summary.add("recorded_time_s", recorded_);
        summary.add("processor_time_s", used);
        summary.add("processor_share", recorded_ > 0 ? used / recorded_ : std::nan(""));
        summary.show({"recorded_time_s"});
        summary.show_sentence(
            fmt::format("The page for people is {}.", (common_.out / "monitor.html").string()));
        report_results(common_, summary);
        if (m_.required != "all") return;
        for (const std::string& left : {not_judged(all), ties_.not_judged()})
            if (!left.empty()) throw NotJudged("--require all: " + left);
    }

    std::optional<SavesWhenInterrupted> saves_; // until the files below are closed
    const Monitor& m_;
    const Common& common_;
    MonitorSettings settings_;
    TieTable ties_;
    std::string what_, baseline_, stream_report_, notes_;
    std::map<unsigned, SensorInfo> infos_; // of the sensors in the baseline
    std::optional<StreamCounts> records_;  // of a stream
    std::vector<SensorBaseline> baselines_;
    std::optional<PassageLog> log_;
    std::shared_ptr<StreamLog> stream_log_; // null: none is kept
    std::optional<RunBroker> broker_;       // none: no broker
    std::optional<Publisher> publisher_;
    const BrokerLines* from_broker_ = nullptr; // while a stream is followed
    struct News {
        PublishedAlarm alarm;
        std::vector<ValueOf<NumbersOf::sensor>> numbers;
    };
    std::map<unsigned, News> news_;   // of each sensor, not published so far
    bool is_repeating_ = false;       // an earlier session: its news are old
    double recorded_ = 0, began_ = 0; // s; of a stream without the time for the baseline
};

void run(const Monitor& monitor, const Common& common) { MonitorRun(monitor, common).run(); }

} // namespace

} // namespace bris

int main(int argc, char** argv) {
    auto words = bris::with_listed_files({argv, argv + argc}, {"--baseline", "--recordings"});
    std::vector<char*> pointers;
    for (std::string& word : words) pointers.push_back(word.data());
    return bris::run_scenario<bris::Monitor>(
        static_cast<int>(pointers.size()), pointers.data(),
        {.name = "monitor",
         .description = "Compares recordings of SmartRocks, or of any logger, under trains with a "
                        "baseline and says whether the track beside them has changed.",
         .cannot_explain = "it runs no time steps"},
        bris::run);
}
