#include "scenarios/monitoring/publisher.hpp"

#include <doctest/doctest.h>

#include <cstring>

using namespace bris;

namespace {

template <class T>
T number_at(const std::string& bytes, std::size_t place) {
    T number;
    std::memcpy(&number, bytes.data() + place, sizeof number);
    return number;
}

} // namespace

TEST_SUITE("monitoring/publisher") {
    TEST_CASE("poses are published in parts below 4 kB that hold every body once") {
        constexpr std::size_t bodies = 401;
        BodyFrame frame;
        frame.time = 0.0125;
        for (std::size_t b = 0; b < bodies; ++b) {
            const auto x = static_cast<double>(b);
            frame.ids.push_back(static_cast<std::int64_t>(b));
            frame.positions.emplace_back(x, x + 0.25, x + 0.5);
            for (const float q : {0.5f, -0.5f, 0.5f, -0.5f}) frame.orientations.push_back(q);
        }
        std::size_t next = 0;
        for (const std::string& part : parts_of_poses(frame)) {
            CHECK(part.size() < 4096);
            REQUIRE((part.size() - 20) % 28 == 0);
            CHECK(number_at<std::uint8_t>(part, 0) == 2);
            CHECK(number_at<std::uint32_t>(part, 4) == bodies);
            CHECK(number_at<double>(part, 8) == 0.0125);
            CHECK(number_at<std::uint32_t>(part, 16) == next);
            for (std::size_t at = 20; at < part.size(); at += 28, ++next) {
                CHECK(number_at<float>(part, at + 8) == static_cast<float>(next) + 0.5f);
                CHECK(number_at<float>(part, at + 16) == -0.5f); // qx
            }
        }
        CHECK(next == bodies);
    }
}
