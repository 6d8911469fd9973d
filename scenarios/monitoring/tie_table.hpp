#pragma once

#include "engine/options.hpp"
#include "engine/report.hpp"
#include "scenarios/monitoring/passage.hpp"
#include "scenarios/monitoring/tie_fit.hpp"

#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace bris {

/// Sensors that sit on ties, and the train that passes them.
struct TieSettings {
    std::vector<double> sensors = {}; ///< numbers
    std::string train = "passenger";
    double speed = 31.3, support = 48e6, bending = 1.58e7;

    void declare_options(auto& option);
};

/// Deflections of ties and voids below them, by their sensors (fit_tie), in all passages.
class TieTable {
public:
    /// Throws InputError if there is no such train.
    explicit TieTable(const TieSettings& settings);
    /// At the speed that the passage states as speed_m_s, or else at that of the settings. A sensor
    /// without samples is noted, too.
    void add(const Passage& passage, bool is_baseline);
    /// Throws InputError if a sensor has no sample in the baseline.
    void require_in_baseline() const;

    /// Writes ties.csv, and adds medians of each sensor, now and in the baseline; nothing if no
    /// sensor sits on a tie.
    void write(const std::filesystem::path& folder, Report& summary) const;
    /// Which tie tells no deflection in a passage now; empty: all do.
    std::string not_judged() const;

private:
    struct Line {
        std::string passage;
        unsigned sensor;
        bool is_baseline;
        TieFit fit;
    };
    std::vector<Line> lines_of(unsigned sensor, bool of_baseline, bool with_fit) const;

    TieSettings settings_;
    std::vector<unsigned> sensors_; ///< their numbers
    Train train_;
    std::vector<Line> lines_;
};

void TieSettings::declare_options(auto& option) {
    option.group("Ties");
    option("tie_sensors", sensors, "",
           "Numbers of sensors that sit on ties. The largest deflection of these ties and the void "
           "below them are found from the train that passes.",
           within(1, 1e9));
    option("train", train, "",
           "Train: passenger, freight, inspection, locomotive (assets/trains), or the path of a "
           "CSV file with the columns position_m and axle_load_kN.");
    option("train_speed", speed, "m/s",
           "Its speed to within 5 %, where passages.csv states no speed_m_s.", within(1, 120));
    option("tie_support", support, "N/m",
           "Support of the ties beside those with sensors, by pad, bed and subgrade in series.",
           within(1e6, 1e10).usually(1e7, 2e8));
    option("rail_bending", bending, "N m2", "Bending stiffness E I of both rails together.",
           within(1e4, 1e9));
}

} // namespace bris
