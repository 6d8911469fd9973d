#include "scenarios/assimilation/recorded_movements.hpp"

#include "engine/errors.hpp"
#include "engine/io/csv.hpp"
#include "engine/random.hpp"
#include "scenarios/monitoring/deflection.hpp"
#include "scenarios/monitoring/passage.hpp"
#include "scenarios/monitoring/sensor_baseline.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace bris {

std::vector<RecordedMovement> recorded(const PassageMovements& movements,
                                       const RecordingErrors& errors, std::uint64_t seed) {
    constexpr double least = 1e-5; // m
    constexpr std::uint64_t stream = 883;
    Random random(seed, stream);
    std::vector<RecordedMovement> all;
    for (std::size_t k = 0; k < movements.rocks.size(); ++k) {
        const double scale = 1 + errors.relative * random.normal(),
                     offset = errors.noise * random.normal(),
                     deflection = scale * movements.rocks[k].deflection + offset;
        if (movements.rocks[k].deflection < least || deflection < least) continue;
        const double deviation = std::hypot(errors.relative * deflection, errors.noise);
        all.push_back({k, deflection, std::min(deviation, deflection)});
    }
    return all;
}

std::vector<RecordedMovement> read_movements(const std::filesystem::path& file,
                                             const std::vector<std::string>& names) {
    constexpr double most = 50; // mm
    const CsvTable table = read_csv(file);
    const auto sensor = table.column("sensor"), deflection = table.column("deflection_mm"),
               deviation = table.column("deviation_mm");
    require(!sensor.empty(), file.string() + ": expected at least one sensor rock, found none");
    std::vector<RecordedMovement> all;
    for (std::size_t k = 0; k < sensor.size(); ++k) {
        const auto expect = [&](bool is_met, const std::string& what, double found) {
            require(is_met, fmt::format("{}:{}: expected {}, found {:g}", file.string(),
                                        table.lines[k], what, found));
        };
        const auto count = static_cast<double>(names.size());
        expect(sensor[k] >= 1 && sensor[k] <= count && sensor[k] == std::floor(sensor[k]),
               fmt::format("a sensor from 1 to {}", names.size()), sensor[k]);
        const auto index = static_cast<std::size_t>(sensor[k]) - 1;
        expect(std::ranges::find(all, index, &RecordedMovement::sensor) == all.end(),
               "one line for each sensor", sensor[k]);
        expect(deflection[k] > 0 && deflection[k] <= most,
               fmt::format("a deflection_mm above 0 and at most {:g}", most), deflection[k]);
        expect(deviation[k] >= 0 && deviation[k] <= deflection[k],
               "a deviation_mm of at least 0 and at most the deflection", deviation[k]);
        all.push_back({index, 1e-3 * deflection[k], 1e-3 * deviation[k]});
    }
    return all;
}

std::vector<RecordedMovement> movements_in(const std::filesystem::path& folder,
                                           const LoadHistory& load,
                                           const std::vector<std::string>& names,
                                           const std::function<void(const std::string&)>& report) {
    const auto passages = read_passages(folder, {}, "--recordings");
    require(!passages.empty(),
            fmt::format("--recordings: expected recordings of a passage in '{}', found none",
                        folder.string()));
    const Passage& passage = passages.back();
    const auto findings = findings_of(passage, {});
    std::vector<RecordedMovement> all;
    for (const Recording& r : passage.recordings) {
        require(r.info.id >= 1 && r.info.id <= names.size(),
                fmt::format("--recordings: {}: expected sensors with the ids 1 to {}, found {}",
                            folder.string(), names.size(), r.info.id));
        const std::size_t sensor = r.info.id - 1;
        const std::string refusal = refusal_of(findings, r.info.id);
        std::string why = refusal.empty() ? "" : "refused by quality control: " + refusal;
        if (why.empty()) {
            const RecordedDeflection d = deflection_of(r, load);
            why = d.impossible_because;
            if (why.empty() && !(d.largest > 0)) why = "it does not move";
            if (why.empty()) all.push_back({sensor, d.largest, std::min(d.deviation, d.largest)});
        }
        if (!why.empty())
            report(fmt::format("sensor {} ({}) is left out: {}", r.info.id, names[sensor], why));
    }
    require(!all.empty(), fmt::format("--recordings: expected at least one sensor rock with a "
                                      "deflection in '{}', found none: not enough data",
                                      folder.string()));
    return all;
}

void write_movements(const std::filesystem::path& file,
                     const std::vector<RecordedMovement>& movements,
                     const std::vector<std::string>& names) {
    std::vector<std::string> comments{
        "Deflection of sensor rocks in one passage, from recordings with errors. Sensors:"};
    for (std::size_t k = 0; k < names.size(); ++k)
        comments.push_back(fmt::format("{}: {}", k + 1, names[k]));
    std::vector<std::vector<double>> rows;
    for (const RecordedMovement& m : movements)
        rows.push_back({static_cast<double>(m.sensor + 1), 1e3 * m.deflection, 1e3 * m.deviation});
    write_csv(file, {"sensor", "deflection_mm", "deviation_mm"}, rows, comments);
}

} // namespace bris
