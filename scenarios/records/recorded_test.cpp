#include "scenarios/records/recorded_test.hpp"

#include "engine/errors.hpp"
#include "engine/io/column_map.hpp"
#include "engine/io/unfinished_file.hpp"
#include "scenarios/records/compare_strain.hpp"
#include "scenarios/records/machine_hdf5.hpp"
#include "scenarios/records/machine_quality_control.hpp"
#include "scenarios/sensors/naming.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

namespace bris {

namespace {

constexpr std::size_t most_rings = 64;

/// Title of the column of a ring, counted from 0.
std::string column_of_ring(std::size_t ring) { return title_of(quantity::ring_radius, ring); }

/// Fills a clock from a column of the machine, if there is one.
void read_clock(const CsvTable& table, const char* name, const std::vector<double>& strain,
                std::map<double, double>& strain_at) {
    if (!table.has(name)) return;
    const auto values = table.column(name);
    double last = -std::numeric_limits<double>::infinity();
    for (std::size_t k = 0; k < values.size(); ++k) {
        if (std::isnan(values[k])) continue;
        require(std::isfinite(values[k]) && values[k] >= last,
                fmt::format("{}:{}: {}: expected increasing numbers, found {:.10g} after {:.10g}",
                            table.path.string(), table.lines[k], name, values[k], last));
        last = values[k];
        strain_at.emplace(values[k], strain[k]);
    }
}

MachineRecord read_test(const std::filesystem::path& csv, const CsvForm& form) {
    const CsvTable table = read_csv(csv, form);
    const auto strain = table.column("axial_strain"), q = table.column("deviatoric_stress_Pa");
    MachineRecord test;
    for (std::size_t k = 0; k < strain.size(); ++k) test.curves.add_row();
    test.curves[quantity::axial_strain] = strain;
    test.curves[quantity::deviatoric_stress] = q;
    if (table.has("volumetric_strain"))
        test.curves[quantity::volumetric_strain] = table.column("volumetric_strain");
    for (std::size_t r = 0; r < most_rings; ++r) {
        if (!table.has(column_of_ring(r))) continue;
        const std::size_t known = test.curves.rings();
        require(known == r, fmt::format("{}: expected a column {} before {}, found none",
                                        csv.string(), column_of_ring(known), column_of_ring(r)));
        test.curves.column(quantity::ring_radius, r).values = table.column(column_of_ring(r));
    }
    test.unused = table.others(titles_of(machine_columns(), form));
    for (std::size_t k = 0; k < strain.size(); ++k) {
        const std::string at = fmt::format("{}:{}", csv.string(), table.lines[k]);
        require(
            std::isfinite(strain[k]) && (k == 0 || strain[k] > strain[k - 1]),
            fmt::format("{}: axial_strain: expected increasing numbers, found {}", at, strain[k]));
        require(std::isfinite(q[k]),
                fmt::format("{}: deviatoric_stress_Pa: expected a number, found {}", at, q[k]));
    }
    require(strain.size() > 1,
            fmt::format("{}: expected at least two rows, found {}", csv.string(), strain.size()));
    read_clock(table, "t", strain, test.clock.by_time);
    read_clock(table, "phase", strain, test.clock.by_phase);
    return test;
}

/// Reads a CSV file, whose form a column map may describe; `option` gives the map.
auto read_mapped(const char* option, const std::filesystem::path& map,
                 const std::vector<KnownColumn>& known, auto&& read) {
    const CsvForm form =
        map.empty() ? CsvForm{} : naming(option, [&] { return read_column_map(map, known); });
    return naming("--recordings", [&] {
        try {
            return read(form);
        } catch (const InputError& e) {
            const std::string what = e.what();
            if (!map.empty() || what.find("column") == std::string::npos) throw;
            throw InputError(
                fmt::format("{} ({} describes files of other programs)", what, option));
        }
    });
}

/// Folder of the test at one pressure.
std::filesystem::path folder_of_test(const std::filesystem::path& folder, double pressure) {
    const auto of_test = folder / folder_of(pressure);
    if (std::filesystem::is_directory(of_test)) return of_test;
    std::vector<std::string> others;
    for (const auto& entry : std::filesystem::directory_iterator(folder))
        if (entry.path().filename().string().ends_with("kPa"))
            others.push_back(entry.path().filename().string());
    std::ranges::sort(others);
    throw InputError(fmt::format("--confining-pressure: expected a folder {} in '{}', found {}{}",
                                 folder_of(pressure), folder.string(),
                                 others.empty() ? "none" : listed(others),
                                 hint_at_pressure(pressure, others)));
}

} // namespace

std::size_t RecordedTest::refused() const {
    return static_cast<std::size_t>(std::ranges::count_if(
        recordings, [&](const Recording& r) { return !accepted(findings, r.info.id); }));
}

namespace {

std::vector<std::filesystem::path> metadata_files(const std::filesystem::path& folder) {
    std::vector<std::filesystem::path> files;
    if (!std::filesystem::is_directory(folder))
        throw OutputError(fmt::format("--recordings: cannot read folder '{}'", folder.string()));
    for (const auto& entry : std::filesystem::directory_iterator(folder))
        if (entry.path().extension() == ".txt" &&
            entry.path().filename().string().starts_with("rock_"))
            files.push_back(entry.path());
    return files;
}

/// Metadata from all tests in a folder; for a sensor in several of them, the first by name counts.
std::vector<SensorInfo> infos_in_hdf5(const std::filesystem::path& folder) {
    std::vector<std::filesystem::path> files;
    for (const auto& entry : std::filesystem::directory_iterator(folder))
        if (std::filesystem::exists(entry.path() / "recordings.h5"))
            files.push_back(entry.path() / "recordings.h5");
    std::ranges::sort(files);
    std::map<unsigned, SensorInfo> by_id;
    for (const auto& file : files)
        for (const SensorInfo& info :
             naming("--recordings", [&] { return read_sensor_infos_hdf5(file); }))
            by_id.emplace(info.id, info);
    std::vector<SensorInfo> infos;
    for (const auto& [id, info] : by_id) infos.push_back(info);
    return infos;
}

/// Refuses two files with the same data, because one of them would be ignored.
[[noreturn]] void refuse_both(const std::filesystem::path& folder, const char* csv,
                              const char* in_hdf5) {
    throw InputError(fmt::format("--recordings: {}: expected {} or {}, found both", folder.string(),
                                 csv, in_hdf5));
}

void require_no_map(const char* option, const std::filesystem::path& map,
                    const std::filesystem::path& hdf5, const char* csv) {
    require(map.empty(), fmt::format("{}: expected no column map, because {} is read and no {}, "
                                     "found '{}'",
                                     option, hdf5.string(), csv, map.string()));
}

std::vector<Recording> recordings_of(const std::filesystem::path& of_test,
                                     const std::vector<SensorInfo>& infos,
                                     const std::filesystem::path& map) {
    const auto hdf5 = of_test / "recordings.h5", csv = of_test / "recordings.csv";
    if (!std::filesystem::exists(hdf5))
        return read_mapped("--columns", map_to_use(map, of_test.parent_path() / "columns.txt"),
                           recording_columns(),
                           [&](const CsvForm& form) { return read_recordings(csv, infos, form); });
    if (std::filesystem::exists(csv)) refuse_both(of_test, "recordings.csv", "recordings.h5");
    require_no_map("--columns", map, hdf5, "recordings.csv");
    return naming("--recordings", [&] { return read_recordings_hdf5(hdf5, infos); });
}

MachineRecord machine_record_of(const std::filesystem::path& of_test, double pressure,
                                const std::filesystem::path& map) {
    const auto hdf5 = of_test / "recordings.h5", csv = of_test / "test.csv";
    const bool in_hdf5 = std::filesystem::exists(hdf5);
    if (!in_hdf5 || (std::filesystem::exists(csv) && !has_machine_record(hdf5)))
        return read_mapped(
            "--machine-columns", map_to_use(map, of_test.parent_path() / "machine_columns.txt"),
            machine_columns(), [&](const CsvForm& form) { return read_test(csv, form); });
    if (std::filesystem::exists(csv)) refuse_both(of_test, "test.csv", "/bench in recordings.h5");
    require_no_map("--machine-columns", map, hdf5, "test.csv");
    return naming("--recordings", [&] { return read_machine_record(hdf5, pressure); });
}

} // namespace

std::string hint_at_pressure(double pressure, const std::vector<std::string>& folders) {
    const bool in_kilopascal = std::ranges::count(folders, folder_of(1e3 * pressure)) > 0;
    return in_kilopascal ? fmt::format(": {:g}e3?", pressure) : "";
}

const std::vector<KnownColumn>& machine_columns() {
    using Units = std::vector<ColumnUnit>;
    static const std::vector<KnownColumn> all = [] {
        std::vector<KnownColumn> columns{
            {"axial_strain", Units{{"1"}, {"%", 0.01}}, true},
            {"deviatoric_stress_Pa", Units{{"Pa"}, {"kPa", 1e3}, {"MPa", 1e6}}, true},
            {"volumetric_strain", Units{{"1"}, {"%", 0.01}}},
            {"t", Units{{"s"}, {"ms", 1e-3}, {"min", 60}, {"h", 3600}}},
            {"phase", Units{{"cycles"}, {"deg", 1.0 / 360}, {"rad", 0.5 / pi}}}};
        for (std::size_t ring = 0; ring < most_rings; ++ring)
            columns.push_back({column_of_ring(ring), Units{{"m"}, {"mm", 1e-3}}});
        return columns;
    }();
    return all;
}

std::vector<SensorInfo> read_sensor_infos(const std::filesystem::path& folder) {
    const auto files = metadata_files(folder);
    auto infos = files.empty() ? infos_in_hdf5(folder) : std::vector<SensorInfo>{};
    require(!files.empty() || !infos.empty(),
            fmt::format("--recordings: expected files rock_NN.txt in '{}', found none",
                        folder.string()));
    for (const auto& file : files)
        infos.push_back(naming("--recordings", [&] { return read_sensor_info(file); }));
    std::ranges::sort(infos, {}, &SensorInfo::id);
    const auto twice = std::ranges::adjacent_find(infos, {}, &SensorInfo::id);
    require(twice == infos.end(),
            fmt::format(
                "--recordings: expected a different id in each file rock_NN.txt, found {} twice",
                twice == infos.end() ? 0 : twice->id));
    return infos;
}

std::vector<SensorInfo> infos_of_test(const std::filesystem::path& folder, double pressure,
                                      std::vector<SensorInfo> infos) {
    const auto hdf5 = folder / folder_of(pressure) / "recordings.h5";
    if (!std::filesystem::exists(hdf5) || !metadata_files(folder).empty()) return infos;
    for (const SensorInfo& own : read_sensor_infos_hdf5(hdf5)) {
        const auto same = std::ranges::find(infos, own.id, &SensorInfo::id);
        if (same == infos.end())
            infos.push_back(own);
        else
            *same = own;
    }
    return infos;
}

void examine(RecordedTest& test, const QualityControlSettings& settings) {
    for (Recording& r : test.recordings) {
        if (!settings.displacement) r.displacement.clear();
        if (!settings.attitude) r.attitude.clear();
    }
    QualityControlLimits limits;
    limits.rest = settings.rest;
    test.trajectories.clear();
    test.findings = synchronise(test.recordings, test.clock, settings.interval);
    if (!test.unused_of_machine.empty())
        test.findings.push_back(note_on_unused(test_machine, test.unused_of_machine));
    const auto of_sensors = check_recordings(test.recordings, Vec3(0, 0, -9.81), limits);
    test.findings.insert(test.findings.end(), of_sensors.begin(), of_sensors.end());
    const auto of_machine = check_machine(test.curves, test.pressure);
    test.findings.insert(test.findings.end(), of_machine.begin(), of_machine.end());
    compare_strain(test.recordings, test.curves, test.clock, test.findings);
    double squares = 0;
    for (const Recording& r : test.recordings) {
        test.trajectories.push_back(accepted(test.findings, r.info.id)
                                        ? trajectory_of(r, settings.interval)
                                        : SensorTrajectory{});
        squares += r.info.displacement_noise * r.info.displacement_noise;
    }
    test.displacement_noise = std::sqrt(squares / static_cast<double>(test.recordings.size()));
}

RecordedTest read_recorded_test(const std::filesystem::path& folder, double pressure,
                                const std::vector<SensorInfo>& infos,
                                const QualityControlSettings& settings) {
    RecordedTest test;
    test.pressure = pressure;
    const auto of_test = folder_of_test(folder, pressure);
    test.recordings =
        recordings_of(of_test, infos_of_test(folder, pressure, infos), settings.columns);
    MachineRecord machine = machine_record_of(of_test, pressure, settings.machine_columns);
    test.curves = std::move(machine.curves);
    test.clock = std::move(machine.clock);
    test.unused_of_machine = std::move(machine.unused);
    examine(test, settings);
    return test;
}

void write_recorded_test(const std::filesystem::path& folder, double pressure,
                         const std::vector<Recording>& recordings, const MeasuredCurves& measured) {
    const auto of_test = folder / folder_of(pressure);
    for (const Recording& r : recordings)
        write_sensor_info(folder / fmt::format("rock_{:02}.txt", r.info.id), r.info);
    write_recordings(of_test / "recordings.csv", recordings,
                     {"Sensor rocks in a triaxial test. t: clock of the sensor (s); strain: axial "
                      "strain of the test.",
                      "ax ay az: specific force (m/s2), gx gy gz: angular rate (rad/s), in body "
                      "axes, means since the previous sample.",
                      "ux uy uz: displacement (m), qw qx qy qz: attitude, body to world, as from "
                      "another means of tracking."});
    write_curves(
        of_test / "test.csv", measured,
        {{&quantity::axial_strain}, {&quantity::deviatoric_stress}, {&quantity::volumetric_strain}},
        "Measurements of the test machine at the end of each stage. Compression is "
        "positive.",
        6);
}

void write_recorded_test_hdf5(const std::filesystem::path& folder, double pressure,
                              const std::vector<Recording>& recordings,
                              const MeasuredCurves& measured, const std::vector<double>& time,
                              double area) {
    const auto path = folder / folder_of(pressure) / "recordings.h5";
    UnfinishedFile unfinished(path);
    write_recordings_hdf5(unfinished.path(), recordings);
    write_machine_record(unfinished.path(), measured, time, area, pressure);
    unfinished.put_in_place();
}

} // namespace bris
