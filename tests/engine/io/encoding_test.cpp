#include "engine/errors.hpp"
#include "engine/io/csv.hpp"
#include "engine/io/encoding.hpp"
#include "engine/io/whole_file.hpp"
#include "tests/engine/io/encoded.hpp"
#include "tests/temporary_directory.hpp"

#include <doctest/doctest.h>

using namespace bris;
using namespace std::string_literals;
using testing::encoded, testing::encodings;

TEST_SUITE("engine/io/encoding") {
    TEST_CASE("the same text is read from UTF-8, with and without a mark, Latin-1 and UTF-16 of "
              "both byte orders") {
        const std::string text = "Zeit [ms];gx [\u00b0/s];T [\u00b0C];a [m/s\u00b2];\u00b5\n0;1\n";
        for (const std::string& encoding : encodings()) {
            CAPTURE(encoding);
            CHECK(as_utf8(encoded(text, encoding)) == text);
        }
    }

    TEST_CASE("UTF-16 without a mark, characters outside the first plane, and Windows-1252") {
        CHECK(as_utf8("t\0,\0i\0d\0"s) == "t,id");
        CHECK(as_utf8("\0t\0,\0i\0d"s) == "t,id");
        CHECK(as_utf8("\xff\xfe\x3d\xd8\x00\xde"s) == "\xf0\x9f\x98\x80");
        CHECK(as_utf8("\x80 \x96 \xff"s) == "\u20ac \u2013 \u00ff");
        CHECK(as_utf8("\xf0\x9f\x98\x80 \u2013 \u00b0"s) == "\xf0\x9f\x98\x80 \u2013 \u00b0");
    }

    TEST_CASE("damaged texts become replacements or characters of one byte, and are read to the "
              "end") {
        CHECK(as_utf8("\xff\xfe\x3d\xd8t\0"s) == "\ufffdt");     // half a character
        CHECK(as_utf8("\xff\xfet\0\x3d"s) == "t\ufffd");         // half a unit
        CHECK(as_utf8("t \xc2"s) == "t \u00c2");                 // cut
        CHECK(as_utf8("\xc0\xaf"s) == "\u00c0\u00af");           // overlong
        CHECK(as_utf8("\xed\xa0\x80"s) == "\u00ed\u00a0\u20ac"); // a surrogate
        CHECK(as_utf8("") == "");
        CHECK(as_utf8("\0\0\0\0"s) == "\0\0\0\0"s); // no text
    }

    TEST_CASE("UTF-32 is named in the refusal of a file") {
        const TemporaryDirectory folder;
        write_whole(folder / "a.csv", "\xff\xfe\0\0t\0\0\0"s);
        CHECK(message_of<InputError>([&] { (void)read_csv(folder / "a.csv"); }) ==
              (folder / "a.csv").string() +
                  ": expected a text in UTF-8, UTF-16 or Latin-1, found UTF-32");
    }
}
