#pragma once

#include "engine/stopwatch.hpp"

#include <atomic>
#include <fstream>
#include <string>
#include <thread>

namespace bris {

/// Name of the processor; "unknown" where the system does not say.
inline std::string processor() {
    std::ifstream in("/proc/cpuinfo");
    for (std::string line; std::getline(in, line);)
        if (line.starts_with("model name") && line.find(": ") != std::string::npos)
            return line.substr(line.find(": ") + 2);
    return "unknown";
}

/// Time (s) in which a cache line goes from one thread to another and back; 0 on one processor.
/// Some 0.1 us if their cores share a cache, several times as long if not.
inline double line_round_trip() {
    if (std::thread::hardware_concurrency() < 2) return 0;
    constexpr int trips = 20000;
    std::atomic<int> turn{0};
    const auto wait_for = [&](int value) {
        for (int spins = 0; turn != value; ++spins)
            if (spins > 10000) std::this_thread::yield();
    };
    std::thread other([&] {
        for (int k = 0; k < trips; ++k) {
            wait_for(2 * k + 1);
            turn = 2 * k + 2;
        }
    });
    turn = 1;
    wait_for(2); // the other thread has begun
    const auto began = this_instant();
    for (int k = 1; k < trips; ++k) {
        turn = 2 * k + 1;
        wait_for(2 * k + 2);
    }
    const double seconds = seconds_since(began);
    other.join();
    return seconds / (trips - 1);
}

} // namespace bris
