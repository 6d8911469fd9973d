#pragma once

#include <string>
#include <vector>

namespace bris {

/// A run of table 1 of H. Huang, Ballast Real-time Information System, Rail Safety IDEA Project 30
/// (2019): eight groups I.1 to II.4 of tests on a full-scale section of track.
struct BoxTest {
    std::string name;
    bool fouled, wet, confined;      ///< confined: the bladders are inflated and act as shoulder
    double peak_load;                ///< N, of each of the two actuators
    std::vector<double> frequencies; ///< Hz
};

inline constexpr double actuator_limit = 490e3; ///< N, of each actuator

const std::vector<BoxTest>& table_1();

/// The test of that name. Throws InputError.
const BoxTest& box_test(const std::string& name);

} // namespace bris
