#pragma once

#include "engine/signal/median.hpp"
#include "scenarios/sensors/quality_control.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

namespace bris {

/// A recording under quality control, and where the findings are added.
struct Inspection {
    const Recording& recording;
    const QualityControlLimits& limits;
    std::vector<Finding>& findings;
    /// Number of samples at the beginning during which the rock should be at rest.
    std::size_t rest = 0;
    /// Number of those among them that precede the start of the test.
    std::size_t still = 0;

    /// Counts the samples at rest.
    void find_rest() {
        const Recording& r = recording;
        rest = static_cast<std::size_t>(std::ranges::count_if(
            r.time, [&](double t) { return t <= r.time.front() + limits.rest; }));
        while (still < rest && (r.strain.empty() || !(r.strain[still] > 0)))
            ++still; // NaN: strain was not sampled
    }

    /// Median of the values before the start of the test; `still` must not be 0.
    Vec3 median_before_test(const std::vector<Vec3>& values) const {
        return median(
            std::vector<Vec3>(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(still)));
    }

    void note(std::string check, std::string text) const {
        findings.push_back(
            {Finding::Kind::note, recording.info.id, std::move(check), std::move(text)});
    }
    void refuse(std::string check, std::string text) const {
        findings.push_back(
            {Finding::Kind::refusal, recording.info.id, std::move(check), std::move(text)});
    }
};

/// Whether values (vectors or quaternions) of a sensor with noise stay the same to the last digit;
/// adds a refusal in that case.
bool is_stuck(const Inspection& at, const char* what, const auto& values, double noise);

/// Whether one component of a vector stays the same to the last digit while the others change; adds
/// a refusal in that case. Not judged where the others change in coarse steps, as a converter with
/// few bits makes them: then any component may stay the same.
bool has_stuck_axis(const Inspection& at, const char* what, const std::vector<Vec3>& values);

/// Compares the scatter of a quantity with the declared noise, at rest and from sample to sample
/// during the test (by second differences). Uses medians, so that outliers carry no more weight
/// than other samples. During the test the motion of the rock may add `roughness`. `unit`: unit of
/// the text, equal to `scale` SI units.
void check_scatter(const Inspection& at, const char* what, const std::vector<Vec3>& values,
                   double declared, double roughness, const char* unit, double scale);

/// Median increment of axial strain from one sample to the next during the test; 0: unknown.
double strain_step(const Inspection& at);

/// Whether the recorded strain is one that a test can reach, in compression, grows, and begins at 0
/// where samples of the specimen at rest precede the test; adds a refusal otherwise.
bool has_possible_strain(const Inspection& at);

/// Checks displacements for jumps, for scatter above the declared noise, and for magnitudes that
/// the axial strain does not permit.
void check_displacement(const Inspection& at);

/// Checks attitudes: unit quaternions, agreement at rest with the metadata, agreement of the
/// vertical with gravity, and agreement of the rotations with the angular rates.
void check_attitude(const Inspection& at, const Vec3& gravity);

/// Reports how many samples the sensor itself flagged as unusable.
void check_flags(const Inspection& at);

/// Reports samples that are missing according to the sample counter, together with the number
/// according to the time stamps. Counts and times must increase.
void check_count(const Inspection& at);

/// Reports the range and drift of the temperature, whether the bias of the gyroscope at rest
/// depends on it, and a low battery.
void check_device(const Inspection& at);

/// Reports whether the magnetic field of the earth is steady, and the yaw that follows from it.
void check_field(const Inspection& at);

/// Compares the angular rates with the tilt that gravity shows, also where no other attitude is
/// recorded: rates of one sensor with the opposite sign, and rates of all sensors (at least three)
/// whose axes are exchanged or reversed, are refused. Tests of vibration and recordings whose rates
/// are sparse single samples are not judged.
void compare_turns(const std::vector<Recording>& recordings, const QualityControlLimits& limits,
                   std::vector<Finding>& findings);

/// Compares the displacements of all sensors that have not been refused: rocks move down with the
/// upper platen, the more the higher they are.
void compare_displacements(const std::vector<Recording>& recordings,
                           std::vector<Finding>& findings);

/// The finite numbers of a series.
inline std::vector<double> finite_of(std::vector<double> values) {
    std::erase_if(values, [](double x) { return !std::isfinite(x); });
    return values;
}

bool is_stuck(const Inspection& at, const char* what, const auto& values, double noise) {
    if (noise <= 0) return false; // declared to have no noise
    const auto same = [](const auto& a, const auto& b) {
        if constexpr (requires { a.coeffs(); })
            return a.coeffs() == b.coeffs();
        else
            return a == b;
    };
    std::size_t run = 0, longest = 0;
    for (std::size_t k = 1; k < values.size(); ++k)
        longest =
            std::max(longest, run = same(values[k], values[k - 1]) ? run + 1 : std::size_t{0});
    const double rate = at.recording.info.sampling_rate,
                 stuck = static_cast<double>(longest) / rate;
    if (stuck <= std::max(at.limits.stuck, 3 / rate)) return false;
    at.refuse("stuck",
              fmt::format("{}: expected noise, found the same value for {:.3g} s", what, stuck));
    return true;
}

} // namespace bris
