#include "scenarios/records/logger_sample.hpp"

#include "scenarios/records/date_text.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>

namespace bris {

namespace {

constexpr double nothing = std::numeric_limits<double>::quiet_NaN();
constexpr std::size_t most_rows = 1000, most_cells = 500'000, most_texts = 200;

class Sampler {
public:
    explicit Sampler(const LoggerTable& table)
        : table_(table), columns_(table.width), texts_(table.width) {}

    std::vector<SampledColumn> make() {
        const std::size_t rows = std::clamp<std::size_t>(most_cells / table_.width, 20, most_rows);
        table_.each_row([&](std::size_t, const std::vector<std::string_view>& cells) {
            if (cells.size() != table_.width) return true;
            for (std::size_t c = 0; c < cells.size(); ++c) add(c, cells[c]);
            return ++rows_ < rows;
        });
        const auto all = static_cast<double>(std::max<std::size_t>(rows_, 1));
        for (std::size_t c = 0; c < columns_.size(); ++c) {
            SampledColumn& column = columns_[c];
            for (double* share :
                 {&column.share_of_numbers, &column.share_of_dates, &column.share_of_days,
                  &column.share_of_times, &column.share_of_names})
                *share /= all;
            column.texts = texts_[c].size();
        }
        return std::move(columns_);
    }

private:
    void add(std::size_t c, std::string_view cell) {
        SampledColumn& column = columns_[c];
        const auto number = table_.number(cell);
        column.numbers.push_back(number.value_or(nothing));
        column.share_of_numbers += std::isfinite(column.numbers.back()) ? 1 : 0;
        const auto date = number ? std::nullopt : date_in(cell);
        column.dates.push_back(date ? date->seconds : nothing);
        if (date) {
            (date->has_date && date->has_time ? column.share_of_dates
             : date->has_date                 ? column.share_of_days
                                              : column.share_of_times) += 1;
        } else if (!number) {
            column.share_of_names += 1;
            if (texts_[c].size() < most_texts) texts_[c].insert(cell);
        }
    }

    const LoggerTable& table_;
    std::vector<SampledColumn> columns_;
    std::vector<std::set<std::string_view>> texts_;
    std::size_t rows_ = 0;
};

} // namespace

std::vector<SampledColumn> sample_of(const LoggerTable& table) { return Sampler(table).make(); }

double share_that_advances(const std::vector<double>& values, const std::vector<double>& sensor) {
    std::map<double, double> last;
    double steps = 0, upwards = 0;
    for (std::size_t k = 0; k < values.size(); ++k) {
        if (!std::isfinite(values[k]) || !std::isfinite(sensor[k])) continue;
        const auto [before, is_first] = last.try_emplace(sensor[k], values[k]);
        if (is_first) continue;
        steps += 1;
        upwards += values[k] > before->second ? 1 : 0;
        before->second = values[k];
    }
    return steps > 0 ? upwards / steps : 0;
}

} // namespace bris
