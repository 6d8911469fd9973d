#include "scenarios/forecast/recorded_movements.hpp"

#include "engine/errors.hpp"
#include "engine/io/csv.hpp"
#include "engine/random.hpp"
#include "scenarios/monitoring/compliance.hpp"
#include "scenarios/monitoring/passage.hpp"
#include "scenarios/monitoring/sensor_baseline.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace bris {

std::vector<RecordedMovement> recorded(const PassageMovements& movements,
                                       const RecordingErrors& errors, std::uint64_t seed) {
    constexpr double least = 1e-10; // m/N
    constexpr std::uint64_t stream = 883;
    Random random(seed, stream);
    std::vector<RecordedMovement> all;
    for (std::size_t k = 0; k < movements.rocks.size(); ++k) {
        const double scale = 1 + errors.relative * random.normal(),
                     offset = errors.noise * random.normal(),
                     compliance = scale * movements.rocks[k].compliance + offset;
        if (movements.rocks[k].compliance < least || compliance < least) continue;
        const double deviation = std::hypot(errors.relative * compliance, errors.noise);
        all.push_back({k, compliance, std::min(deviation, compliance)});
    }
    return all;
}

std::vector<RecordedMovement> read_movements(const std::filesystem::path& file,
                                             const std::vector<std::string>& names) {
    constexpr double most = 500; // um/kN
    const CsvTable table = read_csv(file);
    const auto sensor = table.column("sensor"), compliance = table.column("compliance_um_per_kN"),
               deviation = table.column("deviation_um_per_kN");
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
        expect(compliance[k] > 0 && compliance[k] <= most,
               fmt::format("a compliance_um_per_kN above 0 and at most {:g}", most), compliance[k]);
        expect(deviation[k] >= 0 && deviation[k] <= compliance[k],
               "a deviation_um_per_kN of at least 0 and at most the compliance", deviation[k]);
        all.push_back({index, 1e-9 * compliance[k], 1e-9 * deviation[k]});
    }
    return all;
}

std::string sentence_of(const JudgedRecording& r, const std::string& name) {
    const std::string who = fmt::format("sensor {} ({})", r.sensor + 1, name);
    const std::string fit = r.fit.speed > 0
                                ? fmt::format("goodness of fit {:.2g} at {:.4g} m/s, p = {:.2g}",
                                              r.fit.goodness, r.fit.speed, r.fit.p_value)
                                : "";
    if (r.left_out_because.empty()) return fmt::format("{} fits the train: {}", who, fit);
    return fmt::format("{} is left out: {}{}", who, r.left_out_because,
                       fit.empty() ? "" : " (" + fit + ")");
}

FolderOfMovements movements_in(const std::filesystem::path& folder, const PassingTrain& passing,
                               const std::vector<std::string>& names) {
    const auto passages = read_passages(folder, {}, "--recordings");
    require(!passages.empty(),
            fmt::format("--recordings: expected recordings of a passage in '{}', found none",
                        folder.string()));
    const Passage& passage = passages.back();
    const auto findings = findings_of(passage, {});
    FolderOfMovements all;
    for (const Recording& r : passage.recordings) {
        require(r.info.id >= 1 && r.info.id <= names.size(),
                fmt::format("--recordings: {}: expected sensors with the ids 1 to {}, found {}",
                            folder.string(), names.size(), r.info.id));
        JudgedRecording judged{.sensor = r.info.id - 1};
        const std::string refusal = refusal_of(findings, r.info.id);
        if (!refusal.empty()) {
            judged.left_out_because = "refused by quality control: " + refusal;
        } else {
            const RecordedCompliance c = compliance_of(r, passing);
            judged.fit = c.fit;
            judged.left_out_because = c.impossible_because;
            if (c.impossible_because.empty())
                all.movements.push_back({judged.sensor, c.value, c.deviation});
        }
        all.recordings.push_back(std::move(judged));
    }
    return all;
}

void write_movements(const std::filesystem::path& file,
                     const std::vector<RecordedMovement>& movements,
                     const std::vector<std::string>& names) {
    std::vector<std::string> comments{
        "Compliance of sensor rocks in one passage, from recordings with errors. Sensors:"};
    for (std::size_t k = 0; k < names.size(); ++k)
        comments.push_back(fmt::format("{}: {}", k + 1, names[k]));
    std::vector<std::vector<double>> rows;
    for (const RecordedMovement& m : movements)
        rows.push_back({static_cast<double>(m.sensor + 1), 1e9 * m.compliance, 1e9 * m.deviation});
    write_csv(file, {"sensor", "compliance_um_per_kN", "deviation_um_per_kN"}, rows, comments);
}

} // namespace bris
