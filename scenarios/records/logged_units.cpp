#include "scenarios/records/logged_units.hpp"

#include "engine/errors.hpp"
#include "engine/signal/median.hpp"
#include "scenarios/sensors/channels.hpp"
#include "scenarios/sensors/unit_words.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

namespace bris {

namespace {

constexpr double least_gravity = 0.7, most_gravity = 1.4; ///< over g, of a rock that may shake
constexpr double no_gravity = 0.3;

bool is_gravity(double force) {
    return force > least_gravity * standard_gravity && force < most_gravity * standard_gravity;
}

/// A maker whose files do not state their units.
struct Maker {
    const char* name;
    const char* force_unit;
    const char* rate_unit;
};

std::optional<Maker> maker_of(const LoggerTable& table) {
    const auto has_title = [&](const char* title) {
        return std::ranges::count(table.titles, title) > 0;
    };
    const auto says = [&](const char* word) {
        return std::ranges::any_of(table.above, [&](const std::string& line) {
            return line.find(word) != std::string::npos;
        });
    };
    if (has_title("seconds_elapsed")) return Maker{"Sensor Logger", "m/s2", "rad/s"};
    if (has_title("PacketCounter") && says("General information"))
        return Maker{"Xsens MT Manager", "m/s2", "rad/s"};
    if (has_title("PacketCounter") && says("DeviceTag")) return Maker{"Xsens DOT", "m/s2", "deg/s"};
    return {};
}

class VectorScale {
public:
    VectorScale(const LoggedVector& vector, const LoggerTable& table,
                const std::vector<SampledColumn>& sample, const std::vector<double>& sensor,
                std::vector<std::string>& notes)
        : vector_(vector), table_(table), sample_(sample), sensor_(sensor), notes_(notes),
          units_(channel_of(vector.is_rate ? Channel::Series(&Recording::rate)
                                           : Channel::Series(&Recording::force))
                     .column_units()) {}

    ScaledVector make() {
        ScaledVector result;
        std::string unit = stated_unit();
        const bool is_stated = !unit.empty();
        if (!is_stated) unit = unit_of_maker();
        if (unit.empty() && !vector_.is_rate) unit = unit_by_gravity();
        if (unit.empty()) {
            notes_.push_back(fmt::format("Left out: {}, angular rates whose unit is not stated; "
                                         "give it with --axes \"{}={} deg/s\".",
                                         described(), name_of(first_axis()),
                                         vector_.axes[first_axis()]->index + 1));
            result.is_known = false;
            return result;
        }
        const double scale = std::ranges::find(units_, unit, &ColumnUnit::name)->scale;
        if (!vector_.is_rate) result.has_gravity = check_gravity(scale, unit, is_stated);
        for (std::size_t k = 0; k < 3; ++k)
            if (const auto& axis = vector_.axes[k])
                result.axes[k] = {axis->index, scale * axis->sign};
        return result;
    }

private:
    std::size_t first_axis() const {
        std::size_t first = 0;
        while (!vector_.axes[first]) ++first;
        return first;
    }
    std::string name_of(std::size_t axis) const {
        return std::string(vector_.is_rate ? "g" : "a") + "xyz"[axis];
    }
    std::string described() const {
        std::vector<std::string> all;
        for (const auto& axis : vector_.axes)
            if (axis) all.push_back(table_.described(axis->index));
        return listed(all);
    }
    bool is_of_user() const {
        return std::ranges::any_of(vector_.axes,
                                   [](const auto& axis) { return axis && axis->is_of_user; });
    }

    /// That of the user, or of all titles that state one.
    std::string stated_unit() const {
        std::string unit;
        for (const auto& axis : vector_.axes) {
            if (!axis || axis->unit_word.empty() || (is_of_user() && !axis->is_of_user)) continue;
            const std::string found = unit_named(axis->unit_word, units_);
            require(!found.empty(),
                    fmt::format("{}: {}: the unit \"{}\" is not known; give one of {} with --axes "
                                "\"{}={} {}\"",
                                table_.path.string(), table_.described(axis->index),
                                axis->unit_word, names_of_units(), name_of(first_axis()),
                                axis->index + 1, units_.front().name));
            require(unit.empty() || unit == found,
                    fmt::format("{}: {}: expected one unit for all axes, found {} and {}",
                                table_.path.string(), described(), unit, found));
            unit = found;
        }
        return unit;
    }

    std::string names_of_units() const {
        std::vector<std::string> names;
        for (const ColumnUnit& unit : units_) names.push_back(unit.name);
        return listed(names);
    }

    std::string unit_of_maker() {
        const auto maker = maker_of(table_);
        if (!maker) return {};
        const std::string unit = vector_.is_rate ? maker->rate_unit : maker->force_unit;
        notes_.push_back(fmt::format("The unit of {} is not stated; it is {}, as {} writes it.",
                                     described(), unit, maker->name));
        return unit;
    }

    /// Magnitude of the median of the first samples, in the unit of the file: over all sensors, the
    /// median. Vibration about zero has none.
    double median_at_rest() const {
        std::map<double, std::vector<Vec3>> by_sensor;
        for (std::size_t row = 0; row < sensor_.size(); ++row) {
            Vec3 v = Vec3::Zero();
            for (std::size_t k = 0; k < 3; ++k)
                if (const auto& axis = vector_.axes[k])
                    v[static_cast<Eigen::Index>(k)] = sample_[axis->index].numbers[row];
            if (v.allFinite() && std::isfinite(sensor_[row])) by_sensor[sensor_[row]].push_back(v);
        }
        std::vector<double> magnitudes;
        for (const auto& [sensor, values] : by_sensor) magnitudes.push_back(median(values).norm());
        return magnitudes.empty() ? 0 : median(std::move(magnitudes));
    }

    std::string unit_by_gravity() {
        const double found = median_at_rest();
        for (const ColumnUnit& unit : units_) {
            if (vector_.is_linear || !is_gravity(unit.scale * found)) continue;
            notes_.push_back(fmt::format("The unit of {} is not stated; {} is assumed, because the "
                                         "median of {:.3g} is then gravity.",
                                         described(), unit.name, found));
            return unit.name;
        }
        throw InputError(fmt::format(
            "{}: {}: expected a unit of the accelerations, found none that is stated, and their "
            "median of {:.3g} is gravity in none; give it with --axes \"{}={} m/s2\"",
            table_.path.string(), described(), found, name_of(first_axis()),
            vector_.axes[first_axis()]->index + 1));
    }

    /// Whether the accelerations contain gravity.
    bool check_gravity(double scale, const std::string& unit, bool is_stated) {
        if (vector_.is_linear) return false;
        const double found = median_at_rest(), force = scale * found;
        if (is_gravity(force)) return true;
        if (is_stated && !is_of_user())
            for (const ColumnUnit& other : units_)
                require(!is_gravity(other.scale * found),
                        fmt::format("{}: {}: expected gravity, found a median of {:.3g} {}, which "
                                    "is gravity in {}; give the right unit with --axes \"{}={} "
                                    "{}\"",
                                    table_.path.string(), described(), found, unit, other.name,
                                    name_of(first_axis()), vector_.axes[first_axis()]->index + 1,
                                    other.name));
        if (force < no_gravity * standard_gravity) return false;
        notes_.push_back(fmt::format("Check the unit of {}: the median of the first samples is "
                                     "{:.3g} m/s2, that of gravity is 9.81.",
                                     described(), force));
        return true;
    }

    const LoggedVector& vector_;
    const LoggerTable& table_;
    const std::vector<SampledColumn>& sample_;
    const std::vector<double>& sensor_;
    std::vector<std::string>& notes_;
    std::vector<ColumnUnit> units_;
};

} // namespace

ScaledVector scaled(const LoggedVector& vector, const LoggerTable& table,
                    const std::vector<SampledColumn>& sample, const std::vector<double>& sensor,
                    std::vector<std::string>& notes) {
    return VectorScale(vector, table, sample, sensor, notes).make();
}

} // namespace bris
