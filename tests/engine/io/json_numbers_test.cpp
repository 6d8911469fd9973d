#include "engine/errors.hpp"
#include "engine/io/json_numbers.hpp"
#include "tests/temporary_directory.hpp"

#include <doctest/doctest.h>

#include <cmath>

using namespace bris;

namespace {

std::string complaint(const std::string& text) {
    return message_of<InputError>([&] { (void)json_numbers(text); });
}

} // namespace

TEST_SUITE("engine/io/json_numbers") {
    TEST_CASE("numbers come to the same bits, in quotes too; null is left out") {
        const auto numbers =
            json_numbers(R"( {"a": 0.1, "b": -3, "c": "2.5e-3", "d": null, "e": 9007199254740993,
                              "f": 5e-324, "u\u00e9": 18446744073709551615} )");
        CHECK(numbers == std::map<std::string, double>{{"a", 0.1},
                                                       {"b", -3},
                                                       {"c", 2.5e-3},
                                                       {"e", 9007199254740992.0},
                                                       {"f", 5e-324},
                                                       {"u\xc3\xa9", 18446744073709551616.0}});
        CHECK(json_numbers("{}").empty());
    }

    TEST_CASE("what is no flat object of numbers is refused, and the message says what was found") {
        CHECK(complaint(R"({"t": 1, )") == "expected an object of JSON, found \"{\"t\": 1, \" "
                                           "(unexpected end of input at character 10)");
        CHECK(complaint("").starts_with("expected an object of JSON, found \"\" (unexpected end"));
        CHECK(complaint("5") == "expected an object of JSON, found \"5\"");
        CHECK(complaint("null") == "expected an object of JSON, found \"null\"");
        CHECK(complaint("[1]") == "expected a flat object of JSON, found \"[1]\"");
        CHECK(complaint(R"({"t": [1, 2]})") ==
              R"(expected a flat object of JSON, found "{"t": [1, 2]}")");
        CHECK(complaint(R"({"t": {"u": 1}})") ==
              R"(expected a flat object of JSON, found "{"t": {"u": 1}}")");
        CHECK(complaint(R"({"t": 1} more)").starts_with("expected an object of JSON, found"));
        CHECK(complaint(R"({"t": NaN})").starts_with("expected an object of JSON, found"));
        CHECK(complaint(R"({"t": 1e999})").find("number overflow") != std::string::npos);
        CHECK(complaint(R"({"t": "warm"})") == "t: expected a number, found \"warm\"");
        CHECK(complaint(R"({"t": ""})") == "t: expected a number, found \"\"");
        CHECK(complaint(R"({"t": true})") == "t: expected a number, found \"true\"");
        CHECK(complaint(R"({"t": 1, "t": 2})") == "t: expected once, found twice");
    }

    TEST_CASE("messages stay short, and what is nested deeply is refused at its second level") {
        CHECK(complaint(std::string(1 << 20, '[')).size() < 200);
        CHECK(complaint("{\"a\": \"" + std::string(1 << 20, 'x')).size() < 400);
        CHECK(complaint("{\"a\": 1e" + std::string(1 << 20, '9') + "}").size() < 400);
    }
}
