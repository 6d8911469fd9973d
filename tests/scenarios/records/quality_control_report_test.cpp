#include "scenarios/records/machine_quality_control.hpp"
#include "scenarios/records/quality_control_report.hpp"

#include <doctest/doctest.h>

#include <cmath>

using namespace bris;

namespace {

/// A test with sensors of two samples, and a machine that measured q and the volumetric strain.
RecordedTest test_of(const std::vector<unsigned>& ids) {
    RecordedTest test;
    for (const unsigned id : ids) {
        Recording& r = test.recordings.emplace_back();
        r.info.id = id;
        r.time = {0, 1};
        r.force.assign(2, Vec3(0, 0, 9.81));
    }
    for (const double strain : {0.0, 0.01}) {
        const auto p = test.curves.add_row();
        p[quantity::axial_strain] = strain;
        p[quantity::deviatoric_stress] = 1e7 * strain;
    }
    return test;
}

void refuse(RecordedTest& test, unsigned sensor, const std::string& check = "gravity") {
    test.findings.push_back({Finding::Kind::refusal, sensor, check, "expected this, found that"});
}

} // namespace

TEST_SUITE("records/quality_control_report") {
    TEST_CASE("every sensor is said to be accepted or refused, and equal findings share a line") {
        RecordedTest test = test_of({0, 1, 2, 3, 5, 7, 8});
        refuse(test, 3);
        refuse(test, 7);
        for (const unsigned id : {0u, 1u, 2u, 8u})
            test.findings.push_back({Finding::Kind::note, id, "clock", "runs fast"});
        test.findings.push_back({Finding::Kind::note, 5, "clock", "runs slowly"});
        CHECK(quality_control_report(test) ==
              "test machine: accepted, 2 records\n"
              "sensors 0 to 2, 5, 8: accepted, 2 samples\n"
              "sensors 3, 7: refused: gravity: expected this, found that\n"
              "sensors 0 to 2, 8: clock: runs fast\n"
              "sensor 5: clock: runs slowly\n");
    }

    TEST_CASE("refused channels of the machine are named, with those that have the same fault") {
        RecordedTest test = test_of({1});
        CHECK(refused_channels(test) == "none");
        refuse(test, test_machine, "ring_1_radius_m");
        refuse(test, test_machine, "ring_2_radius_m");
        CHECK(refused_channels(test) == "ring_1_radius_m, ring_2_radius_m");
        CHECK(quality_control_report(test).starts_with(
            "test machine: accepted, 2 records, except ring_1_radius_m, ring_2_radius_m\n"
            "test machine: refused: ring_1_radius_m, ring_2_radius_m: expected this, found that\n"
            "sensor 1: accepted, 2 samples\n"));
    }

    TEST_CASE("the verdict for the screen says what is refused, and what the model can still learn "
              "from") {
        RecordedTest test = test_of({1, 2, 3});
        CHECK(verdict_on(test) == "all 3 sensors are accepted; the test machine is accepted");
        refuse(test, 2);
        refuse(test, test_machine, "deviatoric_stress_Pa");
        CHECK(verdict_on(test) == "2 of 3 sensors are accepted, refused: sensor 2; refused and not "
                                  "used of the test machine: deviatoric_stress_Pa");
        refuse(test, 1);
        refuse(test, 3);
        CHECK(verdict_on(test).starts_with("all 3 sensors are refused; "));
        CHECK(verdict_on(test).ends_with("; the model learns from the test machine alone"));
        for (double& q : test.curves[quantity::deviatoric_stress]) q = std::nan("");
        CHECK(verdict_on(test).ends_with("; nothing is left that the model could learn from"));
    }

    TEST_CASE("the table of observability has units, and a row for all sensors that are alike") {
        RecordedTest test = test_of({1, 2, 3});
        const std::string text = observability_report(test, 960, 1e-3, 0.1);
        CHECK(text.find("deviation: standard deviation") != std::string::npos);
        CHECK(text.find("gain: share of the model's variance") != std::string::npos);
        const auto row = [&](const std::string& words) { // whatever the widths of the columns
            std::string squeezed;
            for (const char c : text)
                if (c != ' ' || !squeezed.ends_with(' ')) squeezed += c;
            return squeezed.find(words) != std::string::npos;
        };
        CHECK(row("\n1 to 3 tilt gravity 0.0018 rad 0.1 rad 1.00 observable\n"));
        CHECK(row("\n1 to 3 yaw nothing - rad 0.1 rad 0.00 not observable\n"));
        refuse(test, 2);
        CHECK(observability_report(test, 960, 1e-3, 0.1).find("1, 3           tilt") !=
              std::string::npos);
        refuse(test, 1);
        refuse(test, 3);
        CHECK(observability_report(test, 960, 1e-3, 0.1) ==
              "No sensor is accepted, so none observes anything.\n");
    }
}
