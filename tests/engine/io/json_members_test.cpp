#include "engine/errors.hpp"
#include "engine/io/json_members.hpp"
#include "tests/temporary_directory.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <utility>
#include <vector>

using namespace bris;

namespace {

using All = std::vector<std::pair<std::string, std::string>>;

All members_of(const std::string& text) {
    All all;
    JsonMembers members(text);
    while (const auto member = members.next())
        all.emplace_back(std::string(member->name), std::string(member->value));
    return all;
}

std::string complaint(const std::string& text) {
    return message_of<InputError>([&] { (void)members_of(text); });
}

} // namespace

TEST_SUITE("engine/io/json_members") {
    TEST_CASE("members come with their values as they are written, whatever these hold") {
        CHECK(members_of(R"( {"a": 0.1, "b":-3 , "c": "2.5e-3", "d": null} )") ==
              All{{"a", "0.1"}, {"b", "-3"}, {"c", "\"2.5e-3\""}, {"d", "null"}});
        CHECK(members_of("{}").empty());
        CHECK(members_of(R"({"a": [1, {"b": "]\"}"}, []], "c": {"a": NaN}, "d": -Infinity})") ==
              All{{"a", R"([1, {"b": "]\"}"}, []])"}, {"c", R"({"a": NaN})"}, {"d", "-Infinity"}});
        CHECK(members_of(R"({"\u0061x": 1, "\\": "ü)"
                         "\xff\"}") == All{{"ax", "1"}, {"\\", "\"ü\xff\""}});
        const std::string deep(1 << 20, '[');
        CHECK(members_of("{\"a\": " + deep + std::string(1 << 20, ']') + ", \"b\": 1}").size() ==
              2);
    }

    TEST_CASE("numbers come to the same bits, in quotes too; what is no number is none") {
        CHECK(json_number("0.1") == 0.1);
        CHECK(json_number("-2.5E+3") == -2500.0);
        CHECK(json_number("9007199254740993") == 9007199254740992.0);
        CHECK(json_number("5e-324") == 5e-324);
        CHECK(json_number("18446744073709551615") == 18446744073709551616.0);
        CHECK(json_number("\"2.5e-3\"") == 2.5e-3);
        CHECK(std::isnan(json_number("\"nan\"").value()));
        for (const char* wrong : {"", "-", "NaN", "nan", "-Infinity", "inf", "1e999", "true",
                                  "null", "\"\"", "\"warm\"", "1.5.2", "[1]", "{}", "1 2"}) {
            CAPTURE(wrong);
            CHECK_FALSE(json_number(wrong));
        }
    }

    TEST_CASE("strings come without their escapes") {
        CHECK(json_text(R"("a\"b\\\n\u00fc")") == "a\"b\\\nü");
        CHECK_FALSE(json_text("5"));
        CHECK_FALSE(json_text("\"\xff\""));
        CHECK_FALSE(json_text(R"("\q")"));
    }

    TEST_CASE("what is no object is refused, and the message says what was found") {
        CHECK(complaint(R"({"t": 1, )") == "expected an object of JSON, found \"{\"t\": 1, \" "
                                           "(unexpected end at character 10)");
        CHECK(complaint("5") == "expected an object of JSON, found \"5\" (expected '{' at "
                                "character 1)");
        for (const char* wrong :
             {"", "null", "[1]", "{", "{\"t\"", "{\"t\"}", "{\"t\": }", "{\"t\": 1} more",
              "{\"t\": 1 \"u\": 2}", "{\"t\": 1,}", "{t: 1}", "{\"t\": [1}}", "{\"t\": \"x}",
              "{\"t\": \"x\\", "{\"t\": [1, ", "{\"t\": -9{\"t\": 2}", "{\"t\": 1,, \"u\": 2}"}) {
            CAPTURE(wrong);
            CHECK(complaint(wrong).starts_with("expected an object of JSON, found"));
        }
        CHECK(complaint(std::string(1 << 20, '[')).size() < 200);
        CHECK(complaint("{\"a\": \"" + std::string(1 << 20, 'x')).size() < 200);
    }
}
