#include "engine/signal/attitude.hpp"
#include "engine/signal/median.hpp"
#include "scenarios/sensors/inspection.hpp"

namespace bris {

namespace {

constexpr double degree = pi / 180;

double angle_between(const Vec3& a, const Vec3& b) {
    return std::acos(std::clamp(a.normalized().dot(b.normalized()), -1.0, 1.0));
}

bool are_unit(const Inspection& at) {
    const auto& q = at.recording.attitude;
    const auto wrong = [&](const Quat& one) { return std::abs(one.norm() - 1) > at.limits.norm; };
    const auto first = std::ranges::find_if(q, wrong);
    if (first == q.end()) return true;
    at.refuse(
        "attitude",
        fmt::format("expected unit quaternions, found {} that are not, the first with norm {:.4g}",
                    std::ranges::count_if(q, wrong), first->norm()));
    return false;
}

/// Compares the attitude at rest with that of the metadata. A tracker that uses its own axes for
/// each rock, far from the body axes, does not agree either: its attitudes must be converted first.
void check_start(const Inspection& at) {
    const SensorInfo& info = at.recording.info;
    const auto deviation_of = [&](auto&& read) {
        std::vector<double> deviation;
        for (std::size_t k = 0; k < at.still; ++k)
            deviation.push_back(read(at.recording.attitude[k]).angularDistance(info.attitude()) /
                                degree);
        return median(std::move(deviation));
    };
    const double limit = at.limits.frame + 3 * info.attitude_deviation,
                 deviation = deviation_of([](const Quat&q) { return q; });
    if (deviation <= limit) return;
    const bool conjugate = deviation_of([](const Quat&q) { return q.conjugate(); }) <= limit,
               last = deviation_of([](const Quat&q) { return Quat(q.z(), q.w(), q.x(), q.y()); }) <=
                      limit;
    at.refuse("attitude", fmt::format("at rest: expected the attitude of the metadata within "
                                      "{:.0f} degrees, found a deviation of {:.0f} degrees{}",
                                      limit, deviation,
                                      conjugate ? ": it seems to lead from the world to the body"
                                      : last    ? ": its components seem to be in the order x y z w"
                                                : ""));
}

/// Rocks in a slow test hardly accelerate: the specific force, rotated by the attitude, points
/// upwards as it did at rest. A rotation about the vertical alone cannot be detected in this way.
void check_upwards(const Inspection& at, const Vec3& gravity) {
    const Recording& r = at.recording;
    std::vector<Vec3> up;
    std::size_t compared = 0, outliers = 0;
    double farthest = 0;
    for (std::size_t k = 0; k < at.still; ++k) up.push_back(r.attitude[k] * r.force[k]);
    const Vec3 upwards =
        at.still > 0 ? median(up) : Vec3(-gravity); // includes biases and axes of the tracker
    const double own = 3 * (r.info.attitude_noise + r.info.force_bias / gravity.norm()) / degree;
    const double limit =
        own + (at.still > 0 ? at.limits.tilt : at.limits.frame + 3 * r.info.attitude_deviation);
    for (std::size_t k = at.still; k < r.size(); ++k) {
        if (std::abs(r.force[k].norm() / upwards.norm() - 1) > at.limits.gravity)
            continue; // it accelerates
        const double deviation = angle_between(r.attitude[k] * r.force[k], upwards) / degree;
        ++compared;
        outliers += static_cast<std::size_t>(deviation > limit);
        farthest = std::max(farthest, deviation);
    }
    if (outliers <= 3 ||
        static_cast<double>(outliers) <= at.limits.outlier_share * static_cast<double>(compared))
        return;
    at.refuse(
        "attitude",
        fmt::format(
            "inconsistent with gravity: expected the force, rotated by the attitude, to point "
            "upwards as at rest within {:.0f} degrees, found larger deviations in {} of {} "
            "samples, up to {:.0f} degrees",
            limit, outliers, compared, farthest));
}

/// Differences between the rotations in successive parts of the test, rad, world frame. A slowly
/// drifting bias cancels.
std::vector<Vec3> changes_of(const std::vector<Vec3>& turns) {
    std::vector<Vec3> changes;
    for (std::size_t k = 1; k < turns.size(); ++k) changes.emplace_back(turns[k] - turns[k - 1]);
    return changes;
}

/// Compares rotations from the attitude with those from the angular rates, which are means since
/// the previous sample, or densely sampled. Where the two are correlated, or anti-correlated, their
/// magnitudes must agree too. Rates that are sparse single samples miss the rotation between them;
/// then the correlation is low and nothing is concluded.
void check_turns(const Inspection& at) {
    const Recording& r = at.recording;
    constexpr std::size_t parts = 16;
    if (at.still == 0 || r.size() < at.still + 2 * parts) return;
    std::vector<Vec3> turns, by_rates;
    const Vec3 bias = at.median_before_test(r.rate);
    const std::size_t each = (r.size() - at.still) / parts;
    for (std::size_t begin = at.still - 1; begin + each < r.size(); begin += each) {
        turns.push_back(attitude_error(r.attitude[begin + each], r.attitude[begin]));
        by_rates.emplace_back(Vec3::Zero());
        for (std::size_t k = begin + 1; k <= begin + each; ++k)
            by_rates.back() += (r.time[k] - r.time[k - 1]) * (r.attitude[k] * (r.rate[k] - bias));
    }
    const auto a = changes_of(turns), b = changes_of(by_rates);
    double both = 0, by_attitude = 0, by_rate = 0;
    for (std::size_t k = 0; k < a.size(); ++k) {
        both += a[k].dot(b[k]);
        by_attitude += a[k].squaredNorm();
        by_rate += b[k].squaredNorm();
    }
    const double noise = 18 * r.info.attitude_noise * r.info.attitude_noise *
                         static_cast<double>(a.size()); // (1, -2, 1)^2 of three components
    if (by_attitude < 10 * noise || by_rate <= 0) return;
    const double agreement = both / std::sqrt(by_attitude * by_rate),
                 size = std::sqrt(by_rate / by_attitude);
    if (std::abs(agreement) < 0.8) return;
    if (agreement < 0)
        return at.refuse("attitude", "inconsistent with the angular rates: expected rotations in "
                                     "the same sense, found the opposite: the sign of one of the "
                                     "two seems to be reversed");
    if (size > 1.0 / 3 && size < 3) return;
    const auto near = [&](double factor) { return size > factor / 2 && size < 2 * factor; };
    at.refuse("rate", fmt::format("expected the integrated rates to equal the rotation of the "
                                  "attitude, found {:.3g} times as much{}",
                                  size,
                                  near(1 / degree) ? ": they seem to be in deg/s"
                                  : near(degree)   ? ": they seem to be in rad/s, not in deg/s"
                                                   : ""));
}

} // namespace

void check_attitude(const Inspection& at, const Vec3& gravity) {
    const Recording& r = at.recording;
    if (r.attitude.empty() || !are_unit(at) ||
        is_stuck(at, "attitude", r.attitude, r.info.attitude_noise))
        return;
    if (at.still > 0) check_start(at);
    std::vector<Vec3> turned;
    for (const Quat& q : r.attitude) turned.push_back(attitude_error(q, r.attitude.front()));
    check_scatter(at, "attitude", turned, r.info.attitude_noise,
                  at.limits.turning * strain_step(at), "mrad", 1e-3);
    if (r.strain.empty()) return; // not a quasi-static test
    if (!r.force.empty()) check_upwards(at, gravity);
    if (!r.rate.empty()) check_turns(at);
}

} // namespace bris
