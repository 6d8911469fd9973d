#include "scenarios/records/test_curves.hpp"

#include "engine/errors.hpp"
#include "engine/io/csv.hpp"
#include "engine/options.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <span>
#include <stdexcept>

namespace bris {

std::string title_of(const Quantity& q, std::size_t part, const char* end) {
    return key_with_unit(fmt::format(fmt::runtime(q.name), part + 1) + end, q.unit);
}

const TestCurves::Column* TestCurves::find(const Quantity& quantity, std::size_t part) const {
    const auto found = std::ranges::find_if(
        columns_, [&](const Column& c) { return c.of == &quantity && c.part == part; });
    return found == columns_.end() ? nullptr : &*found;
}

std::size_t TestCurves::parts(const Quantity& quantity) const {
    return static_cast<std::size_t>(std::ranges::count(columns_, &quantity, &Column::of));
}

const TestCurves::Column& TestCurves::column(const Quantity& quantity, std::size_t part) const {
    if (const Column* found = find(quantity, part)) return *found;
    throw std::out_of_range("curves of a test: no " + title_of(quantity, part));
}

TestCurves::Column& TestCurves::column(const Quantity& quantity, std::size_t part) {
    if (const Column* found = find(quantity, part)) return const_cast<Column&>(*found);
    return columns_.emplace_back(&quantity, part, std::vector<double>(rows_, std::nan("")));
}

TestCurves::Row TestCurves::add_row() {
    for (Column& c : columns_) c.values.push_back(std::nan(""));
    return {*this, rows_++};
}

void TestCurves::add_row_of(const TestCurves& other, std::size_t row) {
    const Row added = add_row();
    for (const Column& c : other.columns_) {
        added.part(*c.of, c.part) = c.values[row];
        if (c.low.empty()) continue;
        column(*c.of, c.part).low.push_back(c.low[row]);
        column(*c.of, c.part).high.push_back(c.high[row]);
    }
}

TestCurves TestCurves::up_to(double strain) const {
    return rows_where(
        [&](std::size_t k) { return !((*this)[quantity::axial_strain][k] > strain); });
}

MonotonicStage::MonotonicStage(const TestCurves& curves)
    : curves_(curves), strain_(curves[quantity::axial_strain]) {
    require(std::ranges::is_sorted(strain_),
            "curves of a test: expected a strain that only grows, found one that steps back");
}

std::optional<std::size_t> MonotonicStage::nearest(double strain, double tolerance) const {
    auto nearest = std::ranges::lower_bound(strain_, strain);
    if (nearest != strain_.begin() &&
        (nearest == strain_.end() || strain - *std::prev(nearest) < *nearest - strain))
        --nearest;
    if (nearest == strain_.end() || std::abs(*nearest - strain) > tolerance) return std::nullopt;
    return static_cast<std::size_t>(nearest - strain_.begin());
}

double MonotonicStage::value_at(const Quantity& quantity, double strain, double gap) const {
    const std::vector<double>& values = curves_[quantity];
    std::size_t before = values.size(), after = before;
    for (std::size_t k = 0; k < values.size(); ++k) {
        if (!std::isfinite(values[k])) continue;
        if (strain_[k] <= strain + 1e-9) before = k;
        if (strain_[k] >= strain - 1e-9 && after == values.size()) after = k;
    }
    if (before == values.size() || after == values.size()) return std::nan("");
    const double width = strain_[after] - strain_[before];
    if (width > gap) return std::nan("");
    const double part = width > 0 ? (strain - strain_[before]) / width : 0;
    return values[before] + part * (values[after] - values[before]);
}

void save_curves(Archive& archive, const std::string& path, const TestCurves& curves) {
    std::vector<double> numbers, rings;
    for (std::size_t k = 0; k < curves.size(); ++k) {
        for (const Quantity* q : quantity::of_stage)
            numbers.push_back(curves.has(*q) ? curves[*q][k] : 0);
        for (std::size_t r = 0; r < curves.rings(); ++r) rings.push_back(curves.ring(r)[k]);
    }
    archive.put(path + "/curve", std::span<const double>(numbers));
    archive.put(path + "/ring_radius", std::span<const double>(rings));
}

TestCurves load_curves(const Archive& archive, const std::string& path) {
    const auto numbers = archive.get<double>(path + "/curve"),
               rings = archive.get<double>(path + "/ring_radius");
    const std::size_t rows = numbers.size() / quantity::of_stage.size();
    TestCurves curves;
    auto next = numbers.begin(), next_ring = rings.begin();
    for (std::size_t k = 0; k < rows; ++k) {
        const auto row = curves.add_row();
        for (const Quantity* q : quantity::of_stage) row[*q] = *next++;
        for (std::size_t r = 0; r < rings.size() / rows; ++r)
            row.part(quantity::ring_radius, r) = *next_ring++;
    }
    return curves;
}

void write_curves(const std::filesystem::path& csv, const TestCurves& curves,
                  const std::vector<WrittenColumn>& columns, const std::string& comment,
                  int digits) {
    std::vector<std::string> names;
    std::vector<std::vector<double>> rows(curves.size());
    const auto add = [&](const std::string& name, const std::vector<double>& values) {
        names.push_back(name);
        for (std::size_t k = 0; k < rows.size(); ++k) rows[k].push_back(values[k]);
    };
    for (const WrittenColumn& w : columns) {
        const TestCurves::Column& c = curves.column(*w.of);
        const Quantity named{w.name != nullptr ? w.name : w.of->name, w.of->unit, w.of->meaning};
        add(title_of(named), c.values);
        if (c.low.empty()) continue;
        add(title_of(named, 0, "_low"), c.low);
        add(title_of(named, 0, "_high"), c.high);
    }
    for (std::size_t r = 0; r < curves.rings(); ++r)
        add(title_of(quantity::ring_radius, r), curves.ring(r));
    write_csv(csv, names, rows, {comment}, digits);
}

std::string folder_of(double pressure) { return fmt::format("{:.4g}kPa", pressure / 1e3); }
std::string label_of(double pressure) { return fmt::format("{:.4g} kPa", pressure / 1e3); }

} // namespace bris
