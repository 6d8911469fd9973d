// Judges a folder of recordings in seconds, without simulating anything: which sensors and channels
// of the test machine are accepted and why others are not, plots of every channel, and what of the
// motion of the rocks the sensors observe. --new writes such a folder from the files of a
// logger. A folder of a track, with the recordings of passing trains, is judged without a test
// machine.
#include "engine/assets.hpp"
#include "engine/errors.hpp"
#include "engine/io/whole_file.hpp"
#include "engine/report.hpp"
#include "scenarios/monitoring/logger_passages.hpp"
#include "scenarios/monitoring/passage.hpp"
#include "scenarios/monitoring/recorded_passages.hpp"
#include "scenarios/records/draw_recordings.hpp"
#include "scenarios/records/new_recordings.hpp"
#include "scenarios/records/quality_control_report.hpp"
#include "scenarios/triaxial/triaxial_scene.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <exception>
#include <map>
#include <set>

namespace bris {

namespace {

struct Judged {
    std::filesystem::path recordings = assets_folder() / "smartrock", machine = {};
    std::string sensors; // files, separated by commas
    LoggerSettings logger;
    std::vector<double> pressures{};
    QualityControlSettings quality_control;
    Triaxial model{.test = {.preparation = "report"}}; // as of smart_triaxial
    double displacement_deviation = 1e-3, rotation_deviation = 0.1;

    void declare_options(Options& option) {
        option("recordings", recordings, "",
               "Folder of the recordings: rock_NN.txt for each sensor, and for each pressure a "
               "folder such as 55kPa with recordings.csv (or recordings.h5) and test.csv; or for "
               "each passage of a train a folder of any other name with recordings.csv. May be "
               "given as the first word, without the name of the option.");
        option("confining_pressure", pressures, "Pa",
               "Confining pressures of the tests; with --new that of the test. Without it "
               "those of the folders are judged, and --new takes 55000.",
               above(0, 1e9).usually(1e3, 1e7));
        option("columns", quality_control.columns, "",
               "File that maps the columns of recordings.csv if another program wrote it. Default: "
               "columns.txt in the folder, if it is there.");
        option("machine_columns", quality_control.machine_columns, "",
               "File that maps the columns of test.csv. Default: machine_columns.txt in the "
               "folder, if it is there.");
        option("rest", quality_control.rest, "s",
               "Time at the beginning of the recordings during which the rocks are at rest.",
               above(0, 1e6));
        option("interval", quality_control.interval, "",
               "Axial strain between the samples that are used.", above(0, 1));
        option("displacement_deviation", displacement_deviation, "m",
               "Standard deviation of a model's displacement of a rock at the end of the test, "
               "with which the sensors are compared.",
               above(0, 10));
        option("rotation_deviation", rotation_deviation, "rad",
               "Standard deviation of a model's rotation of a rock, likewise.", above(0, 10));
        option.group("Specimen of the model, in which the sensor rocks are placed");
        model.declare_mould_options(option);
        option.group("A new folder of recordings");
        option("new", sensors, "",
               "Files of a logger, several words or separated by commas, or folders of them, from "
               "which --out becomes a new folder of recordings. Delimiter, columns, units and "
               "sampling rate are found in them. Without --new-machine and --confining-pressure "
               "each file is a passage.");
        option("rate", logger.rate, "Hz",
               "Sampling rate of each sensor, if the files have no times; 0: by the files.",
               within(0, 1e6).usually(1, 1e5));
        option("axes", logger.axes, "",
               "Columns of the files by number, from 1, or by title, with units where they are "
               "not stated: \"t=1 ms, id=2, ax=3 g, ay=4, az=-5, gx=6 deg/s\". Empty: found.");
        option("new_machine", machine, "",
               "CSV file of another make with the records of the test machine, for --new.");
    }
};

/// The pressures that the folders of tests are named after, such as 55kPa; empty: it has none.
std::vector<double> pressures_in(const std::filesystem::path& folder) {
    std::vector<double> pressures;
    if (!std::filesystem::is_directory(folder))
        throw OutputError(fmt::format("--recordings: cannot read folder '{}'", folder.string()));
    for (const auto& entry : std::filesystem::directory_iterator(folder)) {
        const std::string name = entry.path().filename().string();
        double kilopascal = 0;
        const char* const end = name.data() + name.size();
        const auto [stop, error] = std::from_chars(name.data(), end, kilopascal);
        if (error == std::errc{} && std::string(stop, end) == "kPa" && kilopascal > 0 &&
            entry.is_directory())
            pressures.push_back(1e3 * kilopascal);
    }
    std::ranges::sort(pressures);
    return pressures;
}

/// Time that the test takes by its recordings, s; without any, by those of the machine.
double duration_of(const std::vector<Recording>& recordings, double rest) {
    double longest = 0;
    for (const Recording& r : recordings)
        if (r.size() > 1) longest = std::max(longest, r.time.back() - r.time.front() - rest);
    return longest > 0 ? longest : 1;
}

/// Judges one test: draws it, and adds to the report and to the summary. `problems` of the position
/// of each sensor.
void judge_test(const Judged& s, double pressure, const std::vector<SensorInfo>& infos,
                const std::vector<std::string>& problems, const Common& common, std::string& report,
                Report& summary) {
    RecordedTest test = read_recorded_test(s.recordings, pressure, infos, s.quality_control);
    for (std::size_t k = 0; k < infos.size(); ++k)
        if (!problems[k].empty())
            test.findings.push_back({Finding::Kind::refusal, infos[k].id, "position", problems[k]});
    const std::string name = folder_of(pressure);
    const std::filesystem::path of_test = common.out / name;
    std::filesystem::create_directories(of_test);
    draw_recordings(of_test, test);
    report += fmt::format(
        "{}{}\n{}\n{}", report.empty() ? "" : "\n\n", name, quality_control_report(test),
        observability_report(test, duration_of(test.recordings, s.quality_control.rest),
                             s.displacement_deviation, s.rotation_deviation));
    Report own;
    own.add("sensors_accepted", test.recordings.size() - test.refused());
    own.add("sensors_refused", test.refused());
    own.add("machine_channels_refused", refused_channels(test));
    own.show({"sensors_accepted", "sensors_refused", "machine_channels_refused"});
    summary.add_part(name, own);
    summary.show_sentence(fmt::format("{}: {}", name, verdict_on(test)));
}

/// In how many passages a sensor recorded, and in how many of these it is accepted.
struct SensorTally {
    std::size_t recorded = 0, accepted = 0;
    std::string first; ///< refusal
};

/// Judges one passage, and returns its part of the report.
std::string judge_passage(const Passage& passage, std::map<unsigned, SensorTally>& tallies) {
    std::vector<Recording> with_samples;
    std::string without;
    for (const Recording& r : passage.recordings) {
        if (r.size() > 0)
            with_samples.push_back(r);
        else
            without += fmt::format("sensor {}: no samples\n", r.info.id);
        (void)tallies[r.info.id];
    }
    const auto findings = check_recordings(with_samples, Vec3(0, 0, -standard_gravity));
    for (const Recording& r : with_samples) {
        SensorTally& tally = tallies[r.info.id];
        ++tally.recorded;
        const auto refusal = std::ranges::find_if(findings, [&](const Finding& f) {
            return f.sensor == r.info.id && f.kind == Finding::Kind::refusal;
        });
        if (refusal == findings.end())
            ++tally.accepted;
        else if (tally.first.empty())
            tally.first = fmt::format("; refused in {}: {}", passage.name, refusal->check);
    }
    return passage.name + "\n" + quality_control_report(findings, with_samples) + without;
}

/// Judges the passages of a track's folder: how many of them each sensor recorded well.
void judge_track(const Judged& s, const Common& common) {
    std::map<unsigned, SensorTally> tallies;
    std::size_t passages = 0;
    std::string report;
    for_each_passage(s.recordings, s.quality_control.columns, "--recordings",
                     [&](Passage&& passage) {
                         if (++passages > 1) report += "\n";
                         report += judge_passage(passage, tallies);
                     });
    Report summary;
    summary.add("passages", passages);
    for (const auto& [id, tally] : tallies) {
        summary.add(fmt::format("sensor_{}_accepted", id), tally.accepted);
        summary.show_sentence(fmt::format("Sensor {}: accepted in {} of {} passages{}.", id,
                                          tally.accepted, tally.recorded, tally.first));
    }
    const auto file = common.out / "quality_control.txt";
    write_whole(file, report);
    summary.show_sentence("The reasons are in " + file.string() + ".");
    report_results(common, summary);
}

void judge(const Judged& s, const Common& common) {
    const auto pressures = s.pressures.empty() ? pressures_in(s.recordings) : s.pressures;
    if (pressures.empty()) return judge_track(s, common);
    const auto infos = read_sensor_infos(s.recordings);
    const auto problems = // as smart_triaxial finds them
        problems_of_recorded_poses(with_recorded_poses(s.model, s.recordings), common.seed);
    Report summary;
    std::string report;
    std::exception_ptr unreadable; // of the first test that cannot be read; the others are judged
    for (const double pressure : pressures) {
        try {
            judge_test(s, pressure, infos, problems, common, report, summary);
        } catch (const Interrupted&) {
            throw;
        } catch (const Error& e) {
            if (pressures.size() > 1)
                summary.show_sentence(fmt::format("{}: {}", folder_of(pressure), e.what()));
            if (!unreadable) unreadable = std::current_exception();
        }
    }
    if (report.empty()) std::rethrow_exception(unreadable);
    const auto file = common.out / "quality_control.txt";
    write_whole(file, report);
    summary.show_sentence("The reasons, and what each sensor observes, are in " + file.string() +
                          ".");
    report_results(common, summary);
    if (unreadable) std::rethrow_exception(unreadable);
}

/// Converts files of a logger to passages, each in a folder of its own. Returns what was assumed
/// and written.
std::string write_track(const Judged& s, const std::vector<std::filesystem::path>& files,
                        const Common& common) {
    std::vector<std::string> notes;
    std::set<unsigned> ids;
    std::string written;
    const auto take = [&](Passage&& passage) {
        const auto csv = common.out / passage.name / "recordings.csv";
        require(
            !std::filesystem::exists(csv),
            fmt::format("--new: expected a folder without recordings, found '{}'", csv.string()));
        for (const Recording& r : passage.recordings) {
            const auto file = common.out / fmt::format("rock_{:02}.txt", r.info.id);
            if (ids.insert(r.info.id).second && !std::filesystem::exists(file))
                write_sensor_info(file, r.info);
        }
        write_recordings(csv, passage.recordings, {"of " + passage.name + ", times from 0"});
        const std::size_t sensors = passage.recordings.size();
        written += fmt::format("{}: {} sensor{}, {:.4g} s.\n", csv.string(), sensors,
                               sensors == 1 ? "" : "s", duration_of(passage.recordings, 0));
    };
    for_each_logged_passage(files, s.logger, {.every_recording_holds_a_train = true}, "--new", take,
                            notes);
    std::string text;
    for (const std::string& note : notes) text += note + "\n";
    return text + written +
           fmt::format(
               "Still to be given in {}: rock_NN.txt: mounting and ranges of your sensors.\n",
               common.out.string());
}

void run(Judged s, const Common& common) {
    if (s.sensors.empty()) {
        require(s.machine.empty(), "--new-machine: expected --new with it, found none");
        require(!(s.logger.rate > 0) && s.logger.axes.empty(),
                "--rate, --axes: expected --new with them, found none");
        return judge(s, common);
    }
    require(s.pressures.size() <= 1,
            "--confining-pressure: expected one pressure with --new, found several");
    s.logger.columns = s.quality_control.columns;
    const auto files = logger_files(RecordingsNamed{s.sensors, "--new"}.list(), "--new");
    const NewRecordings of_test{.sensors = files,
                                .machine = s.machine,
                                .pressure = s.pressures.empty() ? 55e3 : s.pressures.front(),
                                .folder = common.out,
                                .logger = s.logger};
    const bool is_track = s.machine.empty() && s.pressures.empty() && !is_described_by_map(of_test);
    fmt::print("{}", is_track ? write_track(s, files, common) : write_new_recordings(of_test));
}

} // namespace

} // namespace bris

int main(int argc, char** argv) {
    std::vector<std::string> words(argv, argv + argc);
    // the folder may be the first word
    if (argc > 1 && argv[1][0] != '-') words.insert(words.begin() + 1, "--recordings");
    words = bris::with_listed_files(words, {"--new"});
    std::vector<char*> pointers;
    for (std::string& word : words) pointers.push_back(word.data());
    return bris::run_scenario<bris::Judged>(
        static_cast<int>(pointers.size()), pointers.data(),
        {"recordings",
         "Judges recordings of SmartRocks and of a test machine, and what can be learned from "
         "them; or makes a folder of recordings from the files of a logger.",
         "recordings are always judged from the beginning", "no simulation is run"},
        bris::run);
}
