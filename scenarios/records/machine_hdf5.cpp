#include "scenarios/records/machine_hdf5.hpp"

#include "engine/errors.hpp"
#include "engine/signal/median.hpp"
#include "scenarios/sensors/hdf5_recordings.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <span>
#include <string>

namespace bris {

namespace {

constexpr const char* group = "/bench";

std::string named(const char* dataset) { return fmt::format("{}/{}", group, dataset); }

/// Current area relative to that at the start, row by row.
std::vector<double> areas_of(const TestCurves& curves) {
    std::vector<double> areas;
    double volume = 0;
    for (std::size_t k = 0; k < curves.size(); ++k) {
        const double now = curves[quantity::volumetric_strain][k];
        if (std::isfinite(now)) volume = now;
        areas.push_back((1 - volume) / (1 - curves[quantity::axial_strain][k]));
    }
    return areas;
}

class MachineReader {
public:
    explicit MachineReader(const Hdf5Content& file) : file_(file) {
        require(file_.has(group),
                fmt::format("{}: expected a group {}, or test.csv beside it, found neither",
                            file.path().string(), group));
        require_dataset("time");
        const auto shape = file_.shape(named("time"));
        require(shape.size() == 1,
                fmt::format("{}: expected a one-dimensional array of numbers, found {}", at("time"),
                            in_words(shape)));
        records_ = shape.front();
        constexpr std::array<std::pair<const char*, const char*>, 7> units{
            {{"time", "s"},
             {"strain", "1"},
             {"force", "N"},
             {"confining", "Pa"},
             {"volumetric_strain", "1"},
             {"phase", "cycles"},
             {"ring_radius", "m"}}};
        for (const auto& [dataset, unit] : units)
            require_unit(file_, named(dataset), unit, {ColumnUnit{.name = unit}});
    }

    MachineRecord read(double pressure) const {
        const auto time = numbers("time"), strain = numbers("strain"), force = numbers("force"),
                   confining = numbers("confining");
        const auto volume = optional_numbers("volumetric_strain"),
                   phase = optional_numbers("phase");
        require(records_ > 1, fmt::format("{}: {}: expected at least two records, found {}",
                                          file_.path().string(), group, records_));
        for (std::size_t k = 0; k < records_; ++k) require_number("confining", k, confining);
        require(std::abs(median(confining) / pressure - 1) < 0.05,
                fmt::format("{}: expected a median of {:g} Pa within 5 %, found {:g}",
                            at("confining"), pressure, median(confining)));
        const auto rings = rings_of();
        MachineRecord machine;
        for (std::size_t k = 0; k < records_; ++k) {
            require_number("time", k, time, k == 0 || time[k] > time[k - 1]);
            require(!(strain[k] >= 1),
                    fmt::format("{}[{}]: expected a number below 1, found {}: is it in per cent?",
                                at("strain"), k, strain[k]));
            require_number("strain", k, strain, k == 0 || strain[k] > strain[k - 1]);
            require_number("force", k, force);
            const auto row = machine.curves.add_row();
            row[quantity::axial_strain] = strain[k];
            if (volume) row[quantity::volumetric_strain] = (*volume)[k];
            for (std::size_t r = 0; r < rings.size() / records_; ++r)
                row.part(quantity::ring_radius, r) = rings[k * (rings.size() / records_) + r];
            machine.clock.by_time.emplace(time[k], strain[k]);
            if (!phase) continue;
            require_number("phase", k, *phase, k == 0 || (*phase)[k] >= (*phase)[k - 1]);
            machine.clock.by_phase.emplace((*phase)[k], strain[k]);
        }
        machine.unused = unused_in(file_, group,
                                   {"time", "strain", "force", "confining", "volumetric_strain",
                                    "phase", "ring_radius", "@area"});
        const double area = area_at_start();
        const auto areas = areas_of(machine.curves);
        for (std::size_t k = 0; k < records_; ++k)
            machine.curves[quantity::deviatoric_stress][k] = force[k] / (area * areas[k]);
        return machine;
    }

private:
    std::string at(const char* dataset) const {
        return fmt::format("{}: {}", file_.path().string(), named(dataset));
    }
    void require_dataset(const char* dataset) const {
        require(file_.has(named(dataset)),
                fmt::format("{}: expected numbers, found none", at(dataset)));
    }
    std::vector<double> numbers(const char* dataset) const {
        require_dataset(dataset);
        const auto& all = file_.numbers(named(dataset));
        require(all.size() == records_,
                fmt::format("{}: expected {} numbers, as many as in time, found {}", at(dataset),
                            records_, all.size()));
        return all;
    }
    std::optional<std::vector<double>> optional_numbers(const char* dataset) const {
        if (!file_.has(named(dataset))) return {};
        return numbers(dataset);
    }
    std::vector<double> rings_of() const {
        if (!file_.has(named("ring_radius"))) return {};
        const auto shape = file_.shape(named("ring_radius"));
        require(shape.size() == 2 && shape[0] == records_,
                fmt::format("{}: expected {} rows of ring radii, found {}", at("ring_radius"),
                            records_, in_words(shape)));
        return file_.numbers(named("ring_radius"));
    }
    double area_at_start() const {
        require(file_.has_attribute(group, "area"),
                fmt::format("{}: {}: expected an attribute area (m2), found none",
                            file_.path().string(), group));
        const auto area = file_.attribute(group, "area");
        const std::string where = fmt::format("{}: {}: area: expected a number above 0 (m2), found",
                                              file_.path().string(), group);
        require(area.size() == 1, fmt::format("{} {} numbers", where, area.size()));
        require(area[0] > 0 && std::isfinite(area[0]), fmt::format("{} {}", where, area[0]));
        return area[0];
    }
    void require_number(const char* dataset, std::size_t k, const std::vector<double>& all) const {
        require(std::isfinite(all[k]),
                fmt::format("{}[{}]: expected a number, found {}", at(dataset), k, all[k]));
    }
    void require_number(const char* dataset, std::size_t k, const std::vector<double>& all,
                        bool grows) const {
        require_number(dataset, k, all);
        require(grows, fmt::format("{}[{}]: expected increasing numbers, found {}", at(dataset), k,
                                   all[k]));
    }

    const Hdf5Content& file_;
    std::size_t records_ = 0;
};

} // namespace

bool has_machine_record(const std::filesystem::path& path) {
    return Hdf5Content::read(path, {group}, Hdf5Content::Datasets::left_out).has(group);
}

MachineRecord read_machine_record(const std::filesystem::path& path, double pressure) {
    return machine_record_in(Hdf5Content::read(path, {group}), pressure);
}

MachineRecord machine_record_in(const Hdf5Content& file, double pressure) {
    return MachineReader(file).read(pressure);
}

void write_machine_record(const std::filesystem::path& path, const TestCurves& curves,
                          const std::vector<double>& time, double area, double pressure) {
    Hdf5File file = Hdf5File::open_to_write(path);
    std::vector<double> force, rings;
    const auto areas = areas_of(curves);
    for (std::size_t k = 0; k < curves.size(); ++k) {
        force.push_back(curves[quantity::deviatoric_stress][k] * area * areas[k]);
        for (std::size_t r = 0; r < curves.rings(); ++r) rings.push_back(curves.ring(r)[k]);
    }
    const std::vector<double> confining(curves.size(), pressure);
    const auto write = [&](const char* dataset, const std::vector<double>& numbers) {
        file.write(named(dataset), std::span<const double>(numbers));
    };
    write("time", time);
    write("strain", curves[quantity::axial_strain]);
    write("force", force);
    write("confining", confining);
    write("volumetric_strain", curves[quantity::volumetric_strain]);
    if (!rings.empty())
        file.write(named("ring_radius"), std::span<const double>(rings),
                   {curves.size(), curves.rings()});
    file.set_attribute<double>(group, "area", area);
    file.close();
}

} // namespace bris
