#pragma once

#include "scenarios/recordings/quality_control.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

namespace bris {

/// A recording that the intake looks at, and where its findings go.
struct Inspection {
    const Recording& recording;
    const QualityControlLimits& limits;
    std::vector<Finding>& findings;
    std::size_t rest =
        0; ///< samples of the time at the beginning in which the rock should lie still
    std::size_t still = 0; ///< of them, those before the test began

    void note(std::string check, std::string text) const {
        findings.push_back(
            {Finding::Kind::note, recording.info.id, std::move(check), std::move(text)});
    }
    void refuse(std::string check, std::string text) const {
        findings.push_back(
            {Finding::Kind::refusal, recording.info.id, std::move(check), std::move(text)});
    }
};

/// Whether values (vectors or quaternions) of a sensor that has noise stay the same to the last
/// digit; refuses them then.
bool is_stuck(const Inspection& at, const char* what, const auto& values, double noise);

/// What a quantity scatters by beside the noise declared, by medians, so that samples that are far
/// off count no more than others: at rest and, by second differences, from sample to sample in the
/// test, in which the rocks' own motion may add `roughness`. `unit`: as shown, of which one is
/// `scale` SI units.
void check_scatter(const Inspection& at, const char* what, const std::vector<Vec3>& values,
                   double declared, double roughness, const char* unit, double scale);

/// Axial strain from one sample to the next in the test, the median; 0: not known.
double strain_step(const Inspection& at);

/// Jumps, scatter beside that declared, and ways longer than the test lets a rock go.
void check_displacement(const Inspection& at);

/// Unit quaternions; the attitude at rest that the metadata give; upwards where gravity says it is;
/// turns as the rates say.
void check_attitude(const Inspection& at, const Vec3& gravity);

/// How many samples the sensor itself said not to use.
void check_flags(const Inspection& at);

/// Samples that are missing by their count, beside what their times tell. For counts and times that
/// grow.
void check_count(const Inspection& at);

/// Temperature, its range and drift, whether the gyroscope's bias at rest follows it; a battery
/// that is low.
void check_device(const Inspection& at);

/// Whether the earth's field is steady, and what it says of yaw.
void check_field(const Inspection& at);

/// Displacements of all sensors beside each other, of those that have not been refused: rocks go
/// down with the upper platen, the higher the more.
void compare_displacements(const std::vector<Recording>& recordings,
                           std::vector<Finding>& findings);

bool is_stuck(const Inspection& at, const char* what, const auto& values, double noise) {
    if (noise <= 0) return false; // declared to have none
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
    at.refuse("stuck", fmt::format("{} stays the same for {:.3g} s, expected noise", what, stuck));
    return true;
}

} // namespace bris
