#include "scenarios/library/ring_estimate.hpp"

#include "engine/estimation/student_t.hpp"
#include "engine/io/csv.hpp"
#include "scenarios/library/library_sensors.hpp"
#include "scenarios/library/ring_profile.hpp"
#include "scenarios/library/sensor_predictive.hpp"
#include "scenarios/triaxial/triaxial_results.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace bris {

namespace {

/// Puts the displacements of the sensor rocks into a test of the library. Returns why not, or "".
std::string add_sensors(const SpecimenLibrary& library, const RecordedTest& test,
                        std::size_t coarse, LibraryTest& into) {
    std::string reason = reason_against_sensors(library, test);
    if (!reason.empty()) return reason;
    into.sensors.assign((coarse + 1) * library.sensors * LibraryTest::per_sensor, 0);
    for (std::size_t s = 0; s < library.sensors; ++s) {
        const auto u = recorded_displacement(library, test, s, coarse);
        if (!u) return fmt::format("sensor {} has no displacement", test.recordings[s].info.id);
        std::ranges::copy(u->cast<float>().eval(),
                          &into.sensors[(coarse * library.sensors + s) * LibraryTest::per_sensor]);
    }
    return "";
}

/// A sensor rock that was displaced as none in the library; "": there is none, or the library is
/// too small to tell.
std::string suspected(const SpecimenLibrary& library, std::size_t pressure, std::size_t coarse,
                      const LibraryTest& test, const RecordedTest& recorded) {
    if (library.specimens.size() < SensorPredictive::fewest) return "";
    const SensorPredictive predictive(library, pressure, coarse);
    for (std::size_t s = 0; s < library.sensors; ++s) {
        const auto motion = SensorPredictive::motion_in(library, test, coarse, s);
        if (!(predictive.distance(s, motion) > 1)) continue;
        const Vec3 found = 1e3 * motion.displacement,
                   mean = 1e3 * predictive.mean(s, motion.volume),
                   deviation = 1e3 * predictive.deviation(s);
        return fmt::format("sensor {} was displaced as none in the library: outward, sideways and "
                           "upward by {:.1f}, {:.1f} and {:.1f} mm, expected {:.1f} +- {:.1f}, "
                           "{:.1f} +- {:.1f} and {:.1f} +- {:.1f}",
                           recorded.recordings[s].info.id, found.x(), found.y(), found.z(),
                           mean.x(), deviation.x(), mean.y(), deviation.y(), mean.z(),
                           deviation.z());
    }
    return "";
}

} // namespace

RingEstimate estimate_rings(const SpecimenLibrary& library, const ModelOfTest& model,
                            const RecordedTest& test, double strain) {
    RingEstimate rings;
    rings.not_made = reason_against(library, model);
    if (!rings.not_made.empty()) return rings;
    const LibraryAxis& axis = library.axis;
    const auto steps = static_cast<std::size_t>(std::floor(strain / axis.step + 1e-6));
    const std::size_t reached = std::min(steps / axis.every, axis.coarse_count());
    if (reached == 0) {
        rings.not_made = fmt::format("the first strain at which the library has sensor rocks is "
                                     "{:g}, the test has reached {:g}",
                                     axis.coarse_strain(0), strain);
        return rings;
    }
    const std::size_t coarse = reached - 1, pressure = pressure_index(library, model.pressure);
    rings.strain = axis.coarse_strain(coarse);
    LibraryObservations observed{.strain = rings.strain, .force = false};
    const LibrarySpecimen specimen =
        measured_specimen(library, pressure, test.curves, observed, 2 * library.axis.step);
    LibraryTest measured = specimen.tests[pressure];
    if (!std::isfinite(measured.volume.back())) {
        rings.not_made = fmt::format("no volumetric strain was measured at {:g}", rings.strain);
        return rings;
    }
    rings.without_sensors = add_sensors(library, test, coarse, measured);
    if (rings.without_sensors.empty())
        rings.without_sensors = suspected(library, pressure, coarse, measured, test);
    const RingProfile profile(library, pressure, coarse,
                              rings.without_sensors.empty() ? RingSensors::tracked
                                                            : RingSensors::none);
    const RingProfile::Estimate e = profile.estimate(measured);
    const Vector half = student_t_quantile(0.95, profile.freedom()) * e.deviation,
                 scaled = profile.scaled_mean(measured);
    for (Eigen::Index r = 0; r < e.mean.size(); ++r) {
        rings.mean.push_back(e.mean[r]);
        rings.low.push_back(e.mean[r] - half[r]);
        rings.high.push_back(e.mean[r] + half[r]);
        rings.scaled_mean.push_back(scaled[r]);
    }
    return rings;
}

std::string sentence_of(const RingEstimate& r) {
    if (!r.not_made.empty()) return "the rings are not estimated: " + r.not_made;
    const auto widest = std::ranges::max_element(r.mean) - r.mean.begin();
    return fmt::format(
        "rings at {:g} % from {}: widest ring {} of {}, {:.2f} % ({:.2f} to {:.2f} with 90 %){}",
        100 * r.strain, r.without_sensors.empty() ? "volume and sensor rocks" : "volume",
        widest + 1, r.mean.size(), 100 * r.mean[static_cast<std::size_t>(widest)],
        100 * r.low[static_cast<std::size_t>(widest)],
        100 * r.high[static_cast<std::size_t>(widest)],
        r.without_sensors.empty() ? "" : "; sensor rocks are not used: " + r.without_sensors);
}

void write_rings(const std::filesystem::path& csv, const RingEstimate& r,
                 const std::vector<double>& measured) {
    std::vector<std::vector<double>> rows;
    for (std::size_t k = 0; k < r.mean.size(); ++k)
        rows.push_back({static_cast<double>(k + 1), r.mean[k], r.low[k], r.high[k],
                        r.scaled_mean[k], k < measured.size() ? measured[k] : std::nan("")});
    write_csv(
        csv,
        {"ring", "radial_strain", "radial_strain_low", "radial_strain_high", "of_mean_profile",
         "measured"},
        rows,
        {fmt::format("rings from below at an axial strain of {:g}, estimated from {} at this "
                     "strain, with the 90 % band",
                     r.strain, r.without_sensors.empty() ? "volume and sensor rocks" : "volume")},
        6);
}

std::vector<Curve> curves_of(const RingEstimate& r, const std::string& label) {
    std::vector<Curve> curves;
    const std::string used = r.without_sensors.empty() ? "volume and sensors (dashed: 90 % band)"
                                                       : "volume (dashed: 90 % band)";
    curves.push_back(ring_curve(label.empty() ? used : label, r.mean, Curve::Style::line));
    for (const auto* edge : {&r.low, &r.high})
        curves.push_back(ring_curve("", *edge, Curve::Style::dashed));
    return curves;
}

} // namespace bris
