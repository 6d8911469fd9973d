// The same recordings written in another way: with columns that nobody asked for, in other units
// that the header states, in another encoding, rounded to single precision. What is read, and what
// follows from it, stays the same.

#include "engine/assets.hpp"
#include "engine/io/column_map.hpp"
#include "engine/io/whole_file.hpp"
#include "scenarios/records/guess_columns.hpp"
#include "scenarios/records/quality_control_report.hpp"
#include "scenarios/records/recorded_test.hpp"
#include "tests/engine/io/encoded.hpp"
#include "tests/scenarios/records/sheet.hpp"
#include "tests/temporary_directory.hpp"

#include <doctest/doctest.h>
#include <fmt/format.h>

#include <cmath>

using namespace bris;

namespace {

namespace fs = std::filesystem;
using testing::Sheet;

/// The shipped test at 55 kPa as two sheets.
struct Written {
    Sheet sensors = Sheet::read(assets_folder() / "smartrock/55kPa/recordings.csv"),
          machine = Sheet::read(assets_folder() / "smartrock/55kPa/test.csv");
    std::string encoding = "UTF-8";
    bool with_maps = false; ///< guessed from the headers

    RecordedTest read() const {
        const TemporaryDirectory folder;
        for (int k = 1; k <= 10; ++k)
            fs::copy(assets_folder() / fmt::format("smartrock/rock_{:02}.txt", k), folder.path());
        const auto write = [&](const Sheet& sheet, const char* file, const char* map,
                               const std::vector<KnownColumn>& known) {
            const auto csv = folder.path() / "55kPa" / file;
            write_whole(csv, testing::encoded(sheet.text(), encoding));
            if (!with_maps) return;
            const GuessedMap guess = guess_columns(csv, known, {.pressure = 55e3});
            REQUIRE_MESSAGE(guess.open.empty(), listed(guess.open));
            write_whole(folder / map, guess.map);
        };
        write(sensors, "recordings.csv", "columns.txt", recording_columns());
        write(machine, "test.csv", "machine_columns.txt", machine_columns());
        return read_recorded_test(folder.path(), 55e3, read_sensor_infos(folder.path()), {});
    }
};

const RecordedTest& original() {
    static const RecordedTest test = Written{}.read();
    return test;
}

/// Largest difference of two series, relative to the largest number of the first.
struct Difference {
    double most = 0, size = 0;
    void add(double a, double b) {
        CHECK(std::isfinite(a) == std::isfinite(b));
        if (!std::isfinite(a)) return;
        most = std::max(most, std::abs(a - b));
        size = std::max(size, std::abs(a));
    }
    void add(const Vec3& a, const Vec3& b) {
        for (Eigen::Index axis = 0; axis < 3; ++axis) add(a[axis], b[axis]);
    }
    double relative() const { return size > 0 ? most / size : most; }
};

/// What is read: every channel of every sensor, and the machine's measurements.
double difference_of_records(const RecordedTest& a, const RecordedTest& b) {
    std::vector<Difference> all(9);
    REQUIRE(a.recordings.size() == b.recordings.size());
    for (std::size_t s = 0; s < a.recordings.size(); ++s) {
        const Recording &x = a.recordings[s], &y = b.recordings[s];
        REQUIRE(x.size() == y.size());
        for (std::size_t k = 0; k < x.size(); ++k) {
            all[0].add(x.time[k], y.time[k]);
            all[1].add(x.strain[k], y.strain[k]);
            all[2].add(x.force[k], y.force[k]);
            all[3].add(x.rate[k], y.rate[k]);
            all[4].add(x.displacement[k], y.displacement[k]);
            all[5].add(x.attitude[k].w(), y.attitude[k].w());
            all[5].add(x.attitude[k].vec(), y.attitude[k].vec());
        }
    }
    REQUIRE(a.curves.size() == b.curves.size());
    for (const TestCurves::Column& c : a.curves.columns())
        for (std::size_t k = 0; k < a.curves.size(); ++k)
            all[c.of == &quantity::axial_strain        ? 6
                : c.of == &quantity::deviatoric_stress ? 7
                                                       : 8]
                .add(c.values[k], b.curves.column(*c.of, c.part).values[k]);
    return std::ranges::max_element(all, {}, &Difference::relative)->relative();
}

/// What a model learns from: displacement, tilt and rotation of each rock along the test.
double difference_of_features(const RecordedTest& a, const RecordedTest& b) {
    std::vector<Difference> all(3);
    for (std::size_t s = 0; s < a.trajectories.size(); ++s) {
        const SensorTrajectory &x = a.trajectories[s], &y = b.trajectories[s];
        REQUIRE(x.strain.size() == y.strain.size());
        REQUIRE(!x.strain.empty());
        for (std::size_t k = 0; k < x.strain.size(); ++k) {
            all[0].add(x.displacement[k], y.displacement[k]);
            all[1].add(x.tilt[k], y.tilt[k]);
            all[2].add(x.rotation[k], y.rotation[k]);
        }
    }
    return std::ranges::max_element(all, {}, &Difference::relative)->relative();
}

std::string report_without_fields(RecordedTest test) {
    std::erase_if(test.findings, [](const Finding& f) { return f.check == "fields"; });
    return quality_control_report(test);
}

} // namespace

TEST_SUITE("records/metamorphic") {
    TEST_CASE("columns that nobody asked for change nothing, and are said once") {
        Written more;
        more.sensors.insert(0, "clock", {"12:00:00", "12:00:12", ""});
        more.sensors.insert(4, "ok", {"true", "false"});
        more.sensors.insert(7, "operator's note", {"", "\"a, b\"", "\u00b5-strain", "-"});
        more.sensors.insert(more.sensors.names.size(), "", {""}); // a delimiter too many
        more.machine.insert(1, "stage", {"shear"});
        more.machine.insert(1, "stage", {"2024-05-07 10:00"}); // twice
        const RecordedTest test = more.read();
        CHECK(difference_of_records(original(), test) == 0);
        CHECK(difference_of_features(original(), test) == 0);
        CHECK(report_without_fields(test) == quality_control_report(original()));
        const std::string report = quality_control_report(test);
        for (const char* line :
             {"sensors 1 to 10: fields: 3 of the file are not used: clock, ok, operator's note\n",
              "test machine: fields: 1 of the file is not used: stage\n"})
            CHECK_MESSAGE(report.find(line) != std::string::npos, report);
    }

    TEST_CASE("every encoding gives the same bits") {
        for (const std::string& encoding : testing::encodings()) {
            Written other;
            other.encoding = encoding;
            CAPTURE(encoding);
            const RecordedTest test = other.read();
            CHECK(difference_of_records(original(), test) == 0);
            CHECK(quality_control_report(test) == quality_control_report(original()));
        }
    }

    TEST_CASE("units that are changed together with the header give the same numbers, in every "
              "encoding") {
        const auto scale_of = [](const std::vector<KnownColumn>& known, const std::string& name,
                                 const std::string& unit) {
            const auto column = std::ranges::find(known, name, &KnownColumn::name);
            return std::ranges::find(column->units, unit, &ColumnUnit::name)->scale;
        };
        struct Units {
            std::string time, force, rate, displacement, strain, stress, radius;
        };
        // as written, and as column maps spell them
        const std::vector<std::pair<Units, Units>> all{
            {{"seconds", "m/s^2", "rad/s", "m", "-", "Pa", "m"},
             {"s", "m/s2", "rad/s", "m", "1", "Pa", "m"}},
            {{"ms", "g", "\u00b0/s", "mm", "%", "kPa", "mm"},
             {"ms", "g", "deg/s", "mm", "%", "kPa", "mm"}},
            {{"\u00b5s", "mg", "mrad/s", "\u00b5m", "percent", "N/mm\u00b2", "mm"},
             {"us", "mg", "mrad/s", "um", "%", "MPa", "mm"}},
            {{"min", "m/s\u00b2", "rpm", "m", "1", "kN/m2", "m"},
             {"min", "m/s2", "rpm", "m", "1", "kPa", "m"}}};
        std::size_t n = 0;
        for (const auto& [written, spelled] : all) {
            CAPTURE(written.time);
            Written other;
            other.with_maps = true;
            other.encoding = testing::encodings()[n++ % testing::encodings().size()];
            const auto title = [&](const std::string& name, const Units& units) -> std::string {
                if (name == "t") return units.time;
                if (name.size() == 2 && name[0] == 'a') return units.force;
                if (name.size() == 2 && name[0] == 'g') return units.rate;
                if (name.size() == 2 && name[0] == 'u') return units.displacement;
                if (name.ends_with("strain")) return units.strain;
                if (name == "deviatoric_stress_Pa") return units.stress;
                if (name.starts_with("ring_")) return units.radius;
                return "";
            };
            const auto convert = [&](Sheet& sheet, const std::vector<KnownColumn>& known) {
                sheet.change([&](const std::string& name, double x) {
                    const std::string unit = title(name, spelled);
                    return fmt::format("{}", unit.empty() ? x : x / scale_of(known, name, unit));
                });
                for (std::string& name : sheet.names)
                    if (const std::string unit = title(name, written); !unit.empty())
                        name = (name == "deviatoric_stress_Pa" ? "q" : name) + " [" + unit + "]";
            };
            convert(other.sensors, recording_columns());
            convert(other.machine, machine_columns());
            const RecordedTest test = other.read();
            CHECK(difference_of_records(original(), test) < 1e-14);
            CHECK(difference_of_features(original(), test) < 1e-9);
            CHECK(quality_control_report(test) == quality_control_report(original()));
        }
    }

    TEST_CASE("numbers that are rounded to single precision give the same features within 1e-5") {
        Written rounded;
        for (Sheet* sheet : {&rounded.sensors, &rounded.machine})
            sheet->change(testing::in_single_precision);
        const RecordedTest test = rounded.read();
        CHECK(difference_of_records(original(), test) < 1.2e-7);
        CHECK(difference_of_features(original(), test) < 1e-5);
        CHECK(report_without_fields(test) == quality_control_report(original()));
    }
}
