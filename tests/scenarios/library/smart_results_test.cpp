#include "engine/io/csv.hpp"
#include "engine/io/whole_file.hpp"
#include "scenarios/library/smart_results.hpp"
#include "tests/about.hpp"
#include "tests/scenarios/ensemble/simple_point.hpp"
#include "tests/scenarios/ensemble/steady_run.hpp"
#include "tests/scenarios/ensemble/synthetic_library.hpp"
#include "tests/temporary_directory.hpp"

#include <doctest/doctest.h>

#include <cmath>

using namespace bris;

namespace {

// q of a test: 1e5 and its error `off` beyond 1 % of strain, ten times as much before
ModelRun run_off_by(double off) {
    ModelRun run;
    for (int stage = 0; stage <= 80; ++stage) {
        const auto p = run.curves.add_row();
        for (const Quantity* q : quantity::of_stage) p[*q] = 0;
        p[quantity::axial_strain] = 1e-3 * stage;
        p[quantity::deviatoric_stress] = 1e5 + (stage > 10 ? off : 10 * off);
        p[quantity::volumetric_strain] =
            -p[quantity::axial_strain] + (stage > 10 ? 1e-7 : 1e-6) * off;
        for (std::size_t r = 0; r < 2; ++r) p.part(quantity::ring_radius, r) = 0.075;
        run.displacement.push_back({});
        run.rotation.push_back({});
    }
    return run;
}

struct Example {
    SpecimenLibrary library = testing::synthetic_library(20, 1);
    RecordedTest test;
    SmartTest computed;
    SmartResults settings{.library = nullptr};
    Example() {
        settings.library = &library;
        test.pressure = 110e3;
        test.curves = MeasuredCurves(run_off_by(0).curves);
        computed.free = run_off_by(2e4);
        computed.running = {run_off_by(1e4)};
    }
    // the library predicts q too high by 4 kPa, without measurements by 8
    void predict() {
        computed.library.not_used.clear();
        computed.members = {{3, 0.4}};
        for (std::size_t k = 0; k < library.axis.count; ++k) {
            for (auto [to, off] : {std::pair{&computed.library.predicted, 4e3},
                                   std::pair{&computed.library.prior, 8e3}}) {
                const auto row = to->curves.add_row();
                row[quantity::axial_strain] = library.axis.strain(k);
                row[quantity::deviatoric_stress] = 1e5 + off;
                row[quantity::volumetric_strain] = -library.axis.strain(k) + 1e-7 * off;
                for (const Quantity* shown :
                     {&quantity::deviatoric_stress, &quantity::volumetric_strain}) {
                    TestCurves::Column& c = to->curves.column(*shown);
                    const double half = shown == &quantity::deviatoric_stress ? 1e3 : 0;
                    c.low.push_back(c.values.back() - half);
                    c.high.push_back(c.values.back() + half);
                }
            }
        }
        computed.library.predicted.friction =
            computed.library.predicted.stiffness = {0.7, 0.7, 0.7};
    }
    double number(const std::string& key) const {
        Report summary;
        add_results(summary, test, computed, settings);
        for (const NamedValue& v : summary.entries())
            if (v.key == "110kPa_" + key) return std::get<double>(v.value);
        return std::nan("");
    }
};

} // namespace

TEST_SUITE("library/smart_results") {
    TEST_CASE("errors are scored beyond the strains learned from") {
        Example e;
        e.computed.library.not_used = "none was given";
        CHECK(e.number("DEM_only_rmse_q_Pa") == about(2e4).epsilon(1e-12));
        CHECK(e.number("fused_rmse_q_Pa") == about(1e4).epsilon(1e-12));
        CHECK(e.number("error_ratio_q") == about(0.5).epsilon(1e-12));
        CHECK(e.number("error_ratio_volumetric_strain_to_4_percent") == about(0.5).epsilon(1e-9));
        e.settings.last_strain = e.settings.learned_strain; // nothing lies beyond them
        for (ModelRun* run : {&e.computed.free, &e.computed.running[0]}) {
            run->curves = run->curves.up_to(0.0101);
            run->displacement.resize(11);
        }
        CHECK(e.number("fused_rmse_q_Pa") == about(1e5).epsilon(1e-12));
    }

    TEST_CASE("where the library fits, fused is its prediction, scored at the same strains as DEM "
              "only and compared with the mean of the library") {
        Example e;
        e.predict();
        CHECK(e.number("fused_rmse_q_Pa") == about(4e3).epsilon(1e-12));
        CHECK(e.number("error_ratio_q") == about(0.2).epsilon(1e-12));
        CHECK(e.number("error_ratio_q_over_prior") == about(0.5).epsilon(1e-12));
        CHECK(e.number("error_ratio_volumetric_strain_over_prior") == about(0.5).epsilon(1e-9));
        CHECK(e.number("error_ratio_q_of_member") == about(0.5).epsilon(1e-12));
        CHECK(e.number("library_friction") == 0.7);
        CHECK(e.number("member_difference_from_library") > 0);
        CHECK(std::isnan(e.number("error_ratio_sensor_displacement"))); // no recordings
        Report shown;
        add_results(shown, e.test, e.computed, e.settings);
        const std::string text = shown.text("", "");
        CHECK(text.find("104 (103 to 105) kPa\n") != std::string::npos);
        CHECK(text.find("100 kPa: outside the band\n") != std::string::npos);
    }

    TEST_CASE("each run of a test has its curve, and a run that was stopped has none") {
        const TemporaryDirectory folder;
        Example e;
        e.predict();
        e.computed.members = {{3, 0.4}, {7, 0.2}};
        e.computed.running = {run_off_by(1e4), run_off_by(2e4)};
        e.computed.running[1].stopped = "overlap";
        write_runs(folder.path(), e.computed, e.settings);
        CHECK(std::filesystem::exists(folder / "dem_only.csv"));
        CHECK(std::filesystem::exists(folder / "specimen_4.csv")); // the number of the fourth
        CHECK_FALSE(std::filesystem::exists(folder / "specimen_8.csv"));
        CHECK_FALSE(e.computed.complete());
        CHECK(std::isnan(e.number("error_ratio_q")));
    }
}
