// Triaxial tests as laboratories have them: force and displacement, strains that repeat or step
// back, titles with explanations.

#include "engine/errors.hpp"
#include "engine/io/whole_file.hpp"
#include "engine/math.hpp"
#include "scenarios/records/machine_file.hpp"
#include "tests/about.hpp"
#include "tests/shared_data.hpp"
#include "tests/temporary_directory.hpp"

#include <doctest/doctest.h>
#include <fmt/format.h>

#include <cmath>

using namespace bris;

namespace {

namespace fs = std::filesystem;

/// A file in a folder of its own, and how it is read.
struct Written {
    explicit Written(const std::string& text) {
        test.file = folder / "test.csv";
        test.guessed = folder / "columns.txt";
        test.pressure = 50e3;
        write_whole(test.file, text);
    }
    LaboratoryCurves read() const { return read_laboratory_test(test); }
    std::string refusal() const {
        return message_of<InputError>([&] { (void)read(); });
    }
    TemporaryDirectory folder;
    LaboratoryTest test;
};

bool has(const std::string& text, const std::string& part) {
    return text.find(part) != std::string::npos;
}

/// A specimen of 300 mm by 600 mm: force (kN), displacement (mm), change of volume (ml).
std::string piston_file() {
    std::string text = "Time [s];Load [kN];Displacement [mm];Volume change [ml]\n";
    for (int k = 0; k < 20; ++k) {
        std::string row = fmt::format("{};{:.3f};{:.3f};{:.3f}\n", 12 * k, 0.9 * std::sqrt(k),
                                      0.6 * k, 0.4 * k - 0.1 * k * k);
        for (char& c : row) c = c == '.' ? ',' : c;
        text += row;
    }
    return text;
}

} // namespace

TEST_SUITE("records/machine_file") {
    TEST_CASE("force, displacement and change of volume give q over the present area and strains "
              "by the size of the specimen, which is asked for") {
        Written file(piston_file());
        CHECK(has(file.refusal(), "expected --height, the height of the specimen"));
        file.test.height = 0.6;
        CHECK(has(file.refusal(), "expected --diameter, the diameter of the specimen"));
        file.test.diameter = 0.3;
        const LaboratoryCurves read = file.read();
        const MeasuredCurves& c = read.curves;
        REQUIRE(c.size() == 20);
        const double area = pi * 0.15 * 0.15;
        for (std::size_t k = 0; k < 20; ++k) {
            const auto n = static_cast<double>(k);
            const double axial = 1e-3 * n, volume = 1e-6 * (0.4 * n - 0.1 * n * n) / (area * 0.6),
                         force = std::round(900 * std::sqrt(n)),
                         q = force / area * (1 - axial) / (1 - volume);
            CHECK(std::abs(c[quantity::axial_strain][k] - axial) < 1e-9);
            CHECK(std::abs(c[quantity::volumetric_strain][k] - volume) < 1e-9);
            CHECK(std::abs(c[quantity::deviatoric_stress][k] - q) < 1e-6 * (1 + q));
        }
        CHECK(has(read.notes.back(), "q is the force over the present area."));
        CHECK(fs::exists(file.test.guessed));
    }

    TEST_CASE("records whose strain repeats or steps back are left out and counted, and a file of "
              "which most would be left out is refused") {
        const std::string names = "axial strain [%],q [kPa]\n";
        const LaboratoryCurves read =
            Written(names + "0,0\n0.1,20\n0.1,21\n0.05,15\n0.2,40\n-,50\n0.3,60\n0.4,65\n").read();
        REQUIRE(read.curves.size() == 5);
        CHECK(read.curves[quantity::axial_strain][2] == about(2e-3));
        CHECK(read.curves[quantity::deviatoric_stress][2] == about(40e3));
        CHECK(read.notes.back() == "3 of 8 records are left out: in 2 the axial strain repeats or "
                                   "steps back, 1 have no number.");
        CHECK(has(Written(names + "0,0\n0.1,20\n0.05,5\n0,1\n0.02,3\n").refusal(),
                  "expected axial strain that advances in most records, found 3 of 5"));
    }

    TEST_CASE("titles with formulas and remarks are understood, and a stated confining pressure "
              "must be the one given") {
        const std::string text = "\"initial void ratio\",0.52,\"\",\"\"\n"
                                 "\"epax=dh/h0 [%]\",\"sigrad' [kPa]\",\"q [kPa]\","
                                 "\"epv=dV/V0 [%] (dilatancy is negative)\"\n"
                                 "0,50,2.7,0\n0.1,50,20,0.01\n0.2,50,40,-0.02\n";
        Written file(text);
        const LaboratoryCurves read = file.read();
        REQUIRE(read.curves.size() == 3);
        CHECK(read.curves[quantity::axial_strain][2] == about(2e-3));
        CHECK(read.curves[quantity::volumetric_strain][2] == about(-2e-4));
        CHECK(read.curves[quantity::deviatoric_stress][2] == about(40e3));
        file.test.pressure = 110e3;
        CHECK(has(file.refusal(), "--test: --pressure: expected that in "));
    }

    TEST_CASE("what is missing is said with the columns that were found") {
        CHECK(has(Written("time [s],depth [mm]\n0,1\n1,2\n").refusal(),
                  "expected a column that looks like axial_strain or axial_displacement_m, found "
                  "\"time [s]\", \"depth [mm]\""));
        CHECK(has(Written("load,displacement [mm]\n0,1\n1,2\n").refusal(),
                  "expected a unit for each column, found none for axial_force_N"));
    }

    TEST_CASE("the sand tests of others are read as they are") {
        const fs::path folder = testing::shared_data(BRIS_SOURCE, "triaxial_sand");
        if (folder.empty()) return;
        for (int k = 1; k <= 3; ++k) {
            Written file("");
            file.test.file = folder / fmt::format("CID-REC-{}.csv", k);
            file.test.pressure = 50e3 * (1 << (k - 1));
            const LaboratoryCurves read = file.read();
            CHECK(read.curves.size() > 150);
            CHECK(read.curves[quantity::axial_strain].back() > 0.05);
        }
    }
}
