#include "scenarios/sensors/heading.hpp"

#include "engine/signal/attitude.hpp"
#include "engine/signal/median.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace bris {

namespace {

constexpr double degree = pi / 180, microtesla = 1e-6;
constexpr double weakest = 20 * microtesla, strongest = 70 * microtesla,
                 fewest_level = 5 * microtesla; // on the earth: 22 to 67 uT
constexpr double steady_size = 0.05, steady_dip = 5 * degree;
constexpr std::size_t fewest = 10; // samples needed for a verdict

/// Attitude from the body to east, magnetic north and up.
Quat attitude_by(const Vec3& up, const Vec3& field) {
    const Vec3 east = field.cross(up).normalized(), upwards = up.normalized();
    Mat3 rows;
    rows << east.transpose(), upwards.cross(east).transpose(), upwards.transpose();
    return Quat(Eigen::Matrix3d(rows));
}

double dip_of(const Vec3& up, const Vec3& field) {
    return std::asin(std::clamp(-up.normalized().dot(field.normalized()), -1.0, 1.0));
}

/// Distance from the middle within which nine tenths of the values lie.
double wander_of(std::vector<double> values, double middle) {
    for (double& v : values) v = std::abs(v - middle);
    const auto nine_tenths =
        values.begin() + static_cast<std::ptrdiff_t>(9 * (values.size() - 1) / 10);
    std::nth_element(values.begin(), nine_tenths, values.end());
    return *nine_tenths;
}

/// Samples with a field and with a specific force that gives the vertical.
std::vector<std::size_t> usable(const Recording& r) {
    std::vector<std::size_t> rows;
    for (std::size_t k = 0; k < std::min(r.field.size(), r.force.size()); ++k)
        if (r.field[k].allFinite() && r.field[k].norm() > 0 && r.force[k].allFinite() &&
            r.force[k].norm() > 0.5 * standard_gravity)
            rows.push_back(k);
    return rows;
}

/// A field that is sampled more slowly than the other channels repeats values, but not for a tenth
/// of the recording.
bool is_stuck(const Recording& r, const std::vector<std::size_t>& rows) {
    std::size_t run = 0, longest = 0;
    for (std::size_t k = 1; k < rows.size(); ++k)
        longest = std::max(longest, run = r.field[rows[k]] == r.field[rows[k - 1]] ? run + 1 : 0);
    return longest >= std::max(fewest, rows.size() / 10);
}

std::string reason_against(const Heading& h, const Recording& r,
                           const std::vector<std::size_t>& rows) {
    if (is_stuck(r, rows)) return "expected noise, found a constant field";
    if (h.field < weakest || h.field > strongest)
        return fmt::format(
            "expected the field of the earth, {:g} to {:g} uT, found {:.3g}: the unit may be "
            "wrong, or iron is nearby",
            weakest / microtesla, strongest / microtesla, h.field / microtesla);
    if (h.wander > steady_size)
        return fmt::format("the field is disturbed: expected its magnitude to stay within {:g} %, "
                           "found {:.2g} %",
                           100 * steady_size, 100 * h.wander);
    if (h.dip_wander > steady_dip)
        return fmt::format("the field is disturbed, or its axes differ from those of the force: "
                           "expected its dip to stay within {:g} degrees, found {:.2g}",
                           steady_dip / degree, h.dip_wander / degree);
    if (h.field * std::cos(h.dip) < fewest_level)
        return fmt::format("expected a horizontal component of at least {:g} uT, found {:.2g}",
                           fewest_level / microtesla, h.field * std::cos(h.dip) / microtesla);
    return "";
}

} // namespace

Heading heading_of(const Recording& r) {
    const auto rows = usable(r);
    Heading h;
    h.by_attitude = std::numeric_limits<double>::quiet_NaN();
    if (rows.size() < fewest) {
        h.unobservable_because = fmt::format(
            "expected at least {} samples with field and force, which gives the vertical, found {}",
            fewest, rows.size());
        return h;
    }
    std::vector<double> sizes, dips;
    std::vector<Vec3> field, force; // before the test
    std::size_t before = rows.front();
    for (const std::size_t k : rows) {
        sizes.push_back(r.field[k].norm());
        dips.push_back(dip_of(r.force[k], r.field[k]));
        if (!field.empty() && (r.strain.empty() || !(r.strain[k] <= 0))) continue;
        field.push_back(r.field[k]);
        force.push_back(r.force[k]);
        before = k;
    }
    h.field = median(sizes);
    h.dip = median(dips);
    h.wander = wander_of(sizes, h.field) / h.field;
    h.dip_wander = wander_of(dips, h.dip);
    h.unobservable_because = reason_against(h, r, rows);
    if (!h.observable()) return h;
    const SensorInfo& info = r.info;
    const std::size_t last = rows.back();
    const Vec3 turned = attitude_error(attitude_by(r.force[last], r.field[last]),
                                       attitude_by(median(force), median(field)));
    h.turn = turned.z();
    if (!r.attitude.empty())
        h.by_attitude = attitude_error(r.attitude[last], r.attitude[before]).z();
    const double level = h.field * std::cos(h.dip),
                 tilt =
                     std::hypot(info.force_bias, info.force_noise * std::sqrt(info.sampling_rate)) /
                     standard_gravity;
    const double noise = info.field_noise * microtesla *
                         std::sqrt(1 + 1 / static_cast<double>(field.size())),
                 bias = info.field_bias * microtesla * std::min(turned.norm(), 2.0);
    h.deviation = std::hypot(std::hypot(noise, bias) / level, h.wander * h.field / level,
                             tilt * std::tan(h.dip));
    return h;
}

} // namespace bris
