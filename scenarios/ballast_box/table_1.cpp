#include "scenarios/ballast_box/table_1.hpp"

#include "engine/errors.hpp"

#include <algorithm>

namespace bris {

const std::vector<BoxTest>& table_1() {
    constexpr double passenger = 160e3, freight = 290e3;
    static const std::vector<BoxTest> tests = [] {
        std::vector<BoxTest> list;
        for (const bool fouled : {false, true}) {
            const std::string group = fouled ? "II." : "I.";
            list.push_back({group + "1", fouled, false, true, passenger, {1}});
            list.push_back({group + "2", fouled, false, true, freight, {0.2, 1, 2}});
            list.push_back({group + "3", fouled, true, true, freight, {1}});
            list.push_back({group + "4", fouled, true, false, freight, {1}});
        }
        return list;
    }();
    return tests;
}

const BoxTest& box_test(const std::string& name) {
    const auto found = std::ranges::find(table_1(), name, &BoxTest::name);
    require(found != table_1().end(),
            "--run: expected a run of table 1, I.1 to I.4 or II.1 to II.4, found '" + name + "'");
    return *found;
}

} // namespace bris
