#pragma once

#include <array>
#include <string>
#include <string_view>

namespace bris {

/// Messages with numbers. `test`: of a model that follows a test; `timing`: of the same model, by
/// clocks, so that they are others in a replay; `sensor`: of a sensor beside its baseline.
enum class NumbersOf { test, timing, sensor };

struct PublishedNumber {
    NumbersOf message;
    std::string_view name, unit, meaning; ///< unit 1: none
};

/// All numbers that are published. Publishers can use no other name (ValueOf); the live page is
/// given this table (bris/numbers) and knows no name itself; the table in
/// assets/live_page/README.md is published_table_for_documents().
inline constexpr auto published_numbers = std::to_array<PublishedNumber>({
    {NumbersOf::test, "axial_strain", "1", "of the stage, compression positive"},
    {NumbersOf::test, "measured_q_Pa", "Pa", "deviatoric stress that the test machine measured"},
    {NumbersOf::test, "model_q_Pa", "Pa", "of the model with the friction and stiffness learned"},
    {NumbersOf::test, "fused_q_Pa", "Pa",
     "expected measured q of this stage: that of the model times how much stronger the tested "
     "specimen was in all records before this one"},
    {NumbersOf::test, "fused_q_half_width_Pa", "Pa",
     "half width of the band in which the measured q is expected with a probability of 95 %"},
    {NumbersOf::test, "specimen_factor", "1", "fused_q_Pa over model_q_Pa"},
    {NumbersOf::test, "measured_volumetric_strain", "1", "decrease of volume positive"},
    {NumbersOf::test, "model_volumetric_strain", "1", "of the model"},
    {NumbersOf::test, "learned_friction", "1", "estimate of the friction coefficient of the rocks"},
    {NumbersOf::test, "learned_friction_deviation", "1", "its standard deviation"},
    {NumbersOf::test, "learned_stiffness_ratio", "1",
     "estimate of the contact stiffness over --clump-stiffness"},
    {NumbersOf::test, "learned_stiffness_ratio_deviation", "1", "its standard deviation"},
    {NumbersOf::timing, "axial_strain", "1", "of the stage"},
    {NumbersOf::timing, "latency_s", "s",
     "lag: from the arrival of the machine's record to the answer of the model"},
    {NumbersOf::sensor, "recorded_time_s", "s", "recorded time up to the end of the passage"},
    {NumbersOf::sensor, "rms_ratio", "1", "root mean square over that of the baseline"},
    {NumbersOf::sensor, "rms_ratio_seen_below", "1",
     "a ratio below it would have been seen in 90 % of passages"},
    {NumbersOf::sensor, "rms_ratio_seen_above", "1", "likewise above it"},
    {NumbersOf::sensor, "outlier_share", "1",
     "points outside the limits of the SmartRock report's control charts"},
});

/// A curve of the page over another number of the same message, shown in units of its own.
struct PublishedCurve {
    NumbersOf message;
    std::string_view title, axis; ///< with the units that are shown
    double factor, axis_factor;   ///< from the published units
    std::string_view over;
    struct Line {
        std::string_view name, label, half_width = {}; ///< of a band around it; empty: none
    };
    std::array<Line, 3> lines; ///< those without a name are none
};

inline constexpr auto published_curves = std::to_array<PublishedCurve>({
    {NumbersOf::test,
     "Deviatoric stress q (kPa)",
     "axial strain (%)",
     1e-3,
     100,
     "axial_strain",
     {{{"fused_q_Pa", "fused, band 95 %", "fused_q_half_width_Pa"},
       {"measured_q_Pa", "measured"},
       {"model_q_Pa", "model alone"}}}},
    {NumbersOf::test,
     "Volumetric strain (%)",
     "axial strain (%)",
     100,
     100,
     "axial_strain",
     {{{"model_volumetric_strain", "model"}, {"measured_volumetric_strain", "measured"}}}},
    {NumbersOf::test,
     "Friction coefficient",
     "axial strain (%)",
     1,
     100,
     "axial_strain",
     {{{"learned_friction", "learned, one standard deviation", "learned_friction_deviation"}}}},
    {NumbersOf::test,
     "Stiffness ratio",
     "axial strain (%)",
     1,
     100,
     "axial_strain",
     {{{"learned_stiffness_ratio", "learned, one standard deviation",
        "learned_stiffness_ratio_deviation"}}}},
    {NumbersOf::timing,
     "Lag behind the test (s)",
     "axial strain (%)",
     1,
     100,
     "axial_strain",
     {{{"latency_s", "lag"}}}},
    {NumbersOf::sensor,
     "Points outside the limits (%)",
     "recorded time (s)",
     100,
     1,
     "recorded_time_s",
     {{{"outlier_share", "share"}}}},
    {NumbersOf::sensor,
     "Ratio to the baseline",
     "recorded time (s)",
     1,
     1,
     "recorded_time_s",
     {{{"rms_ratio", "root mean square"},
       {"rms_ratio_seen_below", "below: seen in 90 %"},
       {"rms_ratio_seen_above", "above: seen in 90 %"}}}},
});

constexpr bool is_published(NumbersOf message, std::string_view name) {
    for (const PublishedNumber& n : published_numbers)
        if (n.message == message && n.name == name) return true;
    return false;
}

constexpr bool curves_are_published() {
    for (const PublishedCurve& c : published_curves) {
        if (!is_published(c.message, c.over)) return false;
        for (const auto& line : c.lines)
            if ((!line.name.empty() && !is_published(c.message, line.name)) ||
                (!line.half_width.empty() && !is_published(c.message, line.half_width)))
                return false;
    }
    return true;
}
static_assert(curves_are_published(), "a curve of the page shows a number that is not published");

/// A number of a message. A name that is not in the table does not compile.
template <NumbersOf Message>
struct ValueOf {
    template <std::size_t N>
    consteval static std::string_view checked(const char (&name)[N]) {
        if (!is_published(Message, name)) throw "this name is not in published_numbers";
        return name;
    }
    struct Name {
        template <std::size_t N>
        consteval Name(const char (&name)[N]) : text(checked(name)) {}
        std::string_view text;
    };
    Name name;
    double value; ///< NaN: unknown
};

/// bris/numbers: the table and the curves, a JSON object.
std::string published_table();
/// The table as Markdown.
std::string published_table_for_documents();

} // namespace bris
