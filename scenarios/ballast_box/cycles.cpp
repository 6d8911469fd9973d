#include "scenarios/ballast_box/cycles.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

namespace bris {

std::vector<RunFile::Column> cycle_columns() {
    return {{"cycle", ""},
            {"time", "s"},
            {"load_1", "N"},
            {"load_2", "N"},
            {"deflection_1", "m"},
            {"deflection_2", "m"},
            {"bladder_pressure", "Pa"},
            {"bladder_displacement", "m"},
            {"subgrade_settlement", "m"},
            {"unbalanced_ratio", ""}};
}

std::vector<CycleResponse> cycle_responses(const Series& samples, int tie) {
    const std::string number = std::to_string(tie);
    const auto &cycle = samples.column("cycle"), &load = samples.column("load_" + number),
               &deflection = samples.column("deflection_" + number);
    std::vector<CycleResponse> all;
    double last_load = 0, last_deflection = 0;
    CycleResponse now;
    double highest = -std::numeric_limits<double>::infinity(),
           lowest = std::numeric_limits<double>::infinity(), most_load = 0,
           least_load = std::numeric_limits<double>::infinity();
    for (std::size_t k = 0; k < cycle.size(); ++k) {
        if (k > 0) now.loop_area += 0.5 * (load[k] + last_load) * (deflection[k] - last_deflection);
        last_load = load[k];
        last_deflection = deflection[k];
        highest = std::max(highest, deflection[k]);
        lowest = std::min(lowest, deflection[k]);
        most_load = std::max(most_load, load[k]);
        least_load = std::min(least_load, load[k]);
        if (cycle[k] < static_cast<double>(all.size() + 1) - 1e-6) continue;
        now.settlement = deflection[k];
        now.resilient = highest - deflection[k];
        // the unloading half, without the plastic part of the loading half
        now.stiffness = (most_load - least_load) /
                        (tie == 1 ? now.resilient : std::max(highest - lowest, 1e-300));
        all.push_back(now);
        now = {};
        highest = -std::numeric_limits<double>::infinity();
        lowest = std::numeric_limits<double>::infinity();
        most_load = 0;
        least_load = std::numeric_limits<double>::infinity();
    }
    return all;
}

} // namespace bris
