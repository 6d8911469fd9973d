#pragma once

#include "engine/assets.hpp"
#include "scenarios/sensors/quality_control.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

namespace bris::testing {

/// The shipped recordings up to a strain.
inline std::vector<Recording> example_recordings(const std::string& pressure, double strain = 1) {
    const std::filesystem::path folder = assets_folder() / "smartrock";
    std::vector<SensorInfo> infos;
    for (int k = 1; k <= 10; ++k)
        infos.push_back(read_sensor_info(folder / fmt::format("rock_{:02}.txt", k)));
    auto all = read_recordings(folder / pressure / "recordings.csv", infos);
    for (Recording& r : all) {
        const auto samples = static_cast<std::size_t>(
            std::ranges::count_if(r.strain, [&](double e) { return e <= strain + 1e-9; }));
        for (auto* numbers : {&r.time, &r.strain}) numbers->resize(samples);
        for (auto* vectors : {&r.force, &r.rate, &r.displacement}) vectors->resize(samples);
        r.sequence.resize(samples);
        r.attitude.resize(samples);
    }
    return all;
}

inline std::vector<Finding> check_test_records(const std::vector<Recording>& all) {
    QualityControlLimits limits;
    limits.rest = 60;
    return check_recordings(all, Vec3(0, 0, -9.81), limits);
}

/// The refusals of a sensor, a line each.
inline std::string refusals(const std::vector<Recording>& all, unsigned sensor) {
    std::string text;
    for (const Finding& f : check_test_records(all))
        if (f.sensor == sensor && f.kind == Finding::Kind::refusal)
            text += f.check + ": " + f.text + "\n";
    return text;
}

inline bool has(const std::string& text, const std::string& part) {
    return text.find(part) != std::string::npos;
}

} // namespace bris::testing
