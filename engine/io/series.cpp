#include "engine/io/series.hpp"

#include "engine/errors.hpp"
#include "engine/io/csv.hpp"
#include "engine/options.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace bris {

std::string Series::axis_label(const RunFile::Column& column) {
    std::string text = column.name;
    std::ranges::replace(text, '_', ' ');
    return column.unit.empty() ? text : fmt::format("{} ({})", text, column.unit);
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
