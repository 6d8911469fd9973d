#include "engine/io/series.hpp"

#include "engine/errors.hpp"
#include "engine/io/csv.hpp"
#include "engine/options.hpp"

#include <fmt/format.h>

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

const std::vector<double>& Series::column(const std::string& name) const {
    for (std::size_t k = 0; k < columns_.size(); ++k)
        if (columns_[k].name == name) return values_[k];
    throw std::logic_error(fmt::format("series {} has no column {}", name_, name));
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
