#include "engine/errors.hpp"
#include "engine/printable.hpp"

#include <doctest/doctest.h>

#include <string>

using namespace bris;

TEST_SUITE("engine/printable") {
    TEST_CASE("text of any language stays, and what could control a terminal becomes visible") {
        CHECK(printable("55 kPa, Schotter, \u00b5m, \u9053\u7823, \U0001F682") ==
              "55 kPa, Schotter, \u00b5m, \u9053\u7823, \U0001F682");
        CHECK(printable("\x1b[31mred\x07\x7f\n") == "\\x1b[31mred\\x07\\x7f\\x0a");
        CHECK(printable("\xff\xc3") == "\\xff\\xc3");          // not UTF-8, and cut off
        CHECK(printable("\xc0\xaf") == "\\xc0\\xaf");          // an overlong slash
        CHECK(printable("\xed\xa0\x80") == "\\xed\\xa0\\x80"); // half of a surrogate pair
        CHECK(printable("\xc2\x9b") == "\\xc2\\x9b");          // a control character of 8 bits
        CHECK(printable("a\u202eb") == "a\\xe2\\x80\\xaeb");   // reverses the text after it
        CHECK(printable(std::string_view("\0", 1)) == "\\x00");
    }

    TEST_CASE("the message of an error does not end at a zero byte of a file that it cites") {
        using namespace std::string_literals;
        CHECK(InputError("a.stl:1: found \"so\0lid\""s).what() == "a.stl:1: found \"so\\x00lid\""s);
    }
}
