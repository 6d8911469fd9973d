// Judges a folder of recordings in seconds, without simulating anything: which sensors and channels
// of the test machine are accepted and why others are not, plots of every channel, and what of the
// motion of the rocks the sensors observe. --new writes such a folder from CSV files of another
// make.
#include "engine/assets.hpp"
#include "engine/errors.hpp"
#include "engine/io/whole_file.hpp"
#include "engine/report.hpp"
#include "scenarios/records/draw_recordings.hpp"
#include "scenarios/records/new_recordings.hpp"
#include "scenarios/records/quality_control_report.hpp"
#include "scenarios/triaxial/triaxial_scene.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <exception>

namespace bris {

namespace {

struct Judged {
    std::filesystem::path recordings = assets_folder() / "smartrock", sensors = {}, machine = {};
    std::vector<double> pressures{};
    QualityControlSettings quality_control;
    Triaxial model{.test = {.preparation = "report"}}; // as of smart_triaxial
    double displacement_deviation = 1e-3, rotation_deviation = 0.1;

    void declare_options(Options& option) {
        option("recordings", recordings, "",
               "Folder of the recordings: rock_NN.txt for each sensor, and for each pressure a "
               "folder such as 55kPa with recordings.csv (or recordings.h5) and test.csv. May be "
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
               "CSV file of another make with samples of sensors, from which --out becomes a new "
               "folder of recordings. Its columns are guessed.");
        option("new_machine", machine, "",
               "CSV file of another make with the records of the test machine, for --new.");
    }
};

/// The pressures that the folders of tests are named after, such as 55kPa.
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
    require(!pressures.empty(),
            fmt::format("--recordings: expected a folder such as 55kPa in '{}', found none",
                        folder.string()));
    std::ranges::sort(pressures);
    return pressures;
}

/// Time that the test takes by its recordings, s; without any, by those of the machine.
double duration_of(const RecordedTest& test, double rest) {
    double longest = 0;
    for (const Recording& r : test.recordings)
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
    report += fmt::format("{}{}\n{}\n{}", report.empty() ? "" : "\n\n", name,
                          quality_control_report(test),
                          observability_report(test, duration_of(test, s.quality_control.rest),
                                               s.displacement_deviation, s.rotation_deviation));
    Report own;
    own.add("sensors_accepted", test.recordings.size() - test.refused());
    own.add("sensors_refused", test.refused());
    own.add("machine_channels_refused", refused_channels(test));
    own.show({"sensors_accepted", "sensors_refused", "machine_channels_refused"});
    summary.add_part(name, own);
    summary.show_sentence(fmt::format("{}: {}", name, verdict_on(test)));
}

void judge(const Judged& s, const Common& common) {
    const auto pressures = s.pressures.empty() ? pressures_in(s.recordings) : s.pressures;
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

void run(const Judged& s, const Common& common) {
    if (s.sensors.empty()) {
        require(s.machine.empty(), "--new-machine: expected --new with it, found none");
        return judge(s, common);
    }
    require(s.pressures.size() <= 1,
            "--confining-pressure: expected one pressure with --new, found several");
    const std::string text =
        write_new_recordings({.sensors = s.sensors,
                              .machine = s.machine,
                              .pressure = s.pressures.empty() ? 55e3 : s.pressures.front(),
                              .folder = common.out});
    fmt::print("{}", text);
}

} // namespace

} // namespace bris

int main(int argc, char** argv) {
    // the folder may be the first word
    std::string option = "--recordings";
    std::vector<char*> words(argv, argv + argc);
    if (argc > 1 && argv[1][0] != '-') words.insert(words.begin() + 1, option.data());
    return bris::run_scenario<bris::Judged>(
        static_cast<int>(words.size()), words.data(),
        {"recordings",
         "Judges recordings of SmartRocks and of a test machine, and what can be learned from "
         "them; or makes a folder of recordings from CSV files of another make.",
         "recordings are always judged from the beginning", "no simulation is run"},
        bris::run);
}
