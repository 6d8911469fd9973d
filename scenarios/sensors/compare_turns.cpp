#include "scenarios/sensors/inspection.hpp"

#include <array>
#include <cmath>

namespace bris {

namespace {

constexpr std::size_t parts = 32; // of a test, between which the tilt is compared
constexpr std::size_t fewest = 3; // sensors that tell exchanged axes from chance

/// A way to assign the axes of rates: component k of the result is sign[k] times component axis[k].
struct Axes {
    std::array<int, 3> axis, sign;

    friend bool operator==(const Axes&, const Axes&) = default;
    Vec3 operator()(const Vec3& v) const {
        return {sign[0] * v[axis[0]], sign[1] * v[axis[1]], sign[2] * v[axis[2]]};
    }
    std::string name() const {
        std::string text;
        for (std::size_t k = 0; k < 3; ++k)
            text += fmt::format("{}{}g{}", k > 0 ? " " : "", sign[k] < 0 ? "-" : "",
                                "xyz"[static_cast<std::size_t>(axis[k])]);
        return text;
    }
};

constexpr Axes declared{{0, 1, 2}, {1, 1, 1}}, reversed{{0, 1, 2}, {-1, -1, -1}};

/// All 48 ways.
std::vector<Axes> all_axes() {
    std::vector<Axes> all;
    std::array<int, 3> axis{0, 1, 2};
    do
        for (int signs = 0; signs < 8; ++signs)
            all.push_back({axis, {signs & 1 ? -1 : 1, signs & 2 ? -1 : 1, signs & 4 ? -1 : 1}});
    while (std::ranges::next_permutation(axis).found);
    return all;
}

/// Sums over products of two series, of which the correlation coefficient is made.
struct Products {
    double both = 0, first = 0, second = 0;
    void add(const Vec3& a, const Vec3& b) {
        both += a.dot(b);
        first += a.squaredNorm();
        second += b.squaredNorm();
    }
    Products& operator+=(const Products& other) {
        both += other.both;
        first += other.first;
        second += other.second;
        return *this;
    }
    double correlation() const {
        return first > 0 && second > 0 ? both / std::sqrt(first * second) : 0;
    }
};

/// What a recording shows of the tilt in the parts of a test: the direction of the specific force
/// (body axes) at the limits of the parts, and the rotation vector (sensor axes) between them.
class Turns {
public:
    explicit Turns(const Inspection& at) : r_(at.recording) {
        if (at.still == 0 || r_.strain.empty() || r_.force.empty() || r_.rate.empty() ||
            r_.size() < at.still + 2 * parts)
            return;
        const std::size_t each = (r_.size() - at.still) / parts;
        const Vec3 bias = at.median_before_test(r_.rate);
        for (std::size_t part = 0; part <= parts; ++part) {
            const std::size_t end = at.still - 1 + part * each;
            up_.push_back(direction_near(end, each / 16));
            if (part == 0) continue;
            Vec3 turn = Vec3::Zero();
            for (std::size_t k = end - each + 1; k <= end; ++k)
                turn += (r_.time[k] - r_.time[k - 1]) * (r_.rate[k] - bias);
            turns_.emplace_back(r_.info.mounting().conjugate() * turn);
        }
        find_changes(each);
    }

    /// Whether the rock tilts by far more than its sensors' noise.
    bool are_seen() const { return seen_; }

    /// Products of the changes by gravity with those that the rates cause: a rotation by the small
    /// angle t moves a fixed direction u in body axes by -t x u. Differences from part to part are
    /// compared, so that a bias that has drifted cancels.
    Products products(const Axes& axes) const {
        Products sum;
        Vec3 last = Vec3::Zero();
        for (std::size_t k = 0; k < parts; ++k) {
            const Vec3 turn = r_.info.mounting() * axes(turns_[k]),
                       change = -turn.cross(0.5 * (up_[k] + up_[k + 1]));
            if (k > 0) sum.add(changes_[k - 1], change - last);
            last = change;
        }
        return sum;
    }

    const Recording& recording() const { return r_; }

private:
    Vec3 direction_near(std::size_t k, std::size_t reach) const {
        Vec3 sum = Vec3::Zero();
        for (std::size_t i = k > reach ? k - reach : 0; i <= std::min(k + reach, r_.size() - 1);
             ++i)
            sum += r_.force[i].normalized();
        return sum.normalized();
    }

    void find_changes(std::size_t each) {
        double squares = 0;
        for (std::size_t k = 1; k < parts; ++k) {
            changes_.emplace_back(up_[k + 1] - 2 * up_[k] + up_[k - 1]);
            squares += changes_.back().squaredNorm();
        }
        const SensorInfo& info = r_.info;
        const double samples = static_cast<double>(2 * (each / 16) + 1);
        // (1, -2, 1)^2 of two components of the direction; (1, -1)^2 of those of the rotation
        const double of_force =
            12 * std::pow(info.force_noise / standard_gravity, 2) * info.sampling_rate / samples;
        const double of_rate =
            4 * std::pow(info.rate_noise, 2) * static_cast<double>(each) / info.sampling_rate;
        seen_ = squares > 10 * static_cast<double>(parts) * (of_force + of_rate);
    }

    const Recording& r_;
    std::vector<Vec3> up_, turns_, changes_;
    bool seen_ = false;
};

/// Refuses the rates of all sensors if other axes agree with gravity and the declared ones do not.
bool check_axes(const std::vector<Turns>& all, std::vector<Finding>& findings) {
    if (all.size() < fewest) return true;
    constexpr double agrees = 0.8, far = 0.3; // correlations; the shipped recordings have 0.98
    double best = 0, own = 0;
    Axes likely = declared;
    for (const Axes& axes : all_axes()) {
        Products sum;
        for (const Turns& turns : all) sum += turns.products(axes);
        const double correlation = sum.correlation();
        if (axes == declared) own = correlation;
        if (correlation > best) best = correlation, likely = axes;
    }
    if (best < agrees || best - own < far) return true;
    for (const Turns& turns : all)
        findings.push_back(
            {Finding::Kind::refusal, turns.recording().info.id, "rate",
             fmt::format("of all sensors: expected the rates to cause the tilt that gravity shows, "
                         "found a correlation of {:.2f}, but {:.2f} if gx gy gz were {}: {}",
                         own, best, likely.name(),
                         likely == reversed ? "the sign seems to be reversed"
                                            : "axes seem to be exchanged or reversed")});
    return false;
}

void check_sense(const Turns& turns, std::vector<Finding>& findings) {
    constexpr double opposite = -0.7; // correlation; the shipped recordings have 0.9 to 0.99
    const double found = turns.products(declared).correlation();
    if (found > opposite) return;
    findings.push_back({Finding::Kind::refusal, turns.recording().info.id, "rate",
                        fmt::format("expected the rates to cause the tilt that gravity shows, "
                                    "found a correlation of {:.2f}: the sign seems to be reversed",
                                    found)});
}

} // namespace

void compare_turns(const std::vector<Recording>& recordings, const QualityControlLimits& limits,
                   std::vector<Finding>& findings) {
    std::vector<Turns> all;
    for (const Recording& r : recordings) {
        if (!accepted(findings, r.info.id)) continue;
        Inspection at{r, limits, findings};
        at.find_rest();
        if (Turns turns(at); turns.are_seen()) all.push_back(std::move(turns));
    }
    if (check_axes(all, findings))
        for (const Turns& turns : all) check_sense(turns, findings);
}

} // namespace bris
