#include "scenarios/monitoring/site_folder.hpp"

#include "engine/errors.hpp"
#include "engine/io/whole_file.hpp"
#include "scenarios/monitoring/vibration.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <vector>

namespace bris {

namespace {

namespace fs = std::filesystem;

/// Folders of passages with this name, whatever their number; and the last number.
std::vector<fs::path> with_name(const fs::path& folder, const std::string& name, unsigned& last) {
    std::vector<fs::path> found;
    for (const auto& entry : fs::directory_iterator(folder)) {
        const std::string own = entry.path().filename().string();
        if (!entry.is_directory() || own.size() < 7 || own[5] != '_') continue;
        last = std::max(last, static_cast<unsigned>(std::atoi(own.substr(0, 5).c_str())));
        if (own.substr(6) == name) found.push_back(entry.path());
    }
    return found;
}

void add_cause(const fs::path& folder, const std::string& name, const PassageCause& cause) {
    // numbers differ from day to day, so that the file is written anew with all columns
    auto causes = read_causes(folder / "passages.csv");
    causes[name] = cause;
    std::vector<std::string> names;
    for (const auto& [passage, one] : causes)
        for (const auto& [number, value] : one.numbers)
            if (std::ranges::count(names, number) == 0) names.push_back(number);
    std::string text = "passage,condition,session";
    for (const std::string& number : names) text += "," + number;
    text += "\n";
    for (const auto& [passage, one] : causes) {
        text += fmt::format("{},{},{}", passage, one.condition, one.session);
        for (const std::string& number : names) {
            const auto found = one.numbers.find(number);
            text += "," + (found == one.numbers.end() ? "" : fmt::format("{}", found->second));
        }
        text += "\n";
    }
    write_whole(folder / "passages.csv", text);
}

} // namespace

bool keep_passage(const fs::path& folder, const Passage& passage) {
    fs::create_directories(folder);
    unsigned last = 0;
    const auto same = with_name(folder, passage.name, last);
    std::vector<Recording> recordings = passage.recordings;
    std::erase_if(recordings, [](const Recording& r) { return r.size() == 0; });
    for (Recording& r : recordings) {
        const fs::path metadata = folder / fmt::format("rock_{:02}.txt", r.info.id);
        if (!fs::exists(metadata)) write_sensor_info(metadata, r.info);
        const SensorInfo there = read_sensor_info(metadata);
        require(is_same_rate(there.sampling_rate, r.info.sampling_rate),
                fmt::format("passage '{}': sensor {}: expected {:g} Hz as in '{}', found {:g}",
                            passage.name, r.info.id, there.sampling_rate, folder.string(),
                            r.info.sampling_rate));
        r.info = there;
    }
    const std::string name = fmt::format("{:05}_{}", last + 1, passage.name);
    write_recordings(folder / name / "recordings.csv", recordings, {"Kept by monitor --site."});
    const std::string text = read_whole(folder / name / "recordings.csv");
    for (const fs::path& other : same)
        if (read_whole(other / "recordings.csv") == text) {
            fs::remove_all(folder / name);
            return false;
        }
    const PassageCause& cause = passage.cause;
    if (!cause.condition.empty() || !cause.session.empty() || !cause.numbers.empty())
        add_cause(folder, name, cause);
    return true;
}

} // namespace bris
