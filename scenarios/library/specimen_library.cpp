#include "scenarios/library/specimen_library.hpp"

#include "engine/errors.hpp"
#include "engine/io/checkpoint.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace bris {

namespace {

constexpr auto kind = "specimen_library";
constexpr std::size_t per_cell = 2;

Vec3 outward_at(const Vec3& position) { return Vec3(position.x(), position.y(), 0).normalized(); }

void add(std::vector<float>& numbers, const Vec3& v) {
    for (const double x : v) numbers.push_back(static_cast<float>(x));
}

/// Cell of each rock at the start of shearing.
std::vector<std::size_t> cells_of_rocks(const ModelRun& run) {
    const auto distance = [](const Vec3& x) { return std::hypot(x.x(), x.y()); };
    double height = 0, radius = 0;
    for (const RockPose& p : run.start) {
        height = std::max(height, p.position.z());
        radius = std::max(radius, distance(p.position));
    }
    const auto part = [](double fraction, std::size_t parts) {
        return std::min(parts - 1, static_cast<std::size_t>(std::max(0.0, fraction) *
                                                            static_cast<double>(parts)));
    };
    std::vector<std::size_t> cells;
    for (const RockPose& p : run.start)
        cells.push_back(part(p.position.z() / height, FieldCells::heights) * FieldCells::radii +
                        part(std::pow(distance(p.position) / radius, 2), FieldCells::radii));
    return cells;
}

void add_field(std::vector<float>& field, const ModelRun& run,
               const std::vector<std::size_t>& cells, std::size_t stage) {
    std::vector<double> outward(FieldCells::count), upward(FieldCells::count),
        rocks(FieldCells::count);
    for (std::size_t k = 0; k < cells.size(); ++k) {
        const Vec3& u = run.displacement[stage][k];
        outward[cells[k]] += u.dot(outward_at(run.start[k].position));
        upward[cells[k]] += u.z();
        ++rocks[cells[k]];
    }
    for (std::size_t c = 0; c < FieldCells::count; ++c)
        for (const double sum : {outward[c], upward[c]})
            field.push_back(static_cast<float>(sum / std::max(1.0, rocks[c])));
}

double smoothed_q(const TestCurves& curves, double strain) {
    const auto &strains = curves[quantity::axial_strain], &q = curves[quantity::deviatoric_stress];
    double sum = 0, count = 0;
    for (std::size_t k = 0; k < curves.size(); ++k) {
        if (std::abs(strains[k] - strain) > LibraryAxis::half_window * (1 + 1e-6)) continue;
        sum += q[k];
        ++count;
    }
    return sum / count;
}

std::size_t stage_for(const ModelRun& run, double strain) {
    const auto stage = stage_of_sample(run, strain);
    require(stage && std::abs(run.curves[quantity::axial_strain][*stage] - strain) < 1e-6,
            fmt::format("specimen library: expected a stage at an axial strain of {:g}, found none",
                        strain));
    return *stage;
}

/// Calls visit(name, numbers of a specimen, array) for each array of a test.
template <class Test, class Visit>
void visit_arrays(const SpecimenLibrary& of, Test& test, const Visit& visit) {
    const std::size_t fine = of.axis.count, coarse = of.axis.coarse_count();
    visit("q_Pa", fine, test.q);
    visit("smoothed_q_Pa", fine, test.smoothed_q);
    visit("volumetric_strain", fine, test.volume);
    visit("ring_strain", fine * of.rings, test.rings);
    visit("sensor_motion", coarse * of.sensors * LibraryTest::per_sensor, test.sensors);
    visit("displacement_field_m", coarse * FieldCells::count * per_cell, test.field);
}

/// The numbers of a specimen, in the order of the columns of specimens/numbers.
auto numbers_of(auto& s) {
    return std::tie(s.rocks.friction, s.rocks.stiffness, s.porosity, s.core_porosity, s.diameter);
}
/// The same for specimens/counts.
auto counts_of(auto& s) { return std::tie(s.number, s.seed, s.redrawn); }

constexpr std::size_t number_count = 5, count_count = 3;

template <class T>
void put_table(Archive& archive, const std::string& path, std::size_t columns,
               const std::vector<T>& values) {
    Archive part;
    part.put(path, std::span<const T>(values));
    Archive::Array array = part.arrays().front();
    if (columns > 0) array.columns = columns;
    archive.put(std::move(array));
}

/// Reads arrays, and refuses those of an unexpected size.
class Reader {
public:
    Reader(const std::filesystem::path& path, const Archive& archive)
        : path_(path), archive_(archive) {}

    template <class T>
    std::vector<T> read(const std::string& name, std::size_t count) const {
        std::vector<T> values;
        try {
            values = archive_.get<T>(name);
        } catch (const InputError& error) {
            fail(error.what());
        }
        if (values.size() != count)
            fail(fmt::format("expected {} numbers in {}, found {}", count, name, values.size()));
        return values;
    }
    [[noreturn]] void fail(const std::string& what) const {
        throw InputError(fmt::format("specimen library '{}': {}", path_.string(), what));
    }

private:
    const std::filesystem::path& path_;
    const Archive& archive_;
};

void put_tests(Archive& archive, const SpecimenLibrary& library, std::size_t pressure) {
    std::vector<std::pair<std::string, std::vector<float>>> tables;
    std::vector<std::size_t> columns;
    for (const LibrarySpecimen& s : library.specimens) {
        std::size_t next = 0;
        visit_arrays(library, s.tests[pressure],
                     [&](const char* name, std::size_t count, const std::vector<float>& array) {
                         if (next == tables.size()) {
                             tables.emplace_back(name, std::vector<float>{});
                             columns.push_back(count);
                         }
                         require(array.size() == count,
                                 fmt::format("specimen library: expected {} numbers of {}, found "
                                             "{}",
                                             count, name, array.size()));
                         auto& values = tables[next++].second;
                         values.insert(values.end(), array.begin(), array.end());
                     });
    }
    for (std::size_t k = 0; k < tables.size(); ++k)
        put_table(archive, folder_of(library.pressures[pressure]) + "/" + tables[k].first,
                  columns[k], tables[k].second);
}

void read_tests(const Reader& reader, SpecimenLibrary& library, std::size_t pressure) {
    const std::size_t n = library.specimens.size();
    std::vector<std::vector<float>> tables;
    LibraryTest like;
    visit_arrays(
        library, like, [&](const char* name, std::size_t count, const std::vector<float>&) {
            tables.push_back(
                reader.read<float>(folder_of(library.pressures[pressure]) + "/" + name, n * count));
        });
    for (std::size_t k = 0; k < n; ++k) {
        std::size_t next = 0;
        visit_arrays(library, library.specimens[k].tests[pressure],
                     [&](const char*, std::size_t count, std::vector<float>& array) {
                         const auto from =
                             tables[next++].begin() + static_cast<std::ptrdiff_t>(k * count);
                         array.assign(from, from + static_cast<std::ptrdiff_t>(count));
                     });
    }
}

} // namespace

bool SpecimenLibrary::has(std::uint64_t number) const {
    return std::ranges::count(given_up, number) > 0 ||
           std::ranges::count(specimens, number, &LibrarySpecimen::number) > 0;
}

void SpecimenLibrary::add(LibrarySpecimen specimen) {
    const auto after =
        std::ranges::upper_bound(specimens, specimen.number, {}, &LibrarySpecimen::number);
    specimens.insert(after, std::move(specimen));
}

Vec3 polar(const Vec3& v, const Vec3& place) {
    const Vec3 outward = outward_at(place);
    return {v.dot(outward), v.dot(Vec3::UnitZ().cross(outward)), v.z()};
}

LibraryTest sampled(const ModelRun& run, const LibraryAxis& axis) {
    LibraryTest test;
    for (std::size_t k = 0; k < axis.count; ++k) {
        const std::size_t stage = stage_for(run, axis.strain(k));
        const auto add = [&](std::vector<float>& numbers, double x) {
            numbers.push_back(static_cast<float>(x));
        };
        add(test.q, run.curves[quantity::deviatoric_stress][stage]);
        add(test.smoothed_q, smoothed_q(run.curves, axis.strain(k)));
        add(test.volume, run.curves[quantity::volumetric_strain][stage]);
        for (std::size_t r = 0; r < run.curves.rings(); ++r)
            add(test.rings, run.curves.ring(r)[stage] / run.curves.ring(r).front() - 1);
    }
    const auto cells = cells_of_rocks(run);
    for (std::size_t k = 0; k < axis.coarse_count(); ++k) {
        const std::size_t stage = stage_for(run, axis.coarse_strain(k));
        for (std::size_t s = 0; s < run.sensors; ++s) {
            add(test.sensors, polar(run.displacement[stage][s], run.start[s].position));
            add(test.sensors, polar(run.rotation[stage][s], run.start[s].position));
        }
        add_field(test.field, run, cells, stage);
    }
    return test;
}

void write_library(const std::filesystem::path& path, const SpecimenLibrary& library) {
    Archive archive;
    const std::vector<double> axis{library.axis.step, static_cast<double>(library.axis.count),
                                   static_cast<double>(library.axis.every),
                                   static_cast<double>(library.rings),
                                   static_cast<double>(library.sensors)};
    put_table(archive, "axis", 0, axis);
    put_table(archive, "pressures_Pa", 0, library.pressures);
    put_table(archive, "given_up", 0, library.given_up);
    std::vector<double> numbers;
    std::vector<std::uint64_t> counts;
    for (const LibrarySpecimen& s : library.specimens) {
        std::apply([&](auto... x) { (numbers.push_back(x), ...); }, numbers_of(s));
        std::apply([&](auto... x) { (counts.push_back(x), ...); }, counts_of(s));
    }
    put_table(archive, "specimens/numbers", number_count, numbers);
    put_table(archive, "specimens/counts", count_count, counts);
    if (!library.specimens.empty())
        for (std::size_t p = 0; p < library.pressures.size(); ++p) put_tests(archive, library, p);
    if (path.has_parent_path()) std::filesystem::create_directories(path.parent_path());
    write_checkpoint(path, {kind, library.specimens.size(), library.settings, archive});
}

SpecimenLibrary read_library(const std::filesystem::path& path) {
    const Checkpoint file = read_checkpoint(path);
    const Reader reader(path, file.state);
    if (file.scenario != kind)
        reader.fail(
            fmt::format("expected a specimen library, found a checkpoint of {}", file.scenario));
    SpecimenLibrary library;
    library.settings = file.settings;
    const auto axis = reader.read<double>("axis", 5);
    if (!std::ranges::all_of(axis, [](double x) { return x >= 0 && x < 1e6; }))
        reader.fail("expected an axis of positive numbers");
    library.axis = {axis[0], static_cast<std::size_t>(axis[1]),
                    std::max<std::size_t>(1, static_cast<std::size_t>(axis[2]))};
    library.rings = static_cast<std::size_t>(axis[3]);
    library.sensors = static_cast<std::size_t>(axis[4]);
    try {
        library.pressures = file.state.get<double>("pressures_Pa");
        library.given_up = file.state.get<std::uint64_t>("given_up");
    } catch (const InputError& error) {
        reader.fail(error.what());
    }
    const std::size_t n = file.step;
    if (n > 1000000) reader.fail(fmt::format("expected at most 1000000 specimens, found {}", n));
    const auto numbers = reader.read<double>("specimens/numbers", n * number_count);
    const auto counts = reader.read<std::uint64_t>("specimens/counts", n * count_count);
    library.specimens.resize(n);
    for (std::size_t k = 0; k < n; ++k) {
        auto& s = library.specimens[k];
        std::size_t next = k * number_count, next_count = k * count_count;
        std::apply([&](auto&... x) { ((x = numbers[next++]), ...); }, numbers_of(s));
        std::apply([&](auto&... x) { ((x = counts[next_count++]), ...); }, counts_of(s));
        s.tests.resize(library.pressures.size());
    }
    if (n > 0)
        for (std::size_t p = 0; p < library.pressures.size(); ++p) read_tests(reader, library, p);
    return library;
}

} // namespace bris
