#include "engine/assets.hpp"
#include "engine/random.hpp"
#include "scenarios/records/machine_quality_control.hpp"
#include "scenarios/records/recorded_test.hpp"

#include <doctest/doctest.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <map>
#include <string>

using namespace bris;

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

/// The example recording. Its rocks slip: q falls by up to 59 % from one record to the next.
const MeasuredCurves& example(double pressure) {
    static std::map<double, MeasuredCurves> tests;
    const std::filesystem::path folder = assets_folder() / "smartrock";
    if (!tests.contains(pressure))
        tests[pressure] =
            read_recorded_test(folder, pressure, read_sensor_infos(folder), {}).curves;
    return tests.at(pressure);
}

constexpr double pressures[] = {55e3, 110e3, 165e3};

/// The findings in the example at 55 kPa with changed rows.
struct CheckedTest {
    MeasuredCurves curves = example(55e3);
    std::vector<Finding> findings = {};

    void check() { findings = check_machine(curves, 55e3); }
    bool says(Finding::Kind kind, const std::string& check, const std::string& text) const {
        return std::ranges::any_of(findings, [&](const Finding& f) {
            return f.kind == kind && f.sensor == test_machine && f.check == check &&
                   f.text.find(text) != std::string::npos;
        });
    }
    bool refuses(const std::string& check, const std::string& text) const {
        return says(Finding::Kind::refusal, check, text);
    }
    bool notes(const std::string& check, const std::string& text) const {
        return says(Finding::Kind::note, check, text);
    }
    std::size_t without(const Quantity& quantity) const {
        return static_cast<std::size_t>(
            std::ranges::count_if(curves[quantity], [](double x) { return std::isnan(x); }));
    }
};

CheckedTest checked_test(auto&& change, std::size_t records = 801) {
    CheckedTest l;
    l.curves = MeasuredCurves(l.curves.rows_where([&](std::size_t k) { return k < records; }));
    for (std::size_t k = 0; k < records; ++k) change({l.curves, k}, k);
    l.check();
    return l;
}

std::string text_of(const std::vector<Finding>& findings) {
    std::string text;
    for (const Finding& f : findings) text += fmt::format("{}: {}\n", f.check, f.text);
    return text;
}

} // namespace

TEST_SUITE("records/machine_quality_control") {
    TEST_CASE("quality control finds and changes nothing in the example, at every stage and at "
              "every sampling interval") {
        for (const double pressure : pressures)
            for (const std::size_t every : {1u, 2u, 5u, 10u, 30u}) {
                const TestCurves all =
                    example(pressure).rows_where([&](std::size_t k) { return k % every == 0; });
                std::string found;
                bool untouched = true;
                for (std::size_t records = 0; records <= all.size(); ++records) {
                    const TestCurves before =
                        all.rows_where([&](std::size_t k) { return k < records; });
                    MeasuredCurves so_far(before);
                    found += text_of(check_machine(so_far, pressure));
                    for (const TestCurves::Column& c : before.columns())
                        untouched = untouched && so_far.column(*c.of, c.part).values == c.values;
                }
                CAPTURE(pressure);
                CAPTURE(every);
                CHECK(found == "");
                CHECK(untouched);
            }
    }

    TEST_CASE("a single outlier of q is left out wherever it is, and the others are kept") {
        for (const double wild : {1e12, -1e12, 1e300, infinity})
            for (const std::size_t at : {0u, 1u, 2u, 15u, 427u, 428u, 800u}) {
                const CheckedTest l = checked_test([&](const TestCurves::Row& p, std::size_t k) {
                    if (k == at) p[quantity::deviatoric_stress] = wild;
                });
                CAPTURE(wild);
                CAPTURE(at);
                CHECK(l.findings.size() == 1);
                CHECK(l.notes("deviatoric_stress_Pa",
                              fmt::format("1 of 801 records left out: expected -5.5e+04 to "
                                          "1.65e+06, found {:.4g} at {:.4g} % of axial strain",
                                          wild, 0.01 * static_cast<double>(at))));
                CHECK(std::isnan(l.curves[quantity::deviatoric_stress][at]));
                CHECK(l.without(quantity::deviatoric_stress) == 1);
            }
        for (const double factor : {10.0, 0.1, -1.0})
            for (const std::size_t at : {3u, 15u, 30u, 300u, 750u}) {
                const CheckedTest l = checked_test([&](const TestCurves::Row& p, std::size_t k) {
                    if (k == at) p[quantity::deviatoric_stress] *= factor;
                });
                CAPTURE(factor);
                CAPTURE(at);
                CHECK(l.findings.size() == 1);
                CHECK(l.notes("deviatoric_stress_Pa", "1 of 801 records left out: expected"));
                CHECK(l.without(quantity::deviatoric_stress) == 1);
                CHECK(std::isnan(l.curves[quantity::deviatoric_stress][at]));
            }
        // the last record times ten, as in a running test
        CHECK(std::isnan(checked_test(
                             [&](const TestCurves::Row& p, std::size_t k) {
                                 if (k == 15) p[quantity::deviatoric_stress] *= 10;
                             },
                             16)
                             .curves[quantity::deviatoric_stress][15]));
    }

    TEST_CASE("a drop of q of any size is accepted at once, a jump only when the next record "
              "confirms it") {
        for (const std::size_t records : {301u, 302u})
            CHECK(checked_test(
                      [](const TestCurves::Row& p, std::size_t k) {
                          if (k >= 300) p[quantity::deviatoric_stress] *= 0.05;
                      },
                      records)
                      .findings.empty());
        const auto leap = [](const TestCurves::Row& p, std::size_t k) {
            if (k >= 300) p[quantity::deviatoric_stress] *= 5;
        };
        CHECK(std::isnan(checked_test(leap, 301).curves[quantity::deviatoric_stress][300]));
        const CheckedTest later = checked_test(leap, 302);
        CHECK(later.findings.empty());
        CHECK(later.curves[quantity::deviatoric_stress][300] ==
              5 * example(55e3)[quantity::deviatoric_stress][300]);
    }

    TEST_CASE("a short burst of outliers is left out, a long one refuses the channel") {
        const auto burst = [](std::size_t length) {
            return checked_test([=](const TestCurves::Row& p, std::size_t k) {
                if (k >= 300 && k < 300 + length) p[quantity::deviatoric_stress] = 1e12;
            });
        };
        CHECK(burst(9).notes("deviatoric_stress_Pa", "9 of 801 records left out"));
        CHECK(burst(9).without(quantity::deviatoric_stress) == 9);
        CHECK(burst(10).refuses("deviatoric_stress_Pa", "10 of 801 records are impossible"));
        CHECK(burst(10).without(quantity::deviatoric_stress) == 801);
    }

    TEST_CASE("a channel q in another unit or sign is refused with the reason at the first strain "
              "that shows it") {
        const auto q_times = [](double factor, std::size_t records) {
            return checked_test([&](const TestCurves::Row& p,
                                    std::size_t) { p[quantity::deviatoric_stress] *= factor; },
                                records);
        };
        for (const std::size_t records : {801u, 23u}) {
            const CheckedTest kilo = q_times(1e-3, records);
            CHECK(kilo.refuses("deviatoric_stress_Pa", "is it in kPa?"));
            CHECK(kilo.without(quantity::deviatoric_stress) == records);
            CHECK(kilo.without(quantity::volumetric_strain) == 0);
        }
        CHECK(q_times(1.0 / 6895, 801)
                  .refuses("deviatoric_stress_Pa",
                           "expected at least 1100 Pa beyond 0.2 % of axial strain")); // psi
        CHECK(q_times(0, 801).refuses("deviatoric_stress_Pa", "found 0"));
        for (const std::size_t records : {801u, 4u}) {
            const CheckedTest negated = q_times(-1, records);
            CHECK(negated.refuses("deviatoric_stress_Pa", "is its sign reversed?"));
            CHECK(negated.without(quantity::deviatoric_stress) == records);
        }
        for (const double gain : {10.0, 1e3})
            CHECK(q_times(gain, 801).refuses("deviatoric_stress_Pa",
                                             "are impossible: expected -5.5e+04 to 1.65e+06"));
        // another unit from 0.1 % on
        CHECK(checked_test([](const TestCurves::Row& p, std::size_t k) {
                  if (k > 10) p[quantity::deviatoric_stress] *= 1e-3;
              }).refuses("deviatoric_stress_Pa", "is it in kPa?"));
    }

    TEST_CASE("an axial strain in another unit whose size is possible is noted by the stiffness") {
        const auto strain_times = [](double factor) {
            return checked_test([&](const TestCurves::Row& p, std::size_t) {
                p[quantity::axial_strain] *= factor;
            });
        };
        CHECK(strain_times(1).findings.empty());
        CHECK(strain_times(3).findings.empty());
        CHECK(strain_times(0.1).notes("axial_strain", "is the strain in another unit?"));
        const CheckedTest short_test = checked_test(
            [](const TestCurves::Row& p, std::size_t) { p[quantity::axial_strain] *= 100; },
            41); // to 0.4 %
        CHECK(short_test.notes("axial_strain", "is the strain in another unit?"));
    }

    TEST_CASE("q that is stuck while the strain increases is left out until it changes again") {
        const CheckedTest l = checked_test([](const TestCurves::Row& p, std::size_t k) {
            if (k >= 100 && k < 200) p[quantity::deviatoric_stress] = 2e5;
        });
        CHECK(l.findings.size() == 1);
        CHECK(l.notes("deviatoric_stress_Pa", "99 of 801 records left out: expected a change, "
                                              "found 2e+05 from 1 to 1.99 % of axial strain"));
        CHECK(l.curves[quantity::deviatoric_stress][100] == 2e5);
        CHECK(std::isnan(l.curves[quantity::deviatoric_stress][101]));
        CHECK(l.curves[quantity::deviatoric_stress][200] ==
              example(55e3)[quantity::deviatoric_stress][200]);
        CHECK(checked_test([](const TestCurves::Row& p, std::size_t k) {
                  if (k >= 100 && k < 105) p[quantity::deviatoric_stress] = 2e5;
              }).findings.empty());
        CHECK(checked_test([](const TestCurves::Row& p, std::size_t) {
                  p[quantity::deviatoric_stress] = 2e5;
              }).refuses("deviatoric_stress_Pa", "expected a change"));
    }

    TEST_CASE("a single outlier of the volumetric strain is left out") {
        for (const double wild : {0.5, -3.0, 1e30, -infinity})
            for (const std::size_t at : {0u, 1u, 15u, 800u}) {
                const CheckedTest l = checked_test([&](const TestCurves::Row& p, std::size_t k) {
                    if (k == at) p[quantity::volumetric_strain] = wild;
                });
                CAPTURE(wild);
                CAPTURE(at);
                CHECK(l.findings.size() == 1);
                CHECK(l.notes("volumetric_strain", "1 of 801 records left out"));
                CHECK(l.without(quantity::volumetric_strain) == 1);
            }
        const CheckedTest flipped = checked_test([&](const TestCurves::Row& p, std::size_t k) {
            if (k == 200) p[quantity::volumetric_strain] *= -1;
        });
        CHECK(flipped.notes("volumetric_strain", "expected"));
        CHECK(flipped.without(quantity::volumetric_strain) == 1);
    }

    TEST_CASE("a volumetric strain in per cent is refused from the third record on, one with the "
              "wrong sign as soon as ring radii or geometry show it") {
        const auto volume_times = [](double factor, std::size_t records, bool rings) {
            return checked_test(
                [&](const TestCurves::Row& p, std::size_t) {
                    p[quantity::volumetric_strain] *= factor;
                    for (std::size_t r = 0; r < 8 && !rings; ++r)
                        p.part(quantity::ring_radius, r) = std::nan("");
                },
                records);
        };
        for (const double factor : {100.0, -100.0})
            for (const bool rings : {true, false})
                for (const std::size_t records : {5u, 801u}) {
                    const CheckedTest l = volume_times(factor, records, rings);
                    CHECK(l.refuses("volumetric_strain", "is it in per cent?"));
                    CHECK(l.without(quantity::volumetric_strain) == records);
                    CHECK(l.without(quantity::deviatoric_stress) == 0);
                }
        // the volumetric strain exceeds 0.1 % at 0.23 % of axial strain; without rings a loose
        // specimen could behave in the same way up to 0.8 %
        CHECK(volume_times(-1, 20, true).findings.empty());
        CHECK(volume_times(-1, 30, true).refuses("volumetric_strain", "by the ring radii"));
        CHECK(volume_times(-1, 801, true).refuses("volumetric_strain", "is its sign reversed?"));
        CHECK(volume_times(-1, 60, false).findings.empty());
        CHECK(volume_times(-1, 100, false).refuses("volumetric_strain", "is its sign reversed?"));
        CHECK(volume_times(-1, 801, false).refuses("volumetric_strain", "is its sign reversed?"));
        CHECK(checked_test([](const TestCurves::Row& p, std::size_t) {
                  p[quantity::volumetric_strain] = 0;
              }).refuses("volumetric_strain", "expected a change")); // not measured
        // a volumetric strain that is not measured is not a finding
        CHECK(checked_test([](const TestCurves::Row& p, std::size_t) {
                  p[quantity::volumetric_strain] = std::nan("");
              }).findings.empty());
    }

    TEST_CASE("impossible ring radii are left out, without effect on other rings") {
        const CheckedTest one = checked_test([](const TestCurves::Row& p, std::size_t k) {
            if (k == 800) p.part(quantity::ring_radius, 2) = -0.08;
        });
        CHECK(one.notes("ring_3_radius_m", "found -0.08 at 8 % of axial strain"));
        CHECK(std::isnan(one.curves.ring(2)[800]));
        CHECK(one.curves.ring(1)[800] == example(55e3).ring(1)[800]);
        CHECK(checked_test([](const TestCurves::Row& p, std::size_t k) {
                  if (k == 300) p.part(quantity::ring_radius, 0) *= 1.1;
              }).notes("ring_1_radius_m", "expected a value near 0.07"));
        CHECK(checked_test([](const TestCurves::Row& p, std::size_t) {
                  p.part(quantity::ring_radius, 7) *= 1e3;
              }).refuses("ring_8_radius_m", "expected a radius between 0 and 10 m"));
        CHECK(checked_test([](const TestCurves::Row& p, std::size_t) {
                  p.part(quantity::ring_radius, 7) = 0;
              }).refuses("ring_8_radius_m", "found 0"));
        CHECK(checked_test([](const TestCurves::Row& p, std::size_t k) {
                  if (k % 2 == 0) p.part(quantity::ring_radius, 4) = infinity;
              }).refuses("ring_5_radius_m", "found inf"));
    }

    TEST_CASE("with an impossible axial strain all measurements of its record are left out") {
        const CheckedTest percent = checked_test(
            [](const TestCurves::Row& p, std::size_t) { p[quantity::axial_strain] *= 100; });
        CHECK(percent.refuses("axial_strain",
                              "found 8 at 800 % of axial strain: is it in per cent?"));
        CHECK(percent.without(quantity::deviatoric_stress) == 801);
        CHECK(percent.without(quantity::volumetric_strain) == 801);
        const CheckedTest one = checked_test([](const TestCurves::Row& p, std::size_t k) {
            if (k == 800) p[quantity::axial_strain] = 0.9;
        });
        CHECK(one.notes("axial_strain", "1 of 801 records left out"));
        CHECK(one.without(quantity::deviatoric_stress) == 1);
    }

    TEST_CASE("whatever numbers a machine sends, the remaining ones are physically possible") {
        for (std::uint64_t seed = 1; seed <= 200; ++seed) {
            Random random(seed, 3);
            const CheckedTest l = checked_test(
                [&](const TestCurves::Row& p, std::size_t) {
                    for (double* x :
                         {&p[quantity::deviatoric_stress], &p[quantity::volumetric_strain],
                          &p.part(quantity::ring_radius, 1)})
                        if (random.uniform() < 0.05)
                            *x = random.uniform() < 0.2 ? infinity
                                                        : std::exp(60 * random.normal()) *
                                                              (random.uniform() < 0.5 ? -1 : 1);
                },
                300);
            const auto within = [](double x, double most) {
                return std::isnan(x) || std::abs(x) <= most;
            };
            CAPTURE(seed);
            for (std::size_t k = 0; k < l.curves.size(); ++k) {
                CHECK(within(l.curves[quantity::deviatoric_stress][k], 30 * 55e3));
                CHECK(within(l.curves[quantity::volumetric_strain][k],
                             5 * l.curves[quantity::axial_strain][k] + 1e-3));
                CHECK(within(l.curves.ring(1)[k] - 0.077, 0.04));
            }
            CHECK(l.without(quantity::deviatoric_stress) > 0);
            CHECK(l.without(quantity::deviatoric_stress) < 100);
        }
    }
}
