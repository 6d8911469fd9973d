#include "scenarios/records/unit_evidence.hpp"

#include "engine/signal/median.hpp"
#include "scenarios/records/machine_quality_control.hpp"
#include "scenarios/sensors/channels.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace bris {

namespace {

constexpr double nothing = std::numeric_limits<double>::quiet_NaN();

/// The values that a quantity of a rock or a test can have, in the unit of BRIS.
struct Span {
    double low, high;
    bool holds(double x) const { return x >= low && x <= high; }
};

constexpr Span gravity{0.7 * standard_gravity, 1.4 * standard_gravity}; // m/s2, the rock may shake
constexpr Span field_of_earth{20e-6, 75e-6};                            // T
constexpr Span kelvins{233, 400};
constexpr Span sampling_rates{1.0 / 120, 50e3}; // Hz
constexpr Span strain_rates{2e-6, 1e-3};        // 1/s, of a triaxial test
constexpr Span peaks{0.1, 30};                  // largest q over the confining pressure
constexpr double largest_strain = 0.5, most_dilation = 5;

/// Median of the magnitudes of the vector with these columns, in the unit of the file.
double median_norm(const FileNumbers& numbers, const Channel& channel) {
    std::vector<double> norms;
    const auto column = [&](std::size_t k) { return std::string(channel.column(k)); };
    for (std::size_t k = 0; k < channel.size(); ++k)
        if (!numbers.has(column(k))) return nothing;
    const auto &x = numbers.of.at(column(0)), &y = numbers.of.at(column(1)),
               &z = numbers.of.at(column(2));
    for (std::size_t k = 0; k < x.size(); ++k)
        if (const double norm = std::hypot(x[k], y[k], z[k]); std::isfinite(norm))
            norms.push_back(norm);
    return norms.empty() ? nothing : median(std::move(norms));
}

/// Whether a sampling rate is one that loggers are set to: 100 Hz or more, a whole number of Hz or
/// of seconds, or 12.5, 6.25 ... Hz.
bool is_usual(double rate) {
    const auto is_near_whole = [](double x) {
        const double whole = std::round(x);
        return whole >= 1 && std::abs(x - whole) < 2e-3 * whole;
    };
    if (rate >= 100 || is_near_whole(rate) || is_near_whole(1 / rate)) return true;
    for (const double half : {12.5, 6.25, 3.125, 1.5625})
        if (std::abs(rate / half - 1) < 2e-3) return true;
    return false;
}

/// Whether a time in seconds may be one since the logger was started, or a date of this century.
bool is_usual_time(double t) {
    constexpr double years = 3.2e8, century_began = 946684800, century_ends = 4102444800;
    return std::abs(t) < years || (t > century_began && t < century_ends);
}

/// Keeps the units for which the value is possible.
void keep(std::vector<ColumnUnit>& units, auto&& is_possible) {
    std::erase_if(units, [&](const ColumnUnit& u) { return !is_possible(u.scale); });
}

/// Whether two values are the same but for a unit; minutes and seconds differ by more.
bool is_near(double found, double known) { return found > 0.2 * known && found < 5 * known; }

PossibleUnits units_of_times(const KnownColumn& column, const FileNumbers& numbers,
                             const FileEvidence& evidence) {
    PossibleUnits possible{column.units, ""};
    const auto intervals = intervals_of(numbers);
    if (intervals.empty()) return possible;
    const double interval = median(intervals);
    if (!(interval > 0)) return possible;
    double first = nothing, last = nothing;
    for (const double t : numbers.of.at("t"))
        if (std::isfinite(t)) last = t, first = std::isfinite(first) ? first : t;
    std::string because =
        fmt::format("only then are intervals of {:.6g} those of a usual sampling rate", interval);
    const bool of_sensors = numbers.has("id"); // a machine may write whenever it likes
    keep(possible.units, [&](double u) {
        const double rate = 1 / (u * interval);
        const bool is_rate = u < 60 && sampling_rates.holds(rate) && is_usual(rate);
        return is_usual_time(u * first) && (!of_sensors || is_rate); // no logger counts minutes
    });
    if (evidence.rate > 0) {
        keep(possible.units, [&](double u) { return is_near(1 / (u * interval), evidence.rate); });
        because += fmt::format(", the file states {:g} Hz", evidence.rate);
    }
    if (evidence.duration > 0) {
        keep(possible.units,
             [&](double u) { return is_near(u * (last - first), evidence.duration); });
        because += fmt::format(", the test took {:.4g} s by the machine", evidence.duration);
    }
    const char* const strain = numbers.is_known("strain") ? "strain" : "axial_strain";
    if (numbers.is_known(strain)) {
        const double most = numbers.largest(strain);
        keep(possible.units,
             [&](double u) { return strain_rates.holds(most / (u * (last - first))); });
        because += fmt::format(", the strain reaches {:.3g}", most);
    }
    possible.reason = because;
    return possible;
}

PossibleUnits units_of_vector(const KnownColumn& column, const FileNumbers& numbers) {
    PossibleUnits possible{column.units, ""};
    const Channel& channel = *channel_with(column.name);
    const bool is_force = &channel == &channel_of(&Recording::force);
    const double norm = median_norm(numbers, channel);
    const Span expected = is_force ? gravity : field_of_earth;
    keep(possible.units, [&](double u) { return expected.holds(u * norm); });
    if (!possible.units.empty())
        possible.reason = fmt::format("the median magnitude of {:.3g} is then that of {}", norm,
                                      is_force ? "gravity" : "the field of the earth");
    else
        possible.units = column.units;
    return possible;
}

PossibleUnits units_of_stress(const KnownColumn& column, const FileNumbers& numbers,
                              const FileEvidence& evidence) {
    PossibleUnits possible{column.units, ""};
    if (!(evidence.pressure > 0)) return possible;
    keep(possible.units, [&](double u) {
        return peaks.holds(numbers.largest(column.name, {"", u}) / evidence.pressure);
    });
    possible.reason =
        fmt::format("the largest is then {} times the confining pressure",
                    possible.units.size() == 1
                        ? fmt::format("{:.2g}", numbers.largest(column.name, possible.units[0]) /
                                                    evidence.pressure)
                        : "0.1 to 30");
    return possible;
}

/// Secant modulus at half of the largest q, for strains of this unit, Pa.
double stiffness(const FileNumbers& numbers, double unit) {
    const auto &strain = numbers.of.at("axial_strain"), &q = numbers.of.at("deviatoric_stress_Pa");
    const double scale = numbers.unit.at("deviatoric_stress_Pa").scale,
                 half = 0.5 * numbers.largest("deviatoric_stress_Pa");
    for (std::size_t k = 0; k < q.size(); ++k)
        if (scale * q[k] >= half && strain[k] > 0) return scale * q[k] / (unit * strain[k]);
    return nothing;
}

PossibleUnits units_of_strain(const KnownColumn& column, const FileNumbers& numbers,
                              const FileEvidence& evidence) {
    PossibleUnits possible{column.units, ""};
    const auto most = [&](double u) { return numbers.largest(column.name, {"", u}); };
    keep(possible.units, [&](double u) { return most(u) <= largest_strain; });
    possible.reason = fmt::format("no test reaches {:.3g}", most(1));
    const bool has_q = numbers.is_known("deviatoric_stress_Pa") && evidence.pressure > 0;
    if (column.name == "axial_strain" && has_q && possible.units.size() > 1) {
        const MachineLimits limits;
        keep(possible.units, [&](double u) {
            const double modulus = stiffness(numbers, u) / evidence.pressure;
            return modulus >= limits.least_stiffness && modulus <= limits.largest_stiffness;
        });
        possible.reason = "the specimen is then as stiff as ballast";
    }
    if (column.name == "strain" && evidence.final_strain > 0) {
        keep(possible.units, [&](double u) { return is_near(most(u), evidence.final_strain); });
        possible.reason = fmt::format("the machine reaches {:.3g}", evidence.final_strain);
    }
    if (column.name == "volumetric_strain" && numbers.is_known("axial_strain")) {
        const double axial = numbers.largest("axial_strain");
        keep(possible.units, [&](double u) { return most(u) <= most_dilation * axial + 1e-3; });
        possible.reason = fmt::format("the axial strain reaches {:.3g}", axial);
    }
    return possible;
}

} // namespace

double FileNumbers::largest(const std::string& name, const ColumnUnit& as) const {
    double most = nothing;
    for (const double x : of.at(name))
        if (std::isfinite(x)) most = std::fmax(most, std::abs(as.scale * x + as.offset));
    return most;
}

std::vector<double> intervals_of(const FileNumbers& numbers) {
    std::map<double, double> last; // by sensor
    std::vector<double> intervals;
    const auto& times = numbers.of.at("t");
    for (std::size_t k = 0; k < times.size(); ++k) {
        const double id = numbers.has("id") ? numbers.of.at("id")[k] : 0, t = times[k];
        if (!std::isfinite(t) || !std::isfinite(id)) continue;
        const auto [before, is_first] = last.try_emplace(id, t);
        if (!is_first) intervals.push_back(t - before->second);
        before->second = t;
    }
    return intervals;
}

PossibleUnits possible_units(const KnownColumn& column, const FileNumbers& numbers,
                             const FileEvidence& evidence) {
    const std::string& name = column.name;
    if (name == "t") return units_of_times(column, numbers, evidence);
    const Channel* const channel = channel_with(name);
    if (channel == &channel_of(&Recording::force) || channel == &channel_of(&Recording::field))
        return units_of_vector(column, numbers);
    if (name == "deviatoric_stress_Pa") return units_of_stress(column, numbers, evidence);
    if (name.ends_with("strain")) return units_of_strain(column, numbers, evidence);
    if (name == "temp" && kelvins.holds(numbers.largest(name, {"K"})))
        return {{column.units.front()}, "it is no temperature in another unit"};
    return {column.units, ""};
}

} // namespace bris
