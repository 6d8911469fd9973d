#include "engine/report.hpp"

#include <doctest/doctest.h>
#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <stdexcept>
#include <string>

using namespace bris;

TEST_SUITE("engine/report") {
    TEST_CASE("people see what is shown, in words, with three digits and bands") {
        Report report;
        report.add("peak_q_Pa", 284321.0);
        report.add("peak_q_low_Pa", 250999.0);
        report.add("peak_q_high_Pa", 1.2e6);
        report.add("wall_time_s", 0.0123456);
        report.add("not_for_people", 1);
        report.add("bodies", 1234567u);
        report.add("unknown", -std::numeric_limits<double>::quiet_NaN());
        report.show({"peak_q_Pa", "bodies", "wall_time_s", "unknown"});
        report.show_sentence("The result is extrapolated.");
        CHECK(report.text("triaxial", "Results are in x.") ==
              "triaxial\n  peak q     284 (251 to 1200) kPa\n  bodies     1234567\n"
              "  wall time  12.3 ms\n  unknown    -\nThe result is extrapolated.\n"
              "Results are in x.\n");
        CHECK_THROWS_AS(report.show({"peak_q"}), std::logic_error);
    }

    TEST_CASE("numbers are short") {
        CHECK(three_digits(0) == "0");
        CHECK(three_digits(12345.6) == "12300");
        CHECK(three_digits(999.6) == "1000");
        CHECK(three_digits(-0.0123456) == "-0.0123");
        CHECK(three_digits(3.3e9) == "3.3e+09");
        CHECK(three_digits(5.41705e7, "N/m") == "54.2 MN/m");
        CHECK(three_digits(999.96e3, "Pa") == "1 MPa");
        CHECK(three_digits(0.00002, "m") == "20 um");
        CHECK(three_digits(7200, "s") == "7200 s");
        CHECK(three_digits(-0.0, "m") == "0 m");
        CHECK(three_digits(std::numeric_limits<double>::quiet_NaN(), "m") == "-");
    }

    TEST_CASE("parts are columns, and many parts are lines") {
        Report all, few;
        for (const char* name : {"55kPa", "110kPa"}) {
            Report part;
            part.add("peak_q_Pa", 1e5);
            part.show({"peak_q_Pa"});
            if (std::string(name) == "110kPa") part.show_row("sensors", "9 of 10");
            all.add_part(name, part);
        }
        all.add("rocks", 400);
        all.show({"rocks"});
        CHECK(all.entries()[1].key == "110kPa_peak_q_Pa");
        CHECK(all.text("t", "l") == "t\n           55kPa    110kPa\n  peak q   100 kPa  100 kPa\n"
                                    "  sensors  -        9 of 10\n  rocks    400\nl\n");
        for (int k = 1; k <= 6; ++k) {
            Report part;
            part.add("verdict", "changed");
            part.show({"verdict"});
            few.add_part(fmt::format("sensor_{}", k), part);
        }
        CHECK(few.text("t", "l").starts_with("t\n            verdict\n  sensor 1  changed\n"));
    }

    TEST_CASE("what does not fit into 25 lines is left out") {
        Report report;
        for (int k = 0; k < 100; ++k) report.add(fmt::format("number_{}", k), k);
        const auto lines = [&] {
            return static_cast<std::size_t>(std::ranges::count(report.text("t", "l"), '\n'));
        };
        CHECK(lines() == Report::most_lines);
        CHECK(report.text("t", "l").find("\n  78 more in summary.json\n") != std::string::npos);
        report.show_sentence("\n\na\n\nb\n");
        for (int k = 0; k < 100; ++k) report.show_sentence("sentence");
        CHECK(lines() == Report::most_lines);
    }
}
