#include "scenarios/monitoring/tie_table.hpp"

#include "engine/errors.hpp"
#include "engine/io/whole_file.hpp"
#include "engine/signal/median.hpp"
#include "scenarios/ballast_box/box_run.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace bris {

namespace {

constexpr auto silent = "no sample";

} // namespace

TieTable::TieTable(const TieSettings& settings) : settings_(settings) {
    if (settings_.sensors.empty()) return;
    for (const double number : settings_.sensors) {
        require(number == std::floor(number),
                fmt::format("--tie-sensors: expected whole numbers, found {:g}", number));
        sensors_.push_back(static_cast<unsigned>(number));
    }
    train_ = train_named(settings_.train);
}

void TieTable::add(const Passage& passage, bool is_baseline) {
    const auto stated = passage.cause.numbers.find("speed_m_s");
    const bool is_stated = stated != passage.cause.numbers.end() && stated->second > 0;
    const PassingTrain passing{train_,
                               is_stated ? stated->second : settings_.speed,
                               {.bending = settings_.bending,
                                .tie_support = settings_.support,
                                .spacing = tie_spacing,
                                .tie_weight = weight_of_tie},
                               dead_load};
    for (const unsigned sensor : sensors_) {
        const auto found =
            std::ranges::find_if(passage.recordings, [&](const Recording& recording) {
                return recording.info.id == sensor && recording.size() > 0;
            });
        const TieFit fit = found == passage.recordings.end() ? TieFit{.impossible_because = silent}
                                                             : fit_tie(*found, passing);
        lines_.push_back({passage.name, sensor, is_baseline, fit});
    }
}

void TieTable::require_in_baseline() const {
    for (const unsigned sensor : sensors_)
        require(std::ranges::any_of(lines_,
                                    [&](const Line& line) {
                                        return line.sensor == sensor &&
                                               line.fit.impossible_because != silent;
                                    }),
                fmt::format("--tie-sensors: expected numbers of sensors of the baseline, found {}, "
                            "which recorded nothing there",
                            sensor));
}

std::vector<TieTable::Line> TieTable::lines_of(unsigned sensor, bool of_baseline,
                                               bool with_fit) const {
    std::vector<Line> found;
    for (const Line& line : lines_)
        if (line.sensor == sensor && line.is_baseline == of_baseline &&
            line.fit.impossible_because.empty() == with_fit)
            found.push_back(line);
    return found;
}

void TieTable::write(const std::filesystem::path& folder, Report& summary) const {
    if (sensors_.empty()) return;
    std::string text =
        "# largest deflections of ties and voids below them, by their sensors and "
        "the train; low, high: of fits that are nearly as good; carried 0: perhaps the "
        "tie did not reach its bed, and both are larger\n"
        "passage,sensor,baseline,speed_m_per_s,deflection_m,deflection_low_m,"
        "deflection_high_m,void_m,void_low_m,void_high_m,carried,share_left,reason\n";
    for (const auto& [passage, sensor, is_baseline, fit] : lines_) {
        const std::string numbers =
            fit.impossible_because.empty()
                ? fmt::format("{:.4g},{:.4g},{:.4g},{:.4g},{:.4g},{:.4g},{:.4g},{},{:.3g}",
                              fit.speed, fit.deflection.value, fit.deflection.low,
                              fit.deflection.high, fit.gap.value, fit.gap.low, fit.gap.high,
                              fit.is_carried ? 1 : 0, fit.left)
                : ",,,,,,,,";
        text += fmt::format("\"{}\",{},{},{},\"{}\"\n", passage, sensor, is_baseline ? 1 : 0,
                            numbers, fit.impossible_because);
    }
    write_whole(folder / "ties.csv", text);
    for (const unsigned sensor : sensors_) {
        for (const bool of_baseline : {false, true}) {
            const auto fits = lines_of(sensor, of_baseline, true);
            const std::string key =
                fmt::format("sensor_{}_{}", sensor, of_baseline ? "baseline_" : "");
            summary.add(key + "passages_without_deflection",
                        lines_of(sensor, of_baseline, false).size());
            if (fits.empty()) continue;
            summary.add(key + "passages_not_carried",
                        std::ranges::count(fits, false,
                                           [](const Line& line) { return line.fit.is_carried; }));
            std::vector<double> deflections, voids;
            for (const Line& line : fits) {
                deflections.push_back(1e3 * line.fit.deflection.value);
                voids.push_back(1e3 * line.fit.gap.value);
            }
            summary.add(key + "tie_deflection_mm", median(std::move(deflections)));
            summary.add(key + "tie_void_mm", median(std::move(voids)));
            summary.show({key + "tie_deflection_mm", key + "tie_void_mm"});
        }
    }
}

std::string TieTable::not_judged() const {
    const auto line = std::ranges::find_if(
        lines_, [](const Line& l) { return !l.is_baseline && !l.fit.impossible_because.empty(); });
    if (line == lines_.end()) return {};
    return fmt::format("no deflection of the tie of sensor {} in {}: {}", line->sensor,
                       line->passage, line->fit.impossible_because);
}

} // namespace bris
