#include "scenarios/monitoring/passage.hpp"

#include "engine/errors.hpp"
#include "engine/io/column_map.hpp"
#include "scenarios/sensors/naming.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace bris {

namespace {

namespace fs = std::filesystem;

/// The folder itself and its subfolders in order of their names, those with recordings.
std::vector<fs::path> folders_with_recordings(const fs::path& folder, const std::string& option) {
    const auto file_in = [&](const fs::path& of, const char* name) {
        return fs::is_regular_file(of / name);
    };
    std::vector<fs::path> candidates, found;
    for (const auto& entry : fs::directory_iterator(folder))
        if (entry.is_directory()) candidates.push_back(entry.path());
    std::ranges::sort(candidates);
    candidates.insert(candidates.begin(), folder);
    for (const fs::path& of : candidates) {
        const bool csv = file_in(of, "recordings.csv"), hdf5 = file_in(of, "recordings.h5");
        require(!csv || !hdf5,
                fmt::format("{}: {}: expected recordings.csv or recordings.h5, found both", option,
                            of.string()));
        if (csv || hdf5) found.push_back(of);
    }
    require(!found.empty(), fmt::format("{}: expected recordings.csv or recordings.h5 in '{}' or "
                                        "its subfolders, found none",
                                        option, folder.string()));
    return found;
}

std::string name_of(const fs::path& of, const fs::path& folder) {
    return of == folder ? "recordings" : of.filename().string();
}

} // namespace

std::vector<SensorInfo> sensor_infos_in(const fs::path& folder, const std::string& option) {
    if (!fs::is_directory(folder))
        throw OutputError(fmt::format("{}: cannot read folder '{}'", option, folder.string()));
    std::vector<SensorInfo> infos;
    std::vector<fs::path> files;
    for (const auto& entry : fs::directory_iterator(folder))
        if (entry.path().extension() == ".txt" &&
            entry.path().filename().string().starts_with("rock_"))
            files.push_back(entry.path());
    std::ranges::sort(files);
    for (const fs::path& file : files) {
        infos.push_back(naming(option, [&] { return read_sensor_info(file); }));
        const auto same = std::ranges::find(infos, infos.back().id, &SensorInfo::id);
        require(same + 1 == infos.end(),
                fmt::format("{}: {}: id: expected another one than in the files before, found {}",
                            option, file.string(), infos.back().id));
    }
    std::ranges::sort(infos, {}, &SensorInfo::id);
    return infos;
}

void for_each_passage(const fs::path& folder, const fs::path& columns, const std::string& option,
                      const std::function<void(Passage&&)>& take) {
    const std::vector<SensorInfo> infos = sensor_infos_in(folder, option);
    const fs::path map = map_to_use(columns, folder / "columns.txt");
    const CsvForm form = map.empty() ? CsvForm{} : naming("--columns", [&] {
        return read_column_map(map, recording_columns());
    });
    const auto causes = naming(option, [&] { return read_causes(folder / "passages.csv"); });
    for (const fs::path& of : folders_with_recordings(folder, option)) {
        Passage passage = naming(option, [&]() -> Passage {
            const fs::path hdf5 = of / "recordings.h5";
            if (fs::is_regular_file(hdf5))
                return {name_of(of, folder),
                        read_recordings_hdf5(hdf5,
                                             infos.empty() ? read_sensor_infos_hdf5(hdf5) : infos)};
            require(!infos.empty(),
                    fmt::format("expected files rock_NN.txt in '{}', found none", folder.string()));
            return {name_of(of, folder), read_recordings(of / "recordings.csv", infos, form)};
        });
        if (const auto found = causes.find(passage.name); found != causes.end())
            passage.cause = found->second;
        take(std::move(passage));
    }
}

std::vector<Passage> read_passages(const fs::path& folder, const fs::path& columns,
                                   const std::string& option) {
    std::vector<Passage> passages;
    for_each_passage(folder, columns, option,
                     [&](Passage&& passage) { passages.push_back(std::move(passage)); });
    return passages;
}

void write_passages(const fs::path& folder, const std::vector<Passage>& passages,
                    const std::string& comment) {
    for (const Recording& r : passages.front().recordings)
        write_sensor_info(folder / fmt::format("rock_{:02}.txt", r.info.id), r.info);
    for (const Passage& passage : passages)
        write_recordings(folder / passage.name / "recordings.csv", passage.recordings, {comment});
}

} // namespace bris
