#include "scenarios/recordings/new_recordings.hpp"

#include "engine/errors.hpp"
#include "engine/io/column_map.hpp"
#include "engine/io/whole_file.hpp"
#include "engine/signal/median.hpp"
#include "scenarios/recordings/guess_columns.hpp"
#include "scenarios/recordings/recorded_test.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <set>
#include <system_error>

namespace bris {

namespace {

namespace fs = std::filesystem;

/// Files that one call writes. If it fails they are removed, so that the next one begins anew.
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

private:
    std::vector<fs::path> files_;
};

/// The form of the file by the map that is there, which somebody may have corrected, or else by one
/// that is guessed and written. Throws InputError if a needed column is missing.
CsvForm form_of(const fs::path& csv, const std::vector<KnownColumn>& known, const fs::path& map,
                NewFiles& files, std::string& text) {
    text += fmt::format("{}:\n", csv.filename().string());
    if (fs::exists(map)) {
        text += fmt::format("  The columns are those of {}, which is kept.\n", map.string());
        return read_column_map(map, known);
    }
    const GuessedMap guess = guess_columns(csv, known);
    for (const std::string& note : guess.notes) text += "  " + note + "\n";
    for (const KnownColumn& column : known)
        require(!column.needed || std::ranges::count(guess.found, column.name) > 0,
                fmt::format("{}: expected a column that looks like {}, found none; {}",
                            csv.string(), column.name,
                            column.name == "id"
                                ? "add a column id with a number for each sensor"
                                : "write a column map by hand (assets/smartrock/README.md)"));
    write_whole(files.add(map), fmt::format("# Guessed from {}: check names, units and signs.\n{}",
                                            csv.filename().string(), guess.map));
    return read_column_map(map, known);
}

/// Metadata of a sensor as far as its samples show them.
SensorInfo info_of(const Recording& recording) {
    SensorInfo info = recording.info;
    std::vector<double> intervals;
    for (std::size_t k = 1; k < recording.size(); ++k)
        if (const double interval = recording.time[k] - recording.time[k - 1]; interval > 0)
            intervals.push_back(interval);
    if (!intervals.empty()) info.sampling_rate = 1 / median(intervals);
    for (const Quat& q : recording.attitude)
        if (std::abs(q.norm() - 1) < 1e-3) {
            info.set_pose(info.position(), q);
            return info;
        }
    const std::size_t start = std::min<std::size_t>(recording.force.size(), 100);
    const std::vector<Vec3> first(recording.force.begin(),
                                  recording.force.begin() + static_cast<std::ptrdiff_t>(start));
    if (start == 0) return info;
    if (const Vec3 up = median(first); up.allFinite() && up.norm() > 0)
        info.set_pose(info.position(), Quat::FromTwoVectors(up, Vec3::UnitZ()));
    return info;
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

} // namespace

std::string write_new_recordings(const NewRecordings& s) {
    const fs::path of_test = s.folder / folder_of(s.pressure), csv = of_test / "recordings.csv";
    std::string text, machine;
    NewFiles files;
    files.add(csv);
    if (!s.machine.empty()) files.add(of_test / "test.csv");
    const fs::path map = s.folder / "columns.txt", machine_map = s.folder / "machine_columns.txt";
    const CsvForm form = form_of(s.sensors, recording_columns(), map, files, text);
    const auto recordings = read_recordings(s.sensors, infos_in(s.sensors, form), form);
    if (!s.machine.empty())
        (void)form_of(s.machine, machine_columns(), machine_map, files, machine);
    write_whole(csv, read_whole(s.sensors));
    if (!s.machine.empty()) write_whole(of_test / "test.csv", read_whole(s.machine));
    std::size_t there = 0; // somebody may have completed them
    for (const Recording& r : recordings) {
        const fs::path file = s.folder / fmt::format("rock_{:02}.txt", r.info.id);
        if (fs::exists(file))
            ++there;
        else
            write_sensor_info(files.add(file), info_of(r));
    }
    files.keep();
    if (there > 0)
        text += fmt::format("{} files rock_NN.txt were there already, and are kept.\n", there);
    text +=
        fmt::format("{} sensors; sampling rates are from the times, attitudes at the start "
                    "{}.\n{}",
                    recordings.size(),
                    from_samples(recordings) ? "from qw qx qy qz in the first sample"
                                             : "from the direction of gravity in the first samples",
                    machine);
    text += fmt::format(
        "Still to be given in {}: rock_NN.txt: positions x y z, yaw, and the noise "
        "of your sensors; columns.txt: what is wrong in it{}.\n",
        s.folder.string(),
        s.machine.empty()
            ? fmt::format("; {}/test.csv, the records of the test machine", folder_of(s.pressure))
            : "");
    return text;
}

} // namespace bris
