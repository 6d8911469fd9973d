#include "engine/io/signs_of_life.hpp"

#include <doctest/doctest.h>

#include <cmath>

using namespace bris;

namespace {

bool has(const std::string& text, const std::string& part) {
    return text.find(part) != std::string::npos;
}

} // namespace

TEST_SUITE("engine/io/signs_of_life") {
    TEST_CASE("a heartbeat says what a run does, how long it takes, and whether it has ended") {
        SignsOfLife life("monitor");
        CHECK(life.topic() == "bris/run/monitor");
        CHECK(life.is_due());
        const std::string first = life.heartbeat(1e9);
        CHECK(has(first, R"("state":"running")"));
        CHECK(has(first, R"("beat":1)"));
        CHECK(has(first, R"("left_s":null)"));
        CHECK_FALSE(life.is_due()); // within its second
        life.report("making the \"specimen\"", 42);
        const std::string second = life.heartbeat(1e9 + 1);
        CHECK(has(second, R"("doing":"making the \"specimen\"")"));
        CHECK(has(second, R"("left_s":42)"));
        CHECK(has(second, R"("began":1000000000.0)"));
        CHECK(has(life.heartbeat(1e9 + 2, true), R"("state":"stopped")"));
        life.end();
        CHECK(has(life.heartbeat(1e9 + 3, true), R"("state":"ended")"));
    }

    TEST_CASE("the name of a run is a part of a topic whatever it contains") {
        CHECK(SignsOfLife("a/b+c#d\n\xc3\xa4").topic() == "bris/run/a_b_c_d___");
        CHECK(SignsOfLife(std::string(1000, 'x')).topic().size() < 80);
        CHECK(has(SignsOfLife("x").heartbeat(NAN), R"("time":null)"));
    }
}
