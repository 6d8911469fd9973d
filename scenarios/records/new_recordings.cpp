#include "scenarios/records/new_recordings.hpp"

#include "engine/errors.hpp"
#include "engine/io/column_map.hpp"
#include "engine/io/whole_file.hpp"
#include "engine/signal/median.hpp"
#include "scenarios/records/first_force.hpp"
#include "scenarios/records/guess_columns.hpp"
#include "scenarios/records/recorded_test.hpp"
#include "scenarios/sensors/channels.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <set>
#include <system_error>

namespace bris {

namespace {

namespace fs = std::filesystem;

/// Files that one call writes. If it fails they are removed, so that the next one begins again.
class NewFiles {
public:
    NewFiles() = default;
    NewFiles(const NewFiles&) = delete;
    ~NewFiles() {
        std::error_code error;
        for (const fs::path& file : files_) {
            fs::remove(file, error);
            fs::remove(file.parent_path(), error); // if it is empty
        }
    }
    /// Throws InputError if the file is there already.
    const fs::path& add(const fs::path& file) {
        require(
            !fs::exists(file),
            fmt::format("--new: expected a folder without recordings, found '{}'", file.string()));
        return files_.emplace_back(file);
    }
    void keep() { files_.clear(); }
    void leave(const fs::path& file) { std::erase(files_, file); }

private:
    std::vector<fs::path> files_;
};

/// The form of a file, and what is known about the file besides.
struct FoundForm {
    CsvForm form;
    double rate = 0;         ///< Hz, that the file states; 0: none
    bool is_guessed = false; ///< now; otherwise by a map that was there
};

/// Throws InputError unless the guess has the columns that are needed.
void require_columns(const fs::path& csv, const std::vector<KnownColumn>& known,
                     const GuessedMap& guess) {
    std::vector<std::string> missing;
    for (const KnownColumn& column : known)
        if (column.needed && std::ranges::count(guess.found, column.name) == 0)
            missing.push_back(column.name);
    require(missing.empty(),
            fmt::format("{}: expected a column that looks like {}, found none among {}; add what "
                        "is missing, or write a column map by hand",
                        csv.string(), listed(missing), listed(guess.titles)));
}

/// The form of the file by the map that is there, which somebody may have corrected, or else by one
/// that is guessed and written. Throws InputError if a needed column is missing, or a unit has to
/// be given: then the map is kept to be edited.
FoundForm form_of(const fs::path& csv, const std::vector<KnownColumn>& known, const fs::path& map,
                  const FileEvidence& evidence, NewFiles& files, std::string& text) {
    text += fmt::format("{}:\n", csv.filename().string());
    if (fs::exists(map)) {
        text += fmt::format("  The columns are those of {}, which is kept.\n", map.string());
        return {read_column_map(map, known)};
    }
    const GuessedMap guess = guess_columns(csv, known, evidence);
    for (const std::string& note : guess.notes) text += "  " + note + "\n";
    require_columns(csv, known, guess);
    if (guess.open.empty()) files.add(map); // otherwise it is kept to be edited
    write_guessed_map(csv, guess, map);
    return {read_column_map(map, known), guess.rate, true};
}

/// Hz, by the times. Throws InputError if they do not advance as those of a sensor do.
double rate_of(const fs::path& csv, const Recording& recording) {
    constexpr double most = 1e6; // Hz
    std::vector<double> intervals;
    for (std::size_t k = 1; k < recording.size(); ++k)
        if (const double interval = recording.time[k] - recording.time[k - 1];
            std::isfinite(interval))
            intervals.push_back(interval);
    const double interval = intervals.empty() ? 0 : median(std::move(intervals));
    require(interval > 1 / most,
            fmt::format("{}: sensor {}: expected times that advance by more than {:g} s, found {}",
                        csv.string(), recording.info.id, 1 / most,
                        recording.size() < 2 ? "fewer than two"
                                             : fmt::format("intervals of {:g} s", interval)));
    return 1 / interval;
}

/// Metadata of a sensor as far as its samples show them.
SensorInfo info_of(const fs::path& csv, Recording recording) {
    SensorInfo& info = recording.info;
    info.sampling_rate = rate_of(csv, recording);
    for (const Quat& q : recording.attitude)
        if (std::abs(q.norm() - 1) < 1e-3) {
            info.set_pose(info.position(), q);
            return info;
        }
    set_attitude_by_gravity(recording);
    return info;
}

/// What contradicts the units, a sentence a line: gravity, the rate that the file states, and the
/// clock of the machine.
std::string doubts(const std::vector<Recording>& recordings, double stated_rate,
                   const FileEvidence& evidence) {
    std::string text;
    for (const Recording& r : recordings) {
        if (r.size() < 2) continue;
        const double force = first_force(r).norm(), span = r.time.back() - r.time.front(),
                     rate = static_cast<double>(r.size() - 1) / span;
        const auto doubt = [&](const std::string& what) {
            text += fmt::format("  Check the units: sensor {}: {}.\n", r.info.id, what);
        };
        if (!r.force.empty() && std::abs(force / standard_gravity - 1) > 0.3)
            doubt(
                fmt::format("the acceleration at the beginning is {:.3g} m/s2, that of gravity is "
                            "9.81, which an accelerometer at rest shows",
                            force));
        if (stated_rate > 0 && (rate < 0.5 * stated_rate || rate > 2 * stated_rate))
            doubt(fmt::format("{:.4g} samples a second by the times, {:g} by the file", rate,
                              stated_rate));
        if (evidence.duration > 0 &&
            (span < 0.2 * evidence.duration || span > 5 * evidence.duration))
            doubt(fmt::format("{:.4g} s by its times, {:.4g} s by the machine", span,
                              evidence.duration));
    }
    return text;
}

/// Reads the machine's file, for what it shows about the sensors.
void add_evidence(const fs::path& csv, const CsvForm& form, FileEvidence& evidence) {
    const CsvTable table = read_csv(csv, form);
    const auto finite = [&](const char* name) {
        std::vector<double> numbers = table.column(name);
        std::erase_if(numbers, [](double x) { return !std::isfinite(x); });
        return numbers;
    };
    if (const auto strain = finite("axial_strain"); !strain.empty())
        evidence.final_strain = std::ranges::max(strain);
    if (!table.has("t")) return;
    if (const auto t = finite("t"); !t.empty())
        evidence.duration = std::ranges::max(t) - std::ranges::min(t);
}

/// Whether all recordings have attitudes.
bool from_samples(const std::vector<Recording>& recordings) {
    return std::ranges::none_of(recordings, [](const Recording& r) { return r.attitude.empty(); });
}

/// One metadata entry for each id in the file.
std::vector<SensorInfo> infos_in(const fs::path& csv, const CsvForm& form) {
    std::set<unsigned> ids;
    CsvForm only_id = form;
    std::erase_if(only_id.columns, [](const CsvColumn& c) { return c.ours != "id"; });
    const CsvTable table = read_csv(csv, only_id);
    const auto numbers = table.column("id");
    for (std::size_t k = 0; k < numbers.size(); ++k) {
        require(is_count(numbers[k]) && numbers[k] < 1e6,
                fmt::format("{}:{}: id: expected a whole number below 1e6, found {}", csv.string(),
                            table.lines[k], numbers[k]));
        ids.insert(static_cast<unsigned>(numbers[k]));
    }
    std::vector<SensorInfo> infos;
    for (const unsigned id : ids) {
        SensorInfo info;
        info.id = id;
        infos.push_back(info);
    }
    return infos;
}

/// Writes the metadata of a sensor. Returns 1 if they are there already and are kept.
std::size_t write_info(const fs::path& folder, const SensorInfo& info, NewFiles& files) {
    const fs::path file = folder / fmt::format("rock_{:02}.txt", info.id);
    if (fs::exists(file)) return 1; // somebody may have completed it
    write_sensor_info(files.add(file), info);
    return 0;
}

std::string kept(std::size_t files) {
    return files == 0
               ? ""
               : fmt::format("{} files rock_NN.txt were there already, and are kept.\n", files);
}

/// The sensors of a file that is copied: writes columns.txt and rock_NN.txt, and returns what to
/// say.
std::string copied(const NewRecordings& s, const FileEvidence& evidence, NewFiles& files) {
    const fs::path &csv = s.sensors.front(), map = s.folder / "columns.txt";
    std::string text;
    const FoundForm found = form_of(csv, recording_columns(), map, evidence, files, text);
    std::vector<Recording> recordings;
    std::size_t there = 0;
    try {
        recordings = read_recordings(csv, infos_in(csv, found.form), found.form);
        for (const Recording& r : recordings) there += write_info(s.folder, info_of(csv, r), files);
    } catch (const InputError& e) {
        if (!found.is_guessed) throw;
        files.leave(map);
        throw InputError(fmt::format("{}; the columns are guessed, and {} is kept to be corrected",
                                     e.what(), map.string()));
    }
    text += doubts(recordings, found.rate, evidence) + kept(there);
    write_whole(s.folder / folder_of(s.pressure) / "recordings.csv", read_whole(csv));
    text += fmt::format(
        "{} sensors; sampling rates are from the times, attitudes at the start {}.\n",
        recordings.size(),
        from_samples(recordings) ? "from qw qx qy qz in the first sample"
                                 : "from the direction of gravity in the first samples");
    return text;
}

/// The sensors of files of a logger: writes their samples and rock_NN.txt, and returns what to say.
std::string converted(const NewRecordings& s, NewFiles& files) {
    require(!fs::exists(s.folder / "columns.txt"),
            fmt::format("--new: expected a folder without columns.txt, which would be taken for "
                        "that of the converted files, found '{}'",
                        (s.folder / "columns.txt").string()));
    std::vector<Recording> all;
    std::string text;
    std::size_t with_dates = 0; // such files keep their times relative to each other
    for (const fs::path& file : s.sensors) {
        LoggerFile read = read_logger_file(file, s.logger);
        with_dates += static_cast<std::size_t>(read.is_absolute);
        text += fmt::format("{}:\n", file.filename().string());
        for (const std::string& note : read.notes) text += "  " + note + "\n";
        if (!read.is_absolute) begin_at_zero(read.recordings);
        for (Recording& r : read.recordings) {
            require(std::ranges::find(all, r.info.id,
                                      [](const Recording& other) { return other.info.id; }) ==
                        all.end(),
                    fmt::format("{}: expected other sensors than in the files before, found {} "
                                "again; name each file after its sensor, such as sensor_2.csv",
                                file.string(), r.info.id));
            all.push_back(std::move(r));
        }
    }
    require(with_dates == 0 || with_dates == s.sensors.size(),
            "--new: expected dates in all files or in none, found both");
    begin_at_zero(all);
    std::size_t there = 0;
    for (const Recording& r : all) there += write_info(s.folder, r.info, files);
    write_recordings(s.folder / folder_of(s.pressure) / "recordings.csv", all, {});
    return text + kept(there) + fmt::format("{} sensors; times begin at 0.\n", all.size());
}

} // namespace

bool is_described_by_map(const NewRecordings& s) {
    if (s.sensors.size() != 1 || s.logger.rate > 0 || !s.logger.axes.empty() ||
        !s.logger.columns.empty() || fs::is_directory(s.sensors.front()))
        return false;
    if (fs::exists(s.folder / "columns.txt")) return true; // somebody may have completed it
    try {
        const GuessedMap guess = guess_columns(s.sensors.front(), recording_columns());
        const auto has = [&](const std::string& name) {
            return std::ranges::count(guess.found, name) > 0;
        };
        return has("t") && has("id") && std::ranges::any_of(all_channels, [&](const Channel& c) {
                   return c.size() > 1 && has(std::string(c.column(0)));
               });
    } catch (const InputError&) {
        return false;
    }
}

std::string write_new_recordings(const NewRecordings& s) {
    const fs::path of_test = s.folder / folder_of(s.pressure),
                   machine_map = s.folder / "machine_columns.txt";
    std::string text, machine;
    NewFiles files;
    files.add(of_test / "recordings.csv");
    if (!s.machine.empty()) files.add(of_test / "test.csv");
    FileEvidence evidence{.pressure = s.pressure};
    if (!s.machine.empty())
        add_evidence(
            s.machine,
            form_of(s.machine, machine_columns(), machine_map, evidence, files, machine).form,
            evidence);
    text += is_described_by_map(s) ? copied(s, evidence, files) : converted(s, files);
    if (!s.machine.empty()) write_whole(of_test / "test.csv", read_whole(s.machine));
    files.keep();
    text += machine;
    text += fmt::format(
        "Still to be given in {}: rock_NN.txt: positions x y z, yaw, and the noise "
        "of your sensors{}{}.\n",
        s.folder.string(),
        fs::exists(s.folder / "columns.txt") ? "; columns.txt: what is wrong in it" : "",
        s.machine.empty()
            ? fmt::format("; {}/test.csv, the records of the test machine", folder_of(s.pressure))
            : "");
    return text;
}

} // namespace bris
