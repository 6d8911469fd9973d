#include "engine/errors.hpp"
#include "engine/random.hpp"
#include "scenarios/sensors/channels.hpp"
#include "scenarios/stream/record_stream.hpp"
#include "tests/temporary_directory.hpp"

#include <doctest/doctest.h>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

using namespace bris;

namespace {

using Numbers = std::vector<std::pair<std::string_view, double>>;

LineSource::Line line(const std::string& text, bool whole = true) {
    return {7, text, this_instant(), whole};
}

std::size_t below(Random& random, std::size_t n) { return random.bits() % n; }

/// Values that fields may hold that nobody uses.
const std::vector<std::string>& strange_values() {
    static const std::vector<std::string> all{
        R"("1.2.3")",   "true",        "false",     "null",        "NaN",
        "1e999",        R"([1, [2]])", "{}",        R"({"t": 5})", "[]",
        R"("a\"}, b")", "\"\xe4\"",    "-Infinity", R"("")",       "17"};
    return all;
}

/// A record as a line of JSON or as a row, with strange members or columns between its numbers.
struct Sent {
    std::vector<std::string> names;
    std::vector<double> numbers;
    std::string json(Random& random, bool strange) const {
        std::vector<std::string> members;
        for (std::size_t k = 0; k < names.size(); ++k)
            members.push_back(fmt::format("\"{}\": {}", names[k], numbers[k]));
        for (int n = 0; strange && n < 4; ++n)
            members.insert(members.begin() +
                               static_cast<std::ptrdiff_t>(below(random, members.size() + 1)),
                           fmt::format("\"unknown_{}\": {}", below(random, 9),
                                       strange_values()[below(random, strange_values().size())]));
        return fmt::format("{{{}}}", fmt::join(members, below(random, 2) == 0 ? ", " : ","));
    }
};

} // namespace

TEST_SUITE("stream/record_stream") {
    TEST_CASE("a stream may contain JSON objects, CSV rows, or both") {
        RecordParser parser;
        const auto json = parser.parse(line(R"( {"t": 1.5, "id": 3, "ax": -9.81e0, "ux": null})"));
        REQUIRE(json);
        CHECK(json->line == 7);
        CHECK(json->numbers() == Numbers{{"t", 1.5}, {"id", 3}, {"ax", -9.81}});
        CHECK(std::isnan(json->number("ux")));
        CHECK_FALSE(json->has("ux"));
        CHECK(json->has("ax"));
        CHECK(parser.parse(line("\xef\xbb\xbf{\"t\": 2}"))->number("t") == 2); // saved by an editor
        CHECK_FALSE(parser.parse(line("")));
        CHECK_FALSE(parser.parse(line("# a comment")));
        CHECK_FALSE(parser.parse(line("t, id, ax, ay")));
        const auto row = parser.parse(line("2, 4, -, 0.25\r"));
        REQUIRE(row);
        CHECK(row->numbers() == Numbers{{"t", 2}, {"id", 4}, {"ay", 0.25}});
        CHECK(parser.parse(line(R"({"axial_strain": 0.01, "deviatoric_stress_Pa": 1e5})"))
                  ->number("deviatoric_stress_Pa") == 1e5);
        CHECK_FALSE(parser.parse(line("axial_strain,deviatoric_stress_Pa"))); // columns change
        CHECK(parser.parse(line("0.02,2e5"))->number("axial_strain") == 0.02);
        CHECK(parser.ignored().empty());
    }

    TEST_CASE("fields that nobody uses are ignored, whatever they hold, and named once") {
        for (const std::string& value : strange_values()) {
            CAPTURE(value);
            RecordParser parser;
            for (int n = 0; n < 3; ++n) {
                const auto record =
                    parser.parse(line(R"({"id": 1, "fw": )" + value + R"(, "t": 0, "ax": 0.1})"));
                REQUIRE(record);
                CHECK(record->numbers() == Numbers{{"t", 0}, {"id", 1}, {"ax", 0.1}});
            }
            CHECK(parser.ignored() == "fields that nobody uses are ignored: fw\n");
        }
        RecordParser rows;
        CHECK_FALSE(rows.parse(line("id,clock,t,state,ax")));
        CHECK(rows.parse(line("1,12:30:01,5,t,0.1"))->numbers() ==
              Numbers{{"t", 5}, {"id", 1}, {"ax", 0.1}}); // "t" in a row makes it no header
        CHECK(rows.ignored() == "fields that nobody uses are ignored: clock, state\n");
        RecordParser of_machine({"t", "axial_strain"});
        CHECK(of_machine.parse(line(R"({"t": 1, "axial_strain": 0, "temp": "warm"})"))->numbers() ==
              Numbers{{"t", 1}, {"axial_strain", 0}});
    }

    TEST_CASE("the list of ignored fields is short, however many there are") {
        RecordParser parser;
        for (int n = 0; n < 1000; ++n)
            CHECK(parser.parse(line(fmt::format("{{\"t\": {0}, \"key\x1b_{0}\": 1}}", n))));
        CHECK(parser.ignored().ends_with(" and others\n"));
        CHECK(parser.ignored().size() < 500);
        CHECK(parser.ignored().find('\x1b') == std::string::npos);
    }

    TEST_CASE("unknown members and columns anywhere give the same records") {
        Random random(62, 7);
        for (int trial = 0; trial < 300; ++trial) {
            Sent sent;
            for (const std::string_view name : stream_fields) {
                if (name == "t" || below(random, 6) == 0) {
                    sent.names.emplace_back(name);
                    sent.numbers.push_back(std::ldexp(random.uniform(-1, 1),
                                                      static_cast<int>(below(random, 60)) - 30));
                }
            }
            RecordParser plain, other, rows;
            const auto expected = plain.parse(line(sent.json(random, false)));
            const auto found = other.parse(line(sent.json(random, true)));
            REQUIRE(found);
            CHECK(found->numbers() == expected->numbers());
            std::vector<std::string> names = sent.names, cells;
            for (const double number : sent.numbers) cells.push_back(fmt::format("{}", number));
            for (const char* text : {"clean", "12:30:05", "", "\"a, b\"", "t"}) {
                const auto at = static_cast<std::ptrdiff_t>(below(random, names.size() + 1));
                names.insert(names.begin() + at, fmt::format("unknown_{}", below(random, 9)));
                cells.insert(cells.begin() + at, text);
            }
            CHECK_FALSE(rows.parse(line(fmt::format("{}", fmt::join(names, ",")))));
            CHECK(rows.parse(line(fmt::format("{}", fmt::join(cells, ","))))->numbers() ==
                  expected->numbers());
        }
    }

    TEST_CASE("a stream can have every channel, and no name stands twice") {
        RecordParser parser;
        for (const std::string_view column : channel_columns)
            CHECK(parser.parse(line(fmt::format("{{\"{}\": 1}}", column)))->has(column));
        for (const std::string_view name : stream_fields)
            CHECK(std::ranges::count(stream_fields, name) == 1);
    }

    TEST_CASE("a line that is not a record is refused with its number, what was expected and what "
              "was found") {
        const auto why = [](const std::string& text, const std::string& header = "",
                            bool whole = true) {
            RecordParser parser;
            if (!header.empty()) (void)parser.parse(line(header));
            return message_of<InputError>([&] { (void)parser.parse(line(text, whole)); });
        };
        CHECK(why("hello") ==
              "line 7: expected a JSON object or the names of columns, found \"hello\"");
        CHECK(why("1,2", "t,id,ax") == "line 7: expected 3 columns, found 2");
        CHECK(why("1,x", "t,id") == "line 7: id: expected a number, found \"x\"");
        CHECK(why("t,ax,ax") == "line 7: ax: expected once, found twice");
        CHECK(
            why("{\"t\": 1, ").find("line 7: expected an object of JSON, found \"{\"t\": 1, \"") ==
            0);
        CHECK(why("{\"t\": 1} more").find("line 7: expected an object of JSON") == 0);
        CHECK(why("{\"t\": [1, 2]}") == "line 7: t: expected a number, found \"[1, 2]\"");
        CHECK(why("{\"t\": {\"s\": 1}}").find("line 7: t: expected a number, found") == 0);
        CHECK(why("{\"t\": 1, \"ax\": NaN}") == "line 7: ax: expected a number, found \"NaN\"");
        CHECK(why("{\"t\": -Infinity}") == "line 7: t: expected a number, found \"-Infinity\"");
        CHECK(why("{\"t\": 1e999}") == "line 7: t: expected a number, found \"1e999\"");
        CHECK(why("{\"t\": true}") == "line 7: t: expected a number, found \"true\"");
        CHECK(why("{\"t\": \"\"}") == "line 7: t: expected a number, found \"\"\"\"");
        CHECK(why("{\"t\": 1, \"t\": 2}") == "line 7: t: expected once, found twice");
        CHECK(why("{\"t\": 1}", "", false).find("line 7: expected a whole line") == 0);
    }
}
