#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

namespace bris {

/// A computed number and its exact value.
struct Check {
    enum class Rule {
        relative, ///< |found - expected| <= tolerance |expected|
        absolute, ///< |found - expected| <= tolerance
        at_most,  ///< found <= expected + tolerance
        at_least  ///< found >= expected - tolerance
    };
    std::string group, quantity, unit;
    double expected = 0, found = 0;
    double tolerance = 0;
    Rule rule = Rule::relative;
    /// Smallest error by the same rule that other codes report. NaN: none is known.
    double published = std::numeric_limits<double>::quiet_NaN();

    double error() const {
        const double difference = found - expected;
        if (rule == Rule::at_most) return std::max(difference, 0.0);
        if (rule == Rule::at_least) return std::max(-difference, 0.0);
        return std::abs(difference) / (rule == Rule::relative ? std::abs(expected) : 1);
    }
    bool passes() const { return !std::isnan(found) && error() <= tolerance; }
};

/// The checks of one group.
class Checks {
public:
    explicit Checks(std::string group) : group_(std::move(group)) {}

    static constexpr double none = std::numeric_limits<double>::quiet_NaN();
    void relative(std::string quantity, std::string unit, double expected, double found,
                  double tolerance, double published = none) {
        add(std::move(quantity), std::move(unit), expected, found, tolerance, Check::Rule::relative,
            published);
    }
    void absolute(std::string quantity, std::string unit, double expected, double found,
                  double tolerance, double published = none) {
        add(std::move(quantity), std::move(unit), expected, found, tolerance, Check::Rule::absolute,
            published);
    }
    void at_most(std::string quantity, std::string unit, double limit, double found,
                 double tolerance = 0, double published = none) {
        add(std::move(quantity), std::move(unit), limit, found, tolerance, Check::Rule::at_most,
            published);
    }
    void at_least(std::string quantity, std::string unit, double limit, double found,
                  double tolerance = 0) {
        add(std::move(quantity), std::move(unit), limit, found, tolerance, Check::Rule::at_least,
            none);
    }
    const std::vector<Check>& list() const { return list_; }

private:
    void add(std::string quantity, std::string unit, double expected, double found,
             double tolerance, Check::Rule rule, double published) {
        list_.push_back({group_, std::move(quantity), std::move(unit), expected, found, tolerance,
                         rule, published});
    }
    std::string group_;
    std::vector<Check> list_;
};

} // namespace bris
