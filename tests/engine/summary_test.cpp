#include "engine/errors.hpp"
#include "engine/io/whole_file.hpp"
#include "engine/summary.hpp"
#include "engine/version.hpp"
#include "tests/temporary_directory.hpp"

#include <doctest/doctest.h>
#include <fmt/format.h>

#include <cstdlib>
#include <limits>

using namespace bris;

TEST_SUITE("engine/summary") {
    TEST_CASE("the file is one flat object in the order of adding") {
        Summary summary;
        summary.add("scenario", "triaxial");
        summary.add("bodies", 4000u);
        summary.add("done", true);
        summary.add("shift_m", -0.5);
        summary.add("unknown", std::numeric_limits<double>::quiet_NaN());
        summary.add("endless", std::numeric_limits<double>::infinity());
        summary.add("text", "a \"b\"\n\\");
        summary.add("bodies", 3999u);
        CHECK(summary.json() == "{\n  \"scenario\": \"triaxial\",\n  \"bodies\": 3999,\n"
                                "  \"done\": true,\n  \"shift_m\": -0.5,\n  \"unknown\": null,\n"
                                "  \"endless\": null,\n  \"text\": \"a \\\"b\\\"\\n\\\\\"\n}\n");
    }

    TEST_CASE("doubles read back to the same bits") {
        for (const double x :
             {1.0 / 3, 1e-300, 6.02214076e23, -0.1, 5e-324, 1e16, 9007199254740993.0,
              2.2250738585072011e-308, 1.7976931348623157e308, 3.0}) {
            Summary summary;
            summary.add("x", x);
            const std::string json = summary.json();
            CHECK(std::strtod(json.c_str() + json.find(':') + 1, nullptr) == x);
        }
    }

    TEST_CASE("what is no UTF-8, as a name of a file may be, is replaced") {
        Summary summary;
        summary.add("path", "a\xff.csv");
        CHECK(summary.json() == "{\n  \"path\": \"a\xef\xbf\xbd.csv\"\n}\n");
    }

    TEST_CASE("the file replaces the old one, or the error says why not") {
        const TemporaryDirectory directory;
        Summary summary;
        summary.add("a", 1);
        write_whole(directory / "summary.json", "old");
        summary.write(directory / "summary.json");
        const std::string written = read_whole(directory / "summary.json");
        CHECK(written.starts_with("{\n  \"a\": 1,\n  \"bris_version\": \""));
        CHECK(written.ends_with("\"\n}\n"));
        for (const NamedValue& entry : version_entries())
            CHECK(written.find(fmt::format("\n  \"{}\": \"", entry.key)) != std::string::npos);
        CHECK_THROWS_AS(summary.write("/proc/none/summary.json"), OutputError);
    }
}
