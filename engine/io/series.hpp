#pragma once

#include "engine/archive.hpp"
#include "engine/io/plot.hpp"
#include "engine/io/run_file.hpp"

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

namespace bris {

/// Samples of a run in rows of numbers, written as a track of the run file and as a CSV file. They
/// can be kept in a checkpoint beside the State of the world, under "series/NAME/".
class Series {
public:
    std::size_t rows() const { return values_.front().size(); }

    void save(Archive& archive) const;
    void load(const Archive& archive); ///< throws InputError if it is missing

    void write_csv(const std::filesystem::path& path) const;
    /// Writes all rows as /tracks/NAME. At most once per file.
    void write_track(RunFile& file) const;

protected:
    explicit Series(std::string name) : name_(std::move(name)) {}
    /// Name and unit of a column at an axis, as "kinetic energy (J)".
    static std::string axis_label(const RunFile::Column& column);

    std::string name_;
    std::vector<RunFile::Column> columns_;
    std::vector<std::vector<double>> values_; // per column
};

/// A column of a series: a number of its samples.
template <class Sample>
struct Sampled {
    double Sample::*value;
    const char *name, *unit;
};

/// A series of samples of one type: a struct of numbers in SI units, whose function `columns()`
/// returns an array of Sampled. Each number of the struct is listed there, in its order.
template <class Sample>
class SeriesOf : public Series {
public:
    explicit SeriesOf(std::string name) : Series(std::move(name)) {
        static_assert(sizeof(Sample) == columns.size() * sizeof(double) && all_differ(),
                      "a number has no column, or two");
        for (const auto& c : columns) columns_.push_back({c.name, c.unit});
        values_.resize(columns.size());
    }

    void add(const Sample& sample) {
        for (std::size_t k = 0; k < columns.size(); ++k)
            values_[k].push_back(sample.*columns[k].value);
    }

    Sample at(std::size_t row) const {
        Sample sample;
        for (std::size_t k = 0; k < columns.size(); ++k)
            sample.*columns[k].value = values_[k].at(row);
        return sample;
    }

    const std::vector<double>& operator[](double Sample::*number) const {
        return values_[place_of(number)];
    }

    /// A column over the first one, which is the time as a rule.
    Curve curve(double Sample::*number, const std::string& label = "") const {
        return {.label = label, .x = values_.front(), .y = (*this)[number]};
    }
    /// The same as a panel, whose axes are labelled with the names and units of the columns.
    Plot plot(double Sample::*number, const std::string& title = "") const {
        return {.title = title,
                .x_label = axis_label(columns_.front()),
                .y_label = axis_label(columns_[place_of(number)]),
                .curves = {curve(number)}};
    }

private:
    static constexpr auto columns = Sample::columns();

    static constexpr bool all_differ() {
        for (std::size_t k = 1; k < columns.size(); ++k)
            if (place_of(columns[k].value) != k) return false;
        return true;
    }
    static constexpr std::size_t place_of(double Sample::*number) {
        std::size_t k = 0;
        while (columns[k].value != number) ++k;
        return k;
    }
};

} // namespace bris
