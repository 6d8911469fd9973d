#pragma once

#include "engine/archive.hpp"
#include "engine/io/plot.hpp"
#include "engine/io/run_file.hpp"

#include <filesystem>
#include <initializer_list>
#include <string>
#include <vector>

namespace bris {

/// A time series sampled during a run, written as a track of the run file, as a CSV file and as
/// curves of a plot. It can be kept in a checkpoint beside the State of the world, under
/// "series/NAME/".
class Series {
public:
    Series(std::string name, std::vector<RunFile::Column> columns);

    void add(std::initializer_list<double> row); ///< one number per column
    std::size_t rows() const { return values_.front().size(); }
    const std::vector<double>& column(const std::string& name) const;

    /// A column over the first one, which is the time as a rule.
    Curve curve(const std::string& column, const std::string& label = "") const;
    /// The same as a panel, whose axes are labelled with the names and units of the columns.
    Plot plot(const std::string& column, const std::string& title = "") const;

    void save(Archive& archive) const;
    void load(const Archive& archive); ///< throws InputError if it is missing

    void write_csv(const std::filesystem::path& path) const;
    /// Writes all rows as /tracks/NAME. At most once per file.
    void write_track(RunFile& file) const;

private:
    std::size_t index_of(const std::string& name) const;
    std::string name_;
    std::vector<RunFile::Column> columns_;
    std::vector<std::vector<double>> values_; // per column
};

} // namespace bris
