#include "scenarios/stream/recorded_stream.hpp"

#include "engine/errors.hpp"
#include "engine/io/csv.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

namespace bris {

namespace {

constexpr auto end_mark = "{\"end\": 1}";

/// A line of the stream. Samples of the sensors precede the record of the machine at the same
/// strain: when the machine has passed a strain, they have arrived.
struct Sent {
    double strain, t;
    bool by_machine;
    std::string line;
};

std::string object_of(const CsvTable& table, std::size_t row) {
    std::string text;
    for (std::size_t k = 0; k < table.names.size(); ++k)
        if (!std::isnan(table.rows[row][k]))
            text += fmt::format("{}\"{}\": {}", text.empty() ? "" : ", ", table.names[k],
                                table.rows[row][k]);
    return text;
}

} // namespace

std::vector<std::string> stream_of(const std::filesystem::path& folder, double stage_time,
                                   double rest) {
    const CsvTable machine = read_csv(folder / "test.csv"),
                   sensors = read_csv(folder / "recordings.csv");
    std::vector<Sent> sent;
    const auto t = sensors.column("t"), strain = sensors.column("strain"),
               reached = machine.column("axial_strain");
    const bool has_clock = machine.has("t"); // kept: clock offsets of the sensors refer to it
    const auto known = [](const std::vector<double>& numbers) {
        return std::ranges::all_of(numbers, [](double n) { return std::isfinite(n); });
    };
    require(known(t) && known(strain) && known(reached),
            fmt::format("{}: expected numbers in t, strain and axial_strain of all rows",
                        folder.string()));
    for (std::size_t k = 0; k < sensors.rows.size(); ++k)
        sent.push_back({strain[k], t[k], false, fmt::format("{{{}}}", object_of(sensors, k))});
    for (std::size_t k = 0; k < machine.rows.size(); ++k) {
        const double at = rest + reached[k] / 1e-4 * stage_time;
        const std::string numbers = object_of(machine, k);
        sent.push_back({reached[k], at, true,
                        has_clock ? fmt::format("{{{}}}", numbers)
                                  : fmt::format("{{\"t\": {:.6g}, {}}}", at, numbers)});
    }
    std::ranges::stable_sort(sent, [](const Sent& a, const Sent& b) {
        return std::tie(a.strain, a.by_machine, a.t) < std::tie(b.strain, b.by_machine, b.t);
    });
    std::vector<std::string> lines;
    for (Sent& s : sent) lines.push_back(std::move(s.line));
    lines.emplace_back(end_mark);
    return lines;
}

} // namespace bris
