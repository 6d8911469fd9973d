#include "scenarios/records/machine_file.hpp"

#include "engine/errors.hpp"
#include "engine/io/csv.hpp"
#include "engine/io/whole_file.hpp"
#include "engine/math.hpp"
#include "engine/signal/median.hpp"
#include "scenarios/records/guess_columns.hpp"
#include "scenarios/records/recorded_test.hpp"
#include "scenarios/sensors/naming.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <sstream>

namespace bris {

namespace {

using Numbers = std::vector<double>;

constexpr auto strain_name = "axial_strain", stress_name = "deviatoric_stress_Pa",
               volume_name = "volumetric_strain", displacement_name = "axial_displacement_m",
               force_name = "axial_force_N", volume_change_name = "volume_change_m3",
               pressure_name = "confining_pressure_Pa";

/// Whether the first line that is not a comment has the names of BRIS.
bool has_own_names(const std::filesystem::path& csv) {
    std::istringstream text(read_text(csv));
    for (std::string line; std::getline(text, line);) {
        const auto start = trimmed(line);
        if (start.empty() || start.front() == '#') continue;
        const auto cells = cells_of(start);
        return std::ranges::count(cells, strain_name) + std::ranges::count(cells, stress_name) > 0;
    }
    return false;
}

class LaboratoryReader {
public:
    explicit LaboratoryReader(const LaboratoryTest& test)
        : test_(test), table_(read_csv(test.file, form())) {}

    LaboratoryCurves read() {
        check_pressure();
        const Numbers axial = axial_strains(), volume = volumetric_strains(),
                      q = deviatoric_stresses(axial, volume);
        keep_advancing(axial, q, volume);
        return std::move(result_);
    }

private:
    void note(const std::string& text) { result_.notes.push_back(text); }

    CsvForm form() {
        if (!test_.columns.empty())
            return naming("--columns",
                          [&] { return read_column_map(test_.columns, laboratory_columns()); });
        if (has_own_names(test_.file)) return {};
        const GuessedMap guess =
            guess_columns(test_.file, laboratory_columns(), {.pressure = test_.pressure});
        const auto is_found = [&](const char* name) {
            return std::ranges::count(guess.found, name) > 0;
        };
        for (const auto& [wanted, instead] :
             {std::pair{strain_name, displacement_name}, std::pair{stress_name, force_name}})
            require(is_found(wanted) || is_found(instead),
                    fmt::format("{}: expected a column that looks like {} or {}, found {}; "
                                "rename it, or describe the file by --columns",
                                test_.file.string(), wanted, instead, listed(guess.titles)));
        write_guessed_map(test_.file, guess, test_.guessed);
        note(fmt::format("the columns were guessed (columns.txt): {}.", listed(guess.found)));
        return read_column_map(test_.guessed, laboratory_columns());
    }

    /// m2, of the specimen before shearing. Throws InputError if it is needed for `what` and not
    /// known.
    double first_area(const char* what) const {
        require(test_.diameter > 0,
                fmt::format("{}: expected --diameter, the diameter of the specimen, for its {}, "
                            "found none",
                            test_.file.string(), what));
        return 0.25 * pi * test_.diameter * test_.diameter;
    }
    double height(const char* what) const {
        require(test_.height > 0,
                fmt::format("{}: expected --height, the height of the specimen before shearing, "
                            "for its {}, found none",
                            test_.file.string(), what));
        return test_.height;
    }

    /// The file may state the confining pressure; then it must be that of --pressure.
    void check_pressure() const {
        if (!table_.has(pressure_name)) return;
        Numbers stated;
        for (const double x : table_.column(pressure_name))
            if (std::isfinite(x)) stated.push_back(x);
        if (stated.empty()) return;
        const double middle = median(std::move(stated));
        require(std::abs(middle - test_.pressure) <= 0.05 * test_.pressure,
                fmt::format("--pressure: expected that in {}, {:g} Pa, found {:g} Pa",
                            test_.file.string(), middle, test_.pressure));
    }

    Numbers axial_strains() const {
        if (table_.has(strain_name) || !table_.has(displacement_name))
            return table_.column(strain_name);
        Numbers values = table_.column(displacement_name);
        for (double& x : values) x /= height("displacement");
        return values;
    }

    /// Empty: not measured.
    Numbers volumetric_strains() {
        if (table_.has(volume_name)) return table_.column(volume_name);
        if (!table_.has(volume_change_name)) return {};
        Numbers values = table_.column(volume_change_name);
        for (double& x : values) x /= first_area("change of volume") * height("change of volume");
        note("a change of volume is taken as compression where it is positive.");
        return values;
    }

    Numbers deviatoric_stresses(const Numbers& axial, const Numbers& volume) {
        if (table_.has(stress_name) || !table_.has(force_name)) return table_.column(stress_name);
        Numbers values = table_.column(force_name);
        const double area = first_area("force");
        for (std::size_t k = 0; k < values.size(); ++k) {
            const double dilation = volume.empty() || std::isnan(volume[k]) ? 0 : volume[k];
            values[k] /= area * (1 - dilation) / (1 - axial[k]);
        }
        note(fmt::format("q is the force over the present area{}.",
                         volume.empty() ? ", of a specimen whose volume does not change" : ""));
        return values;
    }

    void keep_advancing(const Numbers& axial, const Numbers& q, const Numbers& volume) {
        std::vector<std::size_t> rows;
        std::size_t back = 0, empty = 0;
        for (std::size_t k = 0; k < axial.size(); ++k)
            if (!std::isfinite(axial[k]) || !std::isfinite(q[k]))
                ++empty;
            else if (!rows.empty() && axial[k] <= axial[rows.back()])
                ++back;
            else
                rows.push_back(k);
        require(rows.size() > 1 && 2 * rows.size() > axial.size(),
                fmt::format("{}: expected axial strain that advances in most records, found {} of "
                            "{} in which it repeats or steps back and {} without a number",
                            test_.file.string(), back, axial.size(), empty));
        if (back + empty > 0)
            note(fmt::format("{} of {} records are left out: in {} the axial strain repeats or "
                             "steps back, {} have no number.",
                             back + empty, axial.size(), back, empty));
        MeasuredCurves& curves = result_.curves;
        for (std::size_t k = 0; k < rows.size(); ++k) curves.add_row();
        const auto take = [&](Numbers& to, const Numbers& from) {
            for (std::size_t k = 0; k < rows.size(); ++k) to[k] = from[rows[k]];
        };
        take(curves[quantity::axial_strain], axial);
        take(curves[quantity::deviatoric_stress], q);
        if (!volume.empty()) take(curves[quantity::volumetric_strain], volume);
        for (std::size_t r = 0; table_.has(title_of(quantity::ring_radius, r)); ++r)
            take(curves.column(quantity::ring_radius, r).values,
                 table_.column(title_of(quantity::ring_radius, r)));
    }

    const LaboratoryTest& test_;
    LaboratoryCurves result_;
    CsvTable table_;
};

} // namespace

const std::vector<KnownColumn>& laboratory_columns() {
    using Units = std::vector<ColumnUnit>;
    static const std::vector<KnownColumn> all = [] {
        std::vector<KnownColumn> columns = machine_columns();
        for (KnownColumn& column : columns) column.needed = false;
        columns.push_back({displacement_name, Units{{"m"}, {"mm", 1e-3}, {"um", 1e-6}}});
        columns.push_back({force_name, Units{{"N"}, {"kN", 1e3}}});
        columns.push_back({volume_change_name,
                           Units{{"m3"}, {"ml", 1e-6}, {"cm3", 1e-6}, {"mm3", 1e-9}, {"l", 1e-3}}});
        columns.push_back({pressure_name, Units{{"Pa"}, {"kPa", 1e3}, {"MPa", 1e6}}});
        return columns;
    }();
    return all;
}

LaboratoryCurves read_laboratory_test(const LaboratoryTest& test) {
    return naming("--test", [&] { return LaboratoryReader(test).read(); });
}

} // namespace bris
