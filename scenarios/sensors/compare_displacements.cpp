#include "engine/signal/median.hpp"
#include "scenarios/sensors/inspection.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

namespace bris {

namespace {

constexpr std::size_t fewest = 4; // other rocks needed for a trend
// expected displacement of a rock from which it is judged, relative to the scatter of the others
constexpr double seen = 5, well_seen = 8;
// share of the expected displacement below which a rock is refused: no rock judged in fifty tests
// with 400 rocks moved less
constexpr double hardly = 0.3;
constexpr double common_way = 1e-3; // m, expected displacement from which all rocks are judged

const char* name_of(Eigen::Index axis) { return axis == 0 ? "x" : axis == 1 ? "y" : "z"; }

/// The last known strain of a recording; NaN: none.
double last_strain(const Recording& r) {
    const auto known = std::find_if(r.strain.rbegin(), r.strain.rend(),
                                    [](double strain) { return std::isfinite(strain); });
    return known == r.strain.rend() ? std::nan("") : *known;
}

/// Displacement of a rock from its start at one strain.
struct Gone {
    const Recording* recording;
    Vec3 displacement;
    double height() const { return recording->info.z; }
};

/// The median of the last three samples up to a strain, minus the median at rest.
std::optional<Gone> gone(const Recording& r, double strain) {
    std::vector<Vec3> rest, last;
    for (std::size_t k = 0; k < r.size(); ++k) {
        if (r.strain[k] <= 0)
            rest.push_back(r.displacement[k]);
        else if (r.strain[k] <= strain * (1 + 1e-6))
            last.push_back(r.displacement[k]);
    }
    if (last.size() < 3) return {};
    last.erase(last.begin(), last.end() - 3);
    return Gone{&r, median(last) - (rest.empty() ? Vec3(Vec3::Zero()) : median(rest))};
}

/// Linear trend of the vertical displacement over height and the scatter about it, m. It uses
/// medians of slopes, so that a wrong recording changes it little.
struct Trend {
    double low, high; ///< m, range of heights for which it is known
    double at_base, slope, scatter;
    double at(double height) const { return at_base + slope * height; }
};

Trend trend_of(const std::vector<Gone>& all, std::size_t without) {
    std::vector<double> slopes, bases, sizes, off;
    Trend trend{.low = 1e300, .high = -1e300, .at_base = 0, .slope = 0, .scatter = 0};
    double noise = 0;
    const auto for_others = [&](auto&& body) {
        for (std::size_t k = 0; k < all.size(); ++k)
            if (k != without) body(all[k]);
    };
    for_others([&](const Gone& a) {
        const double uncertain = 3 * a.recording->info.position_deviation;
        trend.low = std::min(trend.low, a.height() - uncertain);
        trend.high = std::max(trend.high, a.height() + uncertain);
        noise = std::max(noise, a.recording->info.displacement_noise);
        for_others([&](const Gone& b) {
            if (b.height() > a.height() + 3 * uncertain)
                slopes.push_back((b.displacement.z() - a.displacement.z()) /
                                 (b.height() - a.height()));
        });
    });
    if (!slopes.empty()) trend.slope = median(std::move(slopes));
    for_others(
        [&](const Gone& g) { bases.push_back(g.displacement.z() - trend.slope * g.height()); });
    trend.at_base = median(std::move(bases));
    for_others([&](const Gone& g) {
        off.push_back(std::abs(g.displacement.z() - trend.at(g.height())));
        sizes.push_back(std::abs(g.displacement.z()));
    });
    // a lower bound: a few rocks that agree by chance must not make the others look wrong
    trend.scatter = std::max(
        {deviation_of_median(median(std::move(off))), 0.15 * median(std::move(sizes)), 2 * noise});
    return trend;
}

/// The horizontal axis along which a rock moved, in either direction, as far as it should have
/// moved down.
std::optional<Eigen::Index> axis_instead(const Vec3& displacement, double expected) {
    for (const Eigen::Index axis : {0, 1})
        if (std::abs(std::abs(displacement[axis] / expected) - 1) < hardly) return axis;
    return {};
}

void check_one(const std::vector<Gone>& all, std::size_t one, double strain,
               std::vector<Finding>& findings) {
    const Trend trend = trend_of(all, one);
    const Gone& rock = all[one];
    const double expected = trend.at(rock.height()), share = rock.displacement.z() / expected;
    if (rock.height() < trend.low || rock.height() > trend.high ||
        std::abs(expected) < seen * trend.scatter || share > hardly)
        return;
    const auto axis = axis_instead(rock.displacement, expected);
    if (share > 0 && std::abs(expected) < well_seen * trend.scatter && !axis) return;
    findings.push_back(
        {Finding::Kind::refusal, rock.recording->info.id, "displacement",
         fmt::format("inconsistent with the other rocks: at {:.3f} % of axial strain expected "
                     "{:.1f} mm upwards with a scatter of {:.1f} mm, found {:.1f} mm{}",
                     100 * strain, 1e3 * expected, 1e3 * trend.scatter, 1e3 * rock.displacement.z(),
                     share < -0.5 ? ": its sign seems to be reversed"
                     : axis       ? fmt::format(": {} and z seem to be swapped", name_of(*axis))
                                  : "")});
}

/// The median displacement of the rocks should be axial strain times height downwards, and none to
/// the side. Returns whether it is.
bool check_everything(const std::vector<Gone>& all, double strain, std::vector<Finding>& findings) {
    std::array<std::vector<double>, 3> shares;
    std::vector<double> expected;
    for (const Gone& g : all) {
        if (g.height() <= 0) return true; // heights are not measured from the base
        expected.push_back(strain * g.height());
        for (Eigen::Index axis = 0; axis < 3; ++axis)
            shares[static_cast<std::size_t>(axis)].push_back(g.displacement[axis] /
                                                             expected.back());
    }
    const double down = median(expected);
    if (down < common_way) return true;
    const Vec3 share(median(shares[0]), median(shares[1]), median(shares[2]));
    Eigen::Index side = 0;
    const double sideways = share.head<2>().cwiseAbs().maxCoeff(&side);
    const bool upwards = share.z() > hardly, aside = share.z() > -hardly && sideways > 0.5;
    if (!upwards && !aside) return true;
    for (const Gone& g : all)
        findings.push_back(
            {Finding::Kind::refusal, g.recording->info.id, "frame",
             fmt::format("at {:.3f} % of axial strain expected a median displacement of all sensor "
                         "rocks of about {:.1f} mm downwards, found one {} of {:.1f} mm: {}",
                         100 * strain, 1e3 * down,
                         upwards ? "upwards" : fmt::format("along {}", name_of(side)),
                         1e3 * down * (upwards ? share.z() : share[side]),
                         upwards
                             ? "the sign of all seems to be reversed"
                             : fmt::format("{} and z of all seem to be swapped", name_of(side)))});
    return false;
}

} // namespace

void compare_displacements(const std::vector<Recording>& recordings,
                           std::vector<Finding>& findings) {
    std::vector<const Recording*> some;
    std::vector<double> ends;
    for (const Recording& r : recordings) {
        const double end = last_strain(r);
        if (r.displacement.empty() || std::isnan(end) || !accepted(findings, r.info.id)) continue;
        some.push_back(&r);
        ends.push_back(end);
    }
    if (some.size() <= fewest) return;
    const double strain = median(ends);
    std::vector<Gone> all;
    for (std::size_t k = 0; k < some.size(); ++k)
        if (ends[k] >= 0.9 * strain) // a recording that ended much earlier is not compared
            if (const auto g = gone(*some[k], strain)) all.push_back(*g);
    if (all.size() <= fewest || !check_everything(all, strain, findings)) return;
    for (std::size_t one = 0; one < all.size(); ++one) check_one(all, one, strain, findings);
}

} // namespace bris
