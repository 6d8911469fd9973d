#include "engine/errors.hpp"
#include "scenarios/stream/record_stream.hpp"
#include "tests/temporary_directory.hpp"

#include <doctest/doctest.h>

#include <cmath>

using namespace bris;

namespace {

LineSource::Line line(const std::string& text, bool whole = true) {
    return {7, text, this_instant(), whole};
}

} // namespace

TEST_SUITE("stream/record_stream") {
    TEST_CASE("a stream may contain JSON objects, CSV rows, or both") {
        RecordParser parser;
        const auto json = parser.parse(line(R"( {"t": 1.5, "id": 3, "ax": -9.81e0, "ux": null})"));
        REQUIRE(json);
        CHECK(json->line == 7);
        CHECK(json->numbers == std::map<std::string, double>{{"t", 1.5}, {"id", 3}, {"ax", -9.81}});
        CHECK(std::isnan(json->number("ux")));
        CHECK(parser.parse(line("\xef\xbb\xbf{\"t\": 2}"))->number("t") == 2); // saved by an editor
        CHECK_FALSE(parser.parse(line("")));
        CHECK_FALSE(parser.parse(line("# a comment")));
        CHECK_FALSE(parser.parse(line("t, id, ax, ay")));
        const auto row = parser.parse(line("2, 4, -, 0.25\r"));
        REQUIRE(row);
        CHECK(row->numbers == std::map<std::string, double>{{"t", 2}, {"id", 4}, {"ay", 0.25}});
        CHECK(parser.parse(line(R"({"axial_strain": 0.01, "deviatoric_stress_Pa": 1e5})"))
                  ->number("deviatoric_stress_Pa") == 1e5);
        CHECK_FALSE(parser.parse(line("axial_strain,deviatoric_stress_Pa"))); // columns change
        CHECK(parser.parse(line("0.02,2e5"))->number("axial_strain") == 0.02);
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
        CHECK(
            why("{\"t\": 1, ").find("line 7: expected an object of JSON, found \"{\"t\": 1, \"") ==
            0);
        CHECK(why("{\"t\": 1} more").find("line 7: expected an object of JSON") == 0);
        CHECK(why("{\"t\": [1, 2]}") ==
              "line 7: expected a flat object of JSON, found \"{\"t\": [1, 2]}\"");
        CHECK(why("{\"t\": " + std::string(60000, '[')).find("line 7: expected a flat object") ==
              0);
        CHECK(why("{\"t\": {\"s\": 1}}").find("line 7: expected a flat object") == 0);
        CHECK(why("{\"t\": true}") == "line 7: t: expected a number, found \"true\"");
        CHECK(why("{\"t\": \"\"}") == "line 7: t: expected a number, found \"\"");
        CHECK(why("{\"t\": 1, \"t\": 2}") == "line 7: t: expected once, found twice");
        CHECK(why("{\"t\": 1}", "", false).find("line 7: expected a whole line") == 0);
    }
}
