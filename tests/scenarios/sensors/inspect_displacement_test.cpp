#include "engine/random.hpp"
#include "scenarios/records/quality_control_report.hpp"
#include "scenarios/sensors/inspection.hpp"
#include "tests/about.hpp"
#include "tests/scenarios/sensors/example_recordings.hpp"

#include <doctest/doctest.h>

using namespace bris;
using namespace bris::testing;

TEST_SUITE("sensors/inspect_displacement") {
    TEST_CASE("the shipped recordings are accepted at every stage of a test, without findings in "
              "displacement and attitude") {
        for (const char* pressure : {"55kPa", "110kPa", "165kPa"})
            for (const double strain : {0.0, 0.001, 0.002, 0.003, 0.005, 0.01, 0.02, 0.04, 0.08}) {
                const auto all = example_recordings(pressure, strain);
                const auto findings = check_test_records(all);
                CAPTURE(pressure);
                CAPTURE(strain);
                INFO(quality_control_report(findings, all));
                CHECK(std::ranges::all_of(findings, [](const Finding& f) {
                    return f.kind == Finding::Kind::note &&
                           (f.check == "clock" || has(f.text, "too few samples at rest"));
                }));
            }
    }

    TEST_CASE("a sensor whose strain is late by half a per cent is refused if its rock moves "
              "clearly, and no other") {
        for (const char* pressure : {"55kPa", "110kPa", "165kPa"})
            for (const std::size_t s : {5u, 6u, 8u, 9u}) { // the lower ones move less
                auto all = example_recordings(pressure);
                for (double& e : all[s].strain) e = std::max(0.0, e - 0.005);
                CAPTURE(pressure);
                CAPTURE(s);
                CHECK(has(refusals(all, static_cast<unsigned>(s + 1)),
                          "while its axial strain is 0"));
                CHECK(refusals(all, 1).empty());
            }
    }

    TEST_CASE("one component that is stuck while the others change is refused, but not where all "
              "change in coarse steps") {
        auto all = example_recordings("110kPa");
        for (std::size_t k = 20; k < all[3].size(); ++k) all[3].force[k].x() = all[3].force[20].x();
        for (std::size_t k = 20; k < all[4].size(); ++k)
            all[4].displacement[k].y() = all[4].displacement[20].y();
        CHECK(has(refusals(all, 4), "stuck: force: component x: expected noise"));
        CHECK(has(refusals(all, 5), "stuck: displacement: component y"));
        auto coarse = example_recordings("110kPa");
        for (Vec3& f : coarse[3].force) f = 0.05 * (f / 0.05).array().round().matrix();
        CHECK_FALSE(has(refusals(coarse, 4), "stuck: force: component"));
    }

    TEST_CASE("a displacement with far more noise than declared is refused, at rest and during the "
              "test") {
        auto all = example_recordings("55kPa");
        Random random(1, 1);
        for (std::size_t k = 5; k < all[4].size(); ++k)
            all[4].displacement[k] +=
                9e-3 *
                Vec3(2 * random.uniform() - 1, 2 * random.uniform() - 1, 2 * random.uniform() - 1);
        CHECK(has(refusals(all, 5),
                  "noise: displacement from sample to sample: declared 0.1 mm, found"));
        CHECK_FALSE(has(refusals(all, 5), "at rest"));
        for (std::size_t k = 0; k < 5; ++k)
            all[4].displacement[k] +=
                9e-3 *
                Vec3(2 * random.uniform() - 1, 2 * random.uniform() - 1, 2 * random.uniform() - 1);
        CHECK(has(refusals(all, 5), "noise: displacement at rest: declared 0.1 mm, found"));
    }

    TEST_CASE("moderately more noise than declared is reported, not refused") {
        auto all = example_recordings("55kPa");
        Random random(1, 1);
        for (Vec3& u : all[4].displacement)
            u += 6e-4 * Vec3(random.normal(), random.normal(), random.normal());
        CHECK(refusals(all, 5).empty());
        const auto findings = check_test_records(all);
        CHECK(std::ranges::any_of(findings, [](const Finding& f) {
            return f.sensor == 5 && f.check == "noise" &&
                   has(f.text, "displacement at rest: declared 0.1 mm");
        }));
    }

    TEST_CASE("a displacement that grows faster than the platen can drive a rock is refused "
              "soon") {
        auto all = example_recordings("55kPa", 0.006);
        for (std::size_t k = 5; k < all[4].size(); ++k)
            all[4].displacement[k].x() += 9 * all[4].strain[k]; // 9 mm for 0.1 %
        CHECK(has(refusals(all, 5), "displacement: in "));
        CHECK(has(refusals(all, 5), "larger than the axial strain permits"));
    }

    TEST_CASE("all checks remain when strain is sampled less often than displacement") {
        const auto sparse = [](std::vector<Recording> all) {
            for (Recording& r : all)
                for (std::size_t k = 0; k < r.size(); ++k)
                    if (k % 3 != 2) r.strain[k] = std::nan("");
            return all;
        };
        auto all = sparse(example_recordings("55kPa"));
        for (unsigned sensor = 1; sensor <= 10; ++sensor) CHECK(refusals(all, sensor).empty());
        Random random(1, 1);
        for (std::size_t k = 0; k < 5; ++k)
            all[4].displacement[k] +=
                9e-3 *
                Vec3(2 * random.uniform() - 1, 2 * random.uniform() - 1, 2 * random.uniform() - 1);
        CHECK(has(refusals(all, 5), "noise: displacement at rest: declared 0.1 mm, found"));
        all = sparse(example_recordings("55kPa"));
        const std::size_t first_outlier =
            all[4].size() - 20; // 7 of about 29 samples with strain, out of more than 80
        for (std::size_t k = first_outlier; k < all[4].size(); ++k)
            all[4].displacement[k].x() += 0.02 * static_cast<double>(k - first_outlier);
        CHECK(has(refusals(all, 5), "larger than the axial strain permits"));
    }

    TEST_CASE("the step of strain is computed between samples that have strain") {
        const double none = std::nan("");
        Recording r;
        r.strain = {0, none, 0, none, none, 3e-3, none, 5e-3, 6e-3, none};
        const QualityControlLimits limits;
        std::vector<Finding> findings;
        CHECK(strain_step({r, limits, findings, 5, 5}) == about(1e-3));
        r.strain = {0, 0, 1e-3, 2e-3, 3e-3};
        CHECK(strain_step({r, limits, findings, 2, 2}) == about(1e-3));
        r.strain = {none, none};
        CHECK(strain_step({r, limits, findings, 0, 0}) == 0);
    }

    TEST_CASE("a displacement that no laboratory has room for is refused, however few samples") {
        auto all = example_recordings("55kPa", 0.001);
        for (Vec3& u : all[0].displacement) u += Vec3(1e200, 0, 0);
        CHECK(has(refusals(all, 1), "displacement: expected at most 100 m, found 1e+200 m"));
    }

    TEST_CASE("a few outliers of the displacement are not refused") {
        auto all = example_recordings("55kPa");
        for (const std::size_t k : {3u, 20u, 41u, 60u}) all[4].displacement[k].y() += 0.03;
        CHECK(refusals(all, 5).empty());
    }
}
