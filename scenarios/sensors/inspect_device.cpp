#include "engine/estimation/linear_fit.hpp"
#include "scenarios/sensors/heading.hpp"
#include "scenarios/sensors/inspection.hpp"

#include <array>
#include <cmath>

namespace bris {

namespace {

constexpr double degree = pi / 180;
constexpr std::size_t fewest = 30; // samples at rest for a regression of rates on temperature

/// Indices of the samples with a number.
std::vector<std::size_t> measured(const std::vector<double>& numbers) {
    std::vector<std::size_t> rows;
    for (std::size_t k = 0; k < numbers.size(); ++k)
        if (std::isfinite(numbers[k])) rows.push_back(k);
    return rows;
}

void check_temperature(const Inspection& at) {
    const auto& kelvin = at.recording.temperature;
    const auto rows = measured(kelvin);
    if (rows.empty()) return;
    double lowest = kelvin[rows.front()], highest = lowest;
    for (const std::size_t k : rows) {
        lowest = std::min(lowest, kelvin[k]);
        highest = std::max(highest, kelvin[k]);
    }
    const auto mean = [&](std::size_t from, std::size_t to) {
        double sum = 0;
        for (std::size_t k = from; k < to; ++k) sum += kelvin[rows[k]];
        return sum / static_cast<double>(to - from);
    };
    const std::size_t tenth = std::max<std::size_t>(1, rows.size() / 10);
    const bool possible = lowest > zero_celsius - 60 && highest < zero_celsius + 125;
    at.note("temperature",
            fmt::format("{:.1f} to {:.1f} C, {:+.1f} K from the beginning to the end{}",
                        lowest - zero_celsius, highest - zero_celsius,
                        mean(rows.size() - tenth, rows.size()) - mean(0, tenth),
                        possible ? "" : ": expected -60 to 125 C, is temperature_unit right?"));
}

/// The rates of a rock at rest are the bias of the gyroscope: checks whether it depends on the
/// temperature.
void check_bias(const Inspection& at) {
    const Recording& r = at.recording;
    if (r.temperature.empty() || r.rate.empty()) return;
    std::vector<double> kelvin;
    std::array<std::vector<double>, 3> rates;
    for (std::size_t k = 0; k < at.still; ++k) {
        if (!std::isfinite(r.temperature[k])) continue;
        kelvin.push_back(r.temperature[k]);
        for (std::size_t axis = 0; axis < 3; ++axis)
            rates[axis].push_back(r.rate[k][static_cast<Eigen::Index>(axis)]);
    }
    if (kelvin.size() < fewest) return;
    const auto [low, high] = std::ranges::minmax(kelvin);
    if (high - low < 1) return; // K
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const LinearFit fit = fit_line(kelvin, rates[axis], low, high);
        if (std::abs(fit.slope) < 5 * fit.slope_error)
            continue; // five standard errors: by chance once in half a million for three axes
        at.note(
            "temperature",
            fmt::format("the bias of g{} at rest depends on it: {:.2g} +- {:.1g} rad/s per K, over "
                        "a range of {:.1f} K",
                        "xyz"[axis], fit.slope, fit.slope_error, high - low));
    }
}

void check_battery(const Inspection& at) {
    const Recording& r = at.recording;
    const std::string& unit = r.info.battery_unit;
    const double low = r.info.battery_low > 0 ? r.info.battery_low : unit == "V" ? 3.3 : 15;
    std::size_t below = 0, first = 0;
    double lowest = low;
    const auto rows = measured(r.battery);
    for (const std::size_t k : rows) {
        if (!(r.battery[k] < low)) continue;
        if (below++ == 0) first = k;
        lowest = std::min(lowest, r.battery[k]);
    }
    if (below > 0)
        at.note("battery", fmt::format("low in {} of {} samples, the first at t = {:.6g} s: "
                                       "expected at least {:g} {}, found {:.3g}",
                                       below, rows.size(), r.time[first], low, unit, lowest));
}

} // namespace

void check_flags(const Inspection& at) {
    const Recording& r = at.recording;
    if (!r.flagged.empty())
        at.note("flags",
                fmt::format("{} of {} samples are left out because the sensor flags them, the "
                            "first at t = {:.6g} s",
                            r.flagged.size(), r.flagged.size() + r.size(), r.flagged.front()));
}

void check_count(const Inspection& at) {
    const Recording& r = at.recording;
    if (r.sequence.empty()) return;
    std::vector<double> flagged = r.flagged;
    std::erase_if(flagged, [](double t) { return !std::isfinite(t); });
    std::ranges::sort(flagged);
    const auto flagged_within = [&](double from, double to) {
        return static_cast<double>(std::ranges::lower_bound(flagged, to) -
                                   std::ranges::upper_bound(flagged, from));
    };
    double lost = 0, gaps = 0;
    for (std::size_t k = 1; k < r.size(); ++k) {
        const auto skipped =
            static_cast<double>(r.sequence[k] - r.sequence[k - 1] - 1); // counts increase
        const double missing =
            skipped > 0 ? std::max(0.0, skipped - flagged_within(r.time[k - 1], r.time[k])) : 0;
        lost += missing;
        gaps += missing > 0 ? 1 : 0;
    }
    const double due = (r.time.back() - r.time.front()) * r.info.sampling_rate;
    const double by_time = std::round(due) - static_cast<double>(r.size() - 1) -
                           flagged_within(r.time.front(), r.time.back());
    const bool agree = std::abs(by_time - lost) <= 1 + at.limits.clock_drift * due;
    if (lost == 0 && agree) return;
    at.note(
        "count",
        fmt::format("{} samples are missing by the sample counter, in {} gaps; {} by the times{}",
                    lost, gaps, std::max(0.0, by_time),
                    agree ? "" : ": clock, counter or sampling_rate is wrong"));
}

void check_device(const Inspection& at) {
    check_temperature(at);
    check_bias(at);
    check_battery(at);
}

void check_field(const Inspection& at) {
    const Recording& r = at.recording;
    if (r.field.empty()) return;
    const Heading h = heading_of(r);
    if (!h.observable())
        return at.note("field", "yaw is not observable: " + h.unobservable_because);
    std::string text = fmt::format("{:.3g} uT, within {:.2g} %, dip {:.0f} degrees: yaw is "
                                   "observable, at the end {:+.1f} +- {:.1f} degrees",
                                   1e6 * h.field, 100 * h.wander, h.dip / degree, h.turn / degree,
                                   h.deviation / degree);
    const double apart = std::remainder(h.by_attitude - h.turn, 2 * pi);
    if (std::isfinite(apart)) {
        text += fmt::format("; by the attitudes {:+.1f}", h.by_attitude / degree);
        if (std::abs(apart) >
            3 * std::hypot(h.deviation, r.info.attitude_noise) + at.limits.tilt * degree)
            text += ": the axes of one of the two are wrong, or iron is nearby";
    } else {
        text += "; it is not assimilated";
    }
    at.note("field", text);
}

} // namespace bris
