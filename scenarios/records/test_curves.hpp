#pragma once

#include "engine/archive.hpp"
#include "scenarios/records/quantity.hpp"

#include <cstddef>
#include <deque>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace bris {

/// The curves of a test, whether measured, simulated or predicted: a column of numbers in SI units
/// for each quantity, in rows by stage or time. NaN: not known there. A test may unload, and files
/// step back, so that strain is a column like others (MonotonicStage finds rows by it).
class TestCurves {
public:
    struct Column {
        const Quantity* of;
        std::size_t part; ///< of a quantity with several, as the rings from below
        std::vector<double> values;
        std::vector<double> low = {}, high = {}; ///< 90 % band of a prediction; empty: none
    };
    /// Access to one row.
    struct Row {
        TestCurves& curves;
        std::size_t row;
        double& operator[](const Quantity& q) const { return part(q, 0); }
        double& part(const Quantity& q, std::size_t k) const {
            return curves.column(q, k).values[row];
        }
    };

    const std::deque<Column>& columns() const { return columns_; }
    std::size_t size() const { return rows_; } ///< number of rows
    bool empty() const { return rows_ == 0; }
    bool has(const Quantity& quantity) const { return parts(quantity) > 0; }
    /// Number of columns of a quantity.
    std::size_t parts(const Quantity& quantity) const;

    /// The column of a quantity. Throws std::out_of_range if there is none.
    const Column& column(const Quantity& quantity, std::size_t part = 0) const;
    /// The same; adds it if there is none.
    Column& column(const Quantity& quantity, std::size_t part = 0);
    const std::vector<double>& operator[](const Quantity& q) const { return column(q).values; }
    std::vector<double>& operator[](const Quantity& q) { return column(q).values; }
    /// Radii of a ring, counted from 0.
    const std::vector<double>& ring(std::size_t r) const {
        return column(quantity::ring_radius, r).values;
    }
    std::size_t rings() const { return parts(quantity::ring_radius); }

    Row add_row(); ///< of NaN
    void add_row_of(const TestCurves& other, std::size_t row);
    TestCurves rows_where(auto&& keep) const; ///< the rows k for which keep(k)
    TestCurves up_to(double strain) const;    ///< the rows whose axial strain is not above

private:
    const Column* find(const Quantity& quantity, std::size_t part) const;

    // their addresses stay when others are added; every test has these three, if only as NaN
    std::deque<Column> columns_{{&quantity::axial_strain, 0, {}},
                                {&quantity::deviatoric_stress, 0, {}},
                                {&quantity::volumetric_strain, 0, {}}};
    std::size_t rows_ = 0;
};

/// Curves that were measured. A misfit takes them first and those of a model second.
struct MeasuredCurves : TestCurves {
    MeasuredCurves() = default;
    explicit MeasuredCurves(TestCurves curves) : TestCurves(std::move(curves)) {}
};

/// Curves whose axial strain only grows from row to row, so that their rows can be found by it. It
/// refers to the curves.
class MonotonicStage {
public:
    /// Throws InputError if the strain steps back.
    explicit MonotonicStage(const TestCurves& curves);

    /// The row nearest to a strain; nothing if there is none within `tolerance`.
    std::optional<std::size_t> nearest(double strain, double tolerance) const;
    /// A quantity between the neighbouring rows in which it is known; NaN where these are more than
    /// `gap` apart.
    double value_at(const Quantity& quantity, double strain, double gap) const;

private:
    const TestCurves& curves_;
    const std::vector<double>& strain_;
};

/// Stores the quantities of stages, and the rings, in an archive under `path`, and loads them.
void save_curves(Archive& archive, const std::string& path, const TestCurves& curves);
TestCurves load_curves(const Archive& archive, const std::string& path);

/// A column of a file, by the name of its quantity or another one.
struct WrittenColumn {
    const Quantity* of;
    const char* name = nullptr;
    WrittenColumn(const Quantity* q, const char* written_as = nullptr) : of(q), name(written_as) {}
};
/// Writes columns, with their bands if they have any, and the rings as CSV. Throws OutputError.
void write_curves(const std::filesystem::path& csv, const TestCurves& curves,
                  const std::vector<WrittenColumn>& columns, const std::string& comment,
                  int digits);

/// Name of the folder for the test at this pressure (Pa), such as 55kPa.
std::string folder_of(double pressure);
/// A confining pressure (Pa) in the label of a curve, as "55 kPa".
std::string label_of(double pressure);

TestCurves TestCurves::rows_where(auto&& keep) const {
    TestCurves some;
    for (const Column& c : columns_) some.column(*c.of, c.part);
    for (std::size_t k = 0; k < rows_; ++k)
        if (keep(k)) some.add_row_of(*this, k);
    return some;
}

} // namespace bris
