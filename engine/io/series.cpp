#include "engine/io/series.hpp"

#include "engine/errors.hpp"
#include "engine/io/csv.hpp"
#include "engine/options.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>

namespace bris {

Series::Series(std::string name, std::vector<RunFile::Column> columns)
    : name_(std::move(name)), columns_(std::move(columns)), values_(columns_.size()) {}

void Series::add(std::initializer_list<double> row) {
    if (row.size() != columns_.size())
        throw std::logic_error(fmt::format("series {}: {} numbers for {} columns", name_,
                                           row.size(), columns_.size()));
    std::size_t k = 0;
    for (const double value : row) values_[k++].push_back(value);
}

std::size_t Series::index_of(const std::string& name) const {
    const auto found = std::ranges::find(columns_, name, &RunFile::Column::name);
    if (found == columns_.end())
        throw std::logic_error(fmt::format("series {} has no column {}", name_, name));
    return static_cast<std::size_t>(found - columns_.begin());
}

const std::vector<double>& Series::column(const std::string& name) const {
    return values_[index_of(name)];
}

Curve Series::curve(const std::string& column, const std::string& label) const {
    return {.label = label, .x = values_.front(), .y = this->column(column)};
}

Plot Series::plot(const std::string& column, const std::string& title) const {
    const auto axis = [](const RunFile::Column& c) {
        std::string text = c.name;
        std::ranges::replace(text, '_', ' ');
        return c.unit.empty() ? text : fmt::format("{} ({})", text, c.unit);
    };
    return {.title = title,
            .x_label = axis(columns_.front()),
            .y_label = axis(columns_[index_of(column)]),
            .curves = {curve(column)}};
}

void Series::save(Archive& archive) const {
    for (std::size_t k = 0; k < columns_.size(); ++k)
        archive.put("series/" + name_ + "/" + columns_[k].name,
                    std::span<const double>(values_[k]));
}

void Series::load(const Archive& archive) {
    for (std::size_t k = 0; k < columns_.size(); ++k) {
        values_[k] = archive.get<double>("series/" + name_ + "/" + columns_[k].name);
        require(
            values_[k].size() == values_[0].size(),
            fmt::format("checkpoint: series {}: expected columns of one length, found {} and {}",
                        name_, values_[0].size(), values_[k].size()));
    }
}

void Series::write_csv(const std::filesystem::path& path) const {
    std::vector<std::string> names;
    for (const auto& column : columns_) names.push_back(key_with_unit(column.name, column.unit));
    std::vector<std::vector<double>> table(rows());
    for (std::size_t r = 0; r < table.size(); ++r)
        for (const auto& values : values_) table[r].push_back(values[r]);
    bris::write_csv(path, names, table);
}

void Series::write_track(RunFile& file) const {
    file.add_track(name_, columns_);
    std::vector<double> row(columns_.size());
    for (std::size_t r = 0; r < rows(); ++r) {
        for (std::size_t k = 0; k < row.size(); ++k) row[k] = values_[k][r];
        file.add_row(name_, row);
    }
    file.flush();
}

} // namespace bris
