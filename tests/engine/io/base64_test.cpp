#include "engine/io/base64.hpp"
#include "engine/random.hpp"

#include <doctest/doctest.h>

#include <string>
#include <utility>

using namespace bris;

TEST_SUITE("engine/io/base64") {
    TEST_CASE("the examples of RFC 4648") {
        const std::pair<const char*, const char*> examples[] = {{"", ""},
                                                                {"f", "Zg=="},
                                                                {"fo", "Zm8="},
                                                                {"foo", "Zm9v"},
                                                                {"foob", "Zm9vYg=="},
                                                                {"fooba", "Zm9vYmE="},
                                                                {"foobar", "Zm9vYmFy"}};
        for (const auto& [bytes, text] : examples) {
            CHECK(to_base64(bytes) == text);
            CHECK(from_base64(text) == bytes);
        }
    }

    TEST_CASE("all bytes come back, and what is no such text is none") {
        Random random(1, 2);
        for (std::size_t size = 0; size < 200; ++size) {
            std::string bytes;
            while (bytes.size() < size) bytes += static_cast<char>(random.bits());
            CHECK(from_base64(to_base64(bytes)) == bytes);
        }
        for (const char* wrong :
             {"Z", "Zg", "Zg=", "=", "====", "Zg==Zg==", "Z===", "Zm9%", "Zm 9", "Zh==", "Zm9="})
            CHECK_FALSE(from_base64(wrong));
    }
}
