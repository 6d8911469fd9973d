#include "scenarios/monitoring/site_model.hpp"

#include "engine/errors.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

namespace bris {

namespace {

constexpr double unknown = std::numeric_limits<double>::quiet_NaN();
// frozen on synthetic sites (tests/scenarios/monitoring/site_model_test.cpp):
constexpr double prior_serial = 0.4, prior_weight = 10; // correlation, and passages it counts for
constexpr double most_serial = 0.9;
constexpr double most_common = 8; // degrees of freedom of the pooled variance
constexpr double beyond = 0.1;    // of a number's range

double squared(double x) { return x * x; }

/// Variance of the mean of n successive values over that of one: correlations serial^lag.
double variance_of_mean(std::size_t n, double serial) {
    double sum = 1;
    for (std::size_t lag = 1; lag < n; ++lag)
        sum += 2 * (1 - static_cast<double>(lag) / static_cast<double>(n)) *
               std::pow(serial, static_cast<double>(lag));
    return sum / static_cast<double>(n);
}

/// Passages of one session in one condition: their rows, in order.
using Segment = std::vector<std::size_t>;

std::vector<Segment> segments_of(const std::vector<FeatureRow>& rows,
                                 const std::vector<std::size_t>& of_condition) {
    std::map<std::string, Segment> by_session;
    for (const std::size_t row : of_condition) by_session[rows[row].cause.session].push_back(row);
    std::vector<Segment> segments;
    // where most sessions have one passage, the scatter within them is not known: then all is one
    const std::size_t within = of_condition.size() - by_session.size();
    if (by_session.size() > 1 && (within < 3 || 3 * within < of_condition.size()))
        return {of_condition};
    for (auto& [session, segment] : by_session) segments.push_back(std::move(segment));
    return segments;
}

double mean_over(const std::vector<std::vector<double>>& values, const Segment& rows,
                 std::size_t column) {
    double sum = 0;
    for (const std::size_t row : rows) sum += values[row][column];
    return sum / static_cast<double>(rows.size());
}

/// Sums over all sensors by which correlation and scatter of sessions are estimated.
struct Pooled {
    double products = 0, bias = 0, weight = 0; // of successive residuals
    double passages = 0;                       // behind them, of a sensor on average
    double session_share = 0, session_weight = 0;
    std::set<std::string> sessions;

    void add_segment(const std::vector<std::vector<double>>& residuals, const Segment& rows,
                     std::size_t feature) {
        const auto n = static_cast<double>(rows.size());
        if (n < 3) return;
        const double mean = mean_over(residuals, rows, feature);
        double squares = 0, products_here = 0;
        for (std::size_t k = 0; k < rows.size(); ++k) {
            const double x = residuals[rows[k]][feature] - mean;
            squares += x * x;
            if (k > 0) products_here += x * (residuals[rows[k - 1]][feature] - mean);
        }
        if (!(squares > 0)) return;
        const double own = products_here / squares * n / (n - 1);
        products += (n - 1) * own;
        bias += (n - 1) * (1 + 3 * std::max(0.0, own)) / n; // Marriott and Pope 1954
        weight += n - 1;
    }
    double serial(double sensors, double features) const {
        if (!(weight > 0)) return prior_serial;
        // sensors of one site see the same trains: each further one counts for half
        const double counted = weight / (sensors * features) * (1 + 0.5 * (sensors - 1)),
                     found = (products + bias) / weight;
        return std::clamp((counted * found + prior_weight * prior_serial) /
                              (counted + prior_weight),
                          0.0, most_serial);
    }

    /// Variance between sessions over that within, by the mean squares of both.
    void add_sessions(const std::vector<std::vector<double>>& residuals,
                      const std::vector<Segment>& segments, std::size_t feature) {
        double n = 0, between = 0, within = 0, squares_of_sizes = 0;
        for (const Segment& rows : segments) {
            const double size = static_cast<double>(rows.size()),
                         mean = mean_over(residuals, rows, feature);
            n += size;
            squares_of_sizes += size * size;
            between += size * mean * mean;
            for (const std::size_t row : rows) within += squared(residuals[row][feature] - mean);
        }
        const double groups = static_cast<double>(segments.size()), freedom = n - groups;
        if (groups < 2 || freedom < 3 || !(within > 0)) return;
        const double size = (n - squares_of_sizes / n) / (groups - 1),
                     ratio = between / (groups - 1) / (within / freedom) * (freedom - 2) / freedom;
        session_share += (groups - 1) * (ratio - 1) / size;
        session_weight += groups - 1;
    }
    double between_sessions() const {
        return session_weight > 0 ? std::max(0.0, session_share / session_weight) : 0;
    }
};

} // namespace

double ExpectedFeature::deviation() const { return std::sqrt(variance * (1 + of_mean)); }

const SensorModel::Condition* SensorModel::condition(const PassageCause& cause) const {
    const auto found = std::ranges::find(conditions_, cause.condition, &Condition::name);
    return found == conditions_.end() ? nullptr : &*found;
}

std::string SensorModel::impossible_because(const PassageCause& cause) const {
    const Condition* of = condition(cause);
    const std::string where =
        cause.condition.empty() ? "" : fmt::format(" under the condition '{}'", cause.condition);
    if (of == nullptr || of->rows.size() < least_passages)
        return fmt::format("expected at least {} passages in the baseline{}, found {}",
                           least_passages, where, of == nullptr ? 0 : of->rows.size());
    if (of->scatter.empty()) return "the baseline has too few passages for the numbers stated";
    for (const Number& number : numbers_) {
        const auto found = cause.numbers.find(number.name);
        if (found == cause.numbers.end())
            return fmt::format("{}: expected a number as in the baseline, found none", number.name);
        const double margin = beyond * (number.high - number.low);
        if (!(found->second >= number.low - margin && found->second <= number.high + margin))
            return fmt::format("{}: expected {:g} to {:g} as in the baseline, found {:g}",
                               number.name, number.low, number.high, found->second);
    }
    return {};
}

std::vector<ExpectedFeature> SensorModel::expected(const PassageCause& cause) const {
    require(impossible_because(cause).empty(), impossible_because(cause));
    const Condition& of = *condition(cause);
    const auto c = static_cast<std::size_t>(&of - conditions_.data());
    Vector away = Vector::Zero(static_cast<Eigen::Index>(numbers_.size()));
    for (std::size_t q = 0; q < numbers_.size(); ++q)
        away[static_cast<Eigen::Index>(q)] =
            cause.numbers.at(numbers_[q].name) - numbers_[q].means[c];
    return expected(of, away);
}

std::vector<ExpectedFeature> SensorModel::typical() const {
    const auto most = std::ranges::max_element(
        conditions_, {}, [](const Condition& c) { return c.scatter.empty() ? 0 : c.rows.size(); });
    if (most == conditions_.end() || most->scatter.empty()) return {};
    return expected(*most, Vector::Zero(static_cast<Eigen::Index>(numbers_.size())));
}

std::vector<ExpectedFeature> SensorModel::expected(const Condition& of, const Vector& away) const {
    const double leverage =
        numbers_.empty() ? 0 : away.dot(inverse_ * away) * (1 + serial_) / (1 - serial_);
    std::vector<ExpectedFeature> all;
    for (std::size_t f = 0; f < of.means.size(); ++f) {
        ExpectedFeature& e = all.emplace_back();
        if (!std::isfinite(of.means[f]) || !(of.scatter[f].variance > 0)) continue;
        const double slope =
            numbers_.empty() ? 0 : slopes_.col(static_cast<Eigen::Index>(f)).dot(away);
        e = {of.means[f] + slope, of.scatter[f].variance, of.of_mean + leverage,
             of.scatter[f].degrees};
    }
    return all;
}

std::vector<double> SensorModel::residuals(std::size_t feature) const {
    std::vector<double> all;
    for (const Condition& c : conditions_)
        for (const std::size_t row : c.rows)
            if (!c.scatter.empty() && c.scatter[feature].variance > 0)
                all.push_back(residuals_[row][feature] / std::sqrt(c.scatter[feature].variance));
    return all;
}

/// Makes the models of all sensors, in steps that need what all of them have found before.
class SiteModel {
public:
    SiteModel(const std::vector<std::vector<FeatureRow>>& rows,
              const std::vector<unsigned>& families)
        : rows_(rows), families_(families), models_(rows.size()) {}

    std::vector<SensorModel> run() {
        for (std::size_t s = 0; s < rows_.size(); ++s) {
            find_conditions(s);
            find_numbers(s);
            fit(s);
        }
        for (std::size_t s = 0; s < rows_.size(); ++s) pool(s);
        double sensors = 0;
        for (const auto& rows : rows_) sensors += !rows.empty();
        serial_ = pooled_.serial(std::max(1.0, sensors), static_cast<double>(families_.size()));
        between_ = pooled_.between_sessions();
        for (std::size_t s = 0; s < rows_.size(); ++s) find_scatter(s);
        pool_scatter();
        return std::move(models_);
    }

private:
    void find_conditions(std::size_t s) {
        std::map<std::string, std::vector<std::size_t>> by_name;
        std::set<std::string> sessions;
        for (std::size_t k = 0; k < rows_[s].size(); ++k) {
            by_name[rows_[s][k].cause.condition].push_back(k);
            sessions.insert(rows_[s][k].cause.session);
        }
        pooled_.sessions.insert(sessions.begin(), sessions.end());
        models_[s].passages_ = rows_[s].size();
        models_[s].sessions_ = sessions.size();
        for (auto& [name, rows] : by_name)
            models_[s].conditions_.push_back({name, std::move(rows), 0, {}, {}});
    }

    /// Numbers that all passages state and that vary within conditions.
    void find_numbers(std::size_t s) {
        const auto& rows = rows_[s];
        if (rows.empty()) return;
        for (const auto& [name, first] : rows.front().cause.numbers) {
            SensorModel::Number number{name, first, first, {}};
            bool is_stated = true;
            double squares = 0;
            for (const FeatureRow& row : rows) {
                const auto found = row.cause.numbers.find(name);
                is_stated = is_stated && found != row.cause.numbers.end();
                if (!is_stated) break;
                number.low = std::min(number.low, found->second);
                number.high = std::max(number.high, found->second);
            }
            if (!is_stated) continue;
            for (const auto& c : models_[s].conditions_) {
                double sum = 0;
                for (const std::size_t row : c.rows) sum += rows[row].cause.numbers.at(name);
                number.means.push_back(sum / static_cast<double>(c.rows.size()));
                for (const std::size_t row : c.rows)
                    squares += std::pow(rows[row].cause.numbers.at(name) - number.means.back(), 2);
            }
            if (squares > 1e-12 * std::pow(number.high, 2)) models_[s].numbers_.push_back(number);
        }
    }

    /// Means, slopes and residuals by least squares.
    void fit(std::size_t s) {
        SensorModel& m = models_[s];
        const auto count = static_cast<Eigen::Index>(m.numbers_.size()),
                   features = static_cast<Eigen::Index>(families_.size());
        Matrix squares = Matrix::Zero(count, count), products = Matrix::Zero(count, features);
        m.residuals_.assign(rows_[s].size(), std::vector<double>(families_.size(), unknown));
        for (std::size_t c = 0; c < m.conditions_.size(); ++c)
            for (std::size_t f = 0; f < families_.size(); ++f) {
                double sum = 0;
                for (const std::size_t row : m.conditions_[c].rows) sum += rows_[s][row].values[f];
                m.conditions_[c].means.push_back(sum /
                                                 static_cast<double>(m.conditions_[c].rows.size()));
            }
        visit(s, [&](std::size_t c, std::size_t row, const Vector& away) {
            squares += away * away.transpose();
            for (std::size_t f = 0; f < families_.size(); ++f)
                if (std::isfinite(m.conditions_[c].means[f]))
                    products.col(static_cast<Eigen::Index>(f)) +=
                        away * (rows_[s][row].values[f] - m.conditions_[c].means[f]);
        });
        if (count > 0) {
            m.inverse_ = squares.completeOrthogonalDecomposition().pseudoInverse();
            m.slopes_ = m.inverse_ * products;
        }
        visit(s, [&](std::size_t c, std::size_t row, const Vector& away) {
            for (std::size_t f = 0; f < families_.size(); ++f)
                m.residuals_[row][f] =
                    rows_[s][row].values[f] - m.conditions_[c].means[f] -
                    (count > 0 ? away.dot(m.slopes_.col(static_cast<Eigen::Index>(f))) : 0.0);
        });
    }

    /// Calls take(condition, row, numbers less their means) for each passage of a sensor.
    void visit(std::size_t s, auto&& take) const {
        const SensorModel& m = models_[s];
        for (std::size_t c = 0; c < m.conditions_.size(); ++c)
            for (const std::size_t row : m.conditions_[c].rows) {
                Vector away(static_cast<Eigen::Index>(m.numbers_.size()));
                for (std::size_t q = 0; q < m.numbers_.size(); ++q)
                    away[static_cast<Eigen::Index>(q)] =
                        rows_[s][row].cause.numbers.at(m.numbers_[q].name) - m.numbers_[q].means[c];
                take(c, row, away);
            }
    }

    void pool(std::size_t s) {
        const SensorModel& m = models_[s];
        for (const auto& c : m.conditions_) {
            const auto segments = segments_of(rows_[s], c.rows);
            for (std::size_t f = 0; f < families_.size(); ++f) {
                if (!std::isfinite(c.means[f])) continue;
                for (const Segment& rows : segments) pooled_.add_segment(m.residuals_, rows, f);
                pooled_.add_sessions(m.residuals_, segments, f);
            }
        }
    }

    /// The variance within sessions, corrected for the correlation, of each feature.
    void find_scatter(std::size_t s) {
        SensorModel& m = models_[s];
        m.serial_ = serial_;
        m.between_ = between_;
        double freedom = 0;
        for (const auto& c : m.conditions_) freedom += static_cast<double>(c.rows.size()) - 1;
        const double left = freedom - static_cast<double>(m.numbers_.size());
        for (auto& c : m.conditions_) {
            if (c.rows.size() < least_passages || !(left > 0)) continue;
            const auto segments = segments_of(rows_[s], c.rows);
            const auto n = static_cast<double>(c.rows.size());
            double expected = 0, degrees = 0;
            c.of_mean = 0;
            for (const Segment& rows : segments) {
                const auto size = static_cast<double>(rows.size());
                const double of_mean = variance_of_mean(rows.size(), serial_);
                expected += size * (1 - of_mean);
                degrees += size - 1;
                c.of_mean += size / n * size / n * (of_mean + between_) / (1 + between_);
            }
            if (!(degrees > 0)) continue;
            degrees *= left / freedom * (1 - serial_ * serial_) / (1 + serial_ * serial_);
            for (std::size_t f = 0; f < families_.size(); ++f) {
                double squares = 0;
                for (const Segment& rows : segments) {
                    const double mean = mean_over(m.residuals_, rows, f);
                    for (const std::size_t row : rows)
                        squares += squared(m.residuals_[row][f] - mean);
                }
                c.scatter.push_back(
                    {std::isfinite(squares) ? squares / expected * freedom / left : 0, degrees});
            }
        }
    }

    /// Pools within families, and adds the scatter between sessions.
    void pool_scatter() {
        const unsigned last = *std::ranges::max_element(families_);
        for (unsigned family = 0; family <= last; ++family) {
            std::vector<EstimatedVariance*> places;
            std::vector<EstimatedVariance> estimated;
            for (SensorModel& m : models_)
                for (auto& c : m.conditions_)
                    for (std::size_t f = 0; f < c.scatter.size(); ++f)
                        if (families_[f] == family && c.scatter[f].variance > 0) {
                            places.push_back(&c.scatter[f]);
                            estimated.push_back(c.scatter[f]);
                        }
            estimated = pooled_variances(std::move(estimated), most_common);
            const double sessions = std::max(1.0, static_cast<double>(pooled_.sessions.size()) - 1);
            for (std::size_t k = 0; k < places.size(); ++k) {
                const auto& [variance, degrees] = estimated[k];
                // Satterthwaite 1946
                *places[k] = {variance * (1 + between_),
                              std::pow(1 + between_, 2) /
                                  (1 / degrees + between_ * between_ / sessions)};
            }
        }
    }

    const std::vector<std::vector<FeatureRow>>& rows_;
    const std::vector<unsigned>& families_;
    std::vector<SensorModel> models_;
    Pooled pooled_;
    double serial_ = 0, between_ = 0;
};

std::vector<SensorModel> site_models(const std::vector<std::vector<FeatureRow>>& rows,
                                     const std::vector<unsigned>& families) {
    return SiteModel(rows, families).run();
}

} // namespace bris
