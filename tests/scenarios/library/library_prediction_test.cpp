#include "engine/errors.hpp"
#include "engine/io/csv.hpp"
#include "engine/io/whole_file.hpp"
#include "scenarios/library/library_prediction.hpp"
#include "scenarios/library/library_results.hpp"
#include "scenarios/library/library_score.hpp"
#include "scenarios/library/library_use.hpp"
#include "tests/about.hpp"
#include "tests/scenarios/ensemble/synthetic_library.hpp"
#include "tests/temporary_directory.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>

using namespace bris;

namespace {

// geometric mean over specimens of the error over that of the prior
double over_prior(const std::vector<SpecimenScore>& scores, Scored scored) {
    std::vector<double> ratios;
    for (const SpecimenScore& s : scores) {
        const QuantityScore& q = s.of[static_cast<std::size_t>(scored)];
        ratios.push_back(q.error / q.prior);
    }
    return geometric_mean(ratios, 1).mean;
}

} // namespace

TEST_SUITE("library/library_prediction") {
    TEST_CASE("what the first per cent tells is predicted beyond it, and what it does not tell is "
              "within the band") {
        const SpecimenLibrary library = testing::synthetic_library(60, 1),
                              truths = testing::synthetic_library(200, 6);
        const LibraryPredictor predictor(library, {}, 1, 1);
        double early = 0, inside = 0, inside_friction = 0;
        for (const LibrarySpecimen& truth : truths.specimens) {
            const LibraryPrediction p = predictor.predict(truth);
            if (p.distance <= 1) // beyond it the nearest specimens count, whatever is linear
                early =
                    std::max(early, std::abs(std::log(p.curves[quantity::deviatoric_stress][19] /
                                                      double{truth.tests[1].q[19]})));
            const double q = double{truth.tests[1].q[60]};
            inside += p.curves.column(quantity::deviatoric_stress).low[60] < q &&
                              q < p.curves.column(quantity::deviatoric_stress).high[60]
                          ? 1
                          : 0;
            inside_friction +=
                p.friction.low < truth.rocks.friction && truth.rocks.friction < p.friction.high ? 1
                                                                                                : 0;
            CHECK(p.distance < 4);
        }
        CHECK(early < 0.05); // to 2 % q follows from q at 1 %; the prior deviation is 0.3
        // 180 of 200 are expected. The binomial deviation is 4; that of the deviations, which are
        // estimated from 60 specimens, is 9 %, which changes the share inside by 0.03.
        CHECK(inside >= 160);
        CHECK(inside_friction >= 160);
        const LibraryPrediction prior = predictor.prior(),
                                p = predictor.predict(truths.specimens[0]);
        CHECK(p.curves.column(quantity::deviatoric_stress).high[19] -
                  p.curves.column(quantity::deviatoric_stress).low[19] <
              0.2 * (prior.curves.column(quantity::deviatoric_stress).high[19] -
                     prior.curves.column(quantity::deviatoric_stress).low[19]));
        CHECK(p.curves.parts(quantity::radial_strain) == 2);
        CHECK(p.motion.empty());
    }

    TEST_CASE("the motion of sensor rocks and the displacement field are predicted on request") {
        const SpecimenLibrary library = testing::synthetic_library(20, 1);
        const LibraryPredictor predictor(library, {}, 0, 1, true);
        const LibraryPrediction p = predictor.predict(library.specimens[3]);
        CHECK(p.motion.size() == 16);
        CHECK(p.motion.parts(quantity::sensor_motion) == 6);
        REQUIRE(p.motion.parts(quantity::displacement_field) == 2 * FieldCells::count);
        for (const double x : p.motion[quantity::displacement_field])
            CHECK(x == about(0.5).epsilon(1e-6)); // the same in all
    }

    TEST_CASE("far from the library no band is narrow") {
        const SpecimenLibrary library = testing::synthetic_library(40, 1);
        LibrarySpecimen odd = library.specimens[0];
        for (float& q : odd.tests[0].q) q *= 1000; // another unit, say
        const LibraryPredictor predictor(library, {}, 0, 0);
        const LibraryPrediction far = predictor.predict(odd),
                                near = predictor.predict(library.specimens[0]);
        CHECK(far.distance > 5);
        CHECK(std::log(far.curves.column(quantity::deviatoric_stress).high[40] /
                       far.curves.column(quantity::deviatoric_stress).low[40]) >
              5 * std::log(near.curves.column(quantity::deviatoric_stress).high[40] /
                           near.curves.column(quantity::deviatoric_stress).low[40]));
        CHECK(far.curves.column(quantity::volumetric_strain).high[40] -
                  far.curves.column(quantity::volumetric_strain).low[40] >
              5 * (near.curves.column(quantity::volumetric_strain).high[40] -
                   near.curves.column(quantity::volumetric_strain).low[40]));
    }

    TEST_CASE("friction is estimated from one number of each measured block") {
        SpecimenLibrary library = testing::synthetic_library(40, 1);
        for (LibrarySpecimen& s : library.specimens) s.core_porosity = s.porosity;
        const LibrarySpecimen& s = library.specimens[2];
        const Vector f = parameter_features_of(library, s, 1, {});
        REQUIRE(f.size() == 3);
        double mean = 0;
        for (std::size_t k = 0; k < 10; ++k) mean += double{s.tests[1].q[k]} / 10;
        CHECK(f[0] == about(std::log(mean)).epsilon(1e-6));
        CHECK(f[1] == about(double{s.tests[1].volume[9]}).epsilon(1e-6));
        CHECK(f[2] == s.porosity);
        LibraryObservations o{.force = false, .volume = false, .tilt = true, .porosity = false};
        CHECK(parameter_features_of(library, s, 1, o) == features_of(library, s, 1, o));
        // the packing's strength of 0.1 hides friction, and nothing else does
        const auto regression = parameter_regression_of(library, {}, 1);
        const double rms =
            std::sqrt(regression.residuals().col(ParameterColumn::ln_friction).squaredNorm() / 40);
        CHECK(rms == about(0.1).epsilon(0.3));
    }

    TEST_CASE("each measurement can be left out, but not all of them") {
        const SpecimenLibrary library = testing::synthetic_library(20, 1);
        const auto features = [&](const LibraryObservations& o) {
            return features_of(library, library.specimens[2], 0, o).size();
        };
        const LibraryObservations none{.force = false, .volume = false, .porosity = false};
        LibraryObservations o = none;
        o.force = true;
        CHECK(features(o) == 10);
        o.volume = o.rings = true;
        CHECK(features(o) == 22);
        o.tilt = true;
        CHECK(features(o) == 24);
        o.tracked = true;
        CHECK(features(o) == 28);
        o.porosity = true;
        CHECK(features(o) == 29);
        CHECK(weights_of(library, o).size() == 29);
        o = {.strain = 0.0035, .porosity = false};
        CHECK(features(o) == 6); // three strains of q and of volume
        CHECK_THROWS_AS(LibraryPredictor(library, none, 0, 0), InputError);
        CHECK_THROWS_AS(LibraryPredictor(library, {.strain = 0.09}, 0, 0), InputError);
        CHECK_THROWS_AS(LibraryPredictor(library, {.strain = 5e-4}, 0, 0), InputError);
        CHECK_THROWS_AS(LibraryPredictor(library, {.strain = 0.003, .tilt = true}, 0, 0),
                        InputError);
        CHECK_THROWS_AS(LibraryPredictor(testing::synthetic_library(7, 1), {}, 0, 0), InputError);
    }

    TEST_CASE("scores show what was learned and that another specimen's test teaches nothing") {
        const SpecimenLibrary library = testing::synthetic_library(40, 1);
        const auto own =
            scores_within(library, {.observed = {}, .measured_at = 0, .predicted_at = 1});
        REQUIRE(own.size() == 40);
        // beyond 2 % the packing brings a deviation of 0.1 besides 0.28 of friction and packing
        CHECK(over_prior(own, Scored::q_near) < 0.5);
        CHECK(over_prior(own, Scored::volume_all) < 0.5);
        const auto sham = scores_within(
            library, {.observed = {}, .measured_at = 0, .predicted_at = 1, .sham = true});
        CHECK(over_prior(sham, Scored::q_near) > 0.95);
        const auto outside = scores_outside(library, testing::synthetic_library(10, 5),
                                            {.observed = {}, .measured_at = 0, .predicted_at = 1});
        REQUIRE(outside.size() == 10);
        CHECK(over_prior(outside, Scored::q_near) < 0.6);
        SpecimenLibrary other = testing::synthetic_library(10, 5);
        other.pressures[1] = 120e3;
        CHECK_THROWS_AS(scores_outside(library, other, {}), InputError);
    }

    TEST_CASE("scores of one specimen are those of the definition") {
        const SpecimenLibrary library = testing::synthetic_library(12, 1);
        const auto scores =
            scores_within(library, {.observed = {}, .measured_at = 0, .predicted_at = 0});
        SpecimenLibrary others = library;
        others.specimens.erase(others.specimens.begin() + 4);
        const LibraryPredictor predictor(others, {}, 0, 0);
        const LibraryPrediction p = predictor.predict(library.specimens[4]);
        const auto& q = library.specimens[4].tests[0].q;
        double error = 0, single = 0;
        for (std::size_t k = 40; k < 80; ++k)
            error += std::pow(p.curves[quantity::deviatoric_stress][k] - double{q[k]}, 2) / 40;
        for (const LibrarySpecimen& s : others.specimens) {
            double sum = 0;
            for (std::size_t k = 40; k < 80; ++k)
                sum += std::pow(double{s.tests[0].q[k]} - double{q[k]}, 2) / 40;
            single += std::sqrt(sum) / 11;
        }
        const QuantityScore& far = scores[4].of[static_cast<std::size_t>(Scored::q_far)];
        CHECK(far.error == about(std::sqrt(error)).epsilon(1e-9));
        CHECK(far.single == about(single).epsilon(1e-9));
        CHECK(name_of(Scored::q_far, 0.01, 0.08) == "q_4_to_8_percent");
        CHECK(name_of(Scored::rings_last, 0.01, 0.08) == "rings_at_8_percent");
    }

    TEST_CASE("the geometric mean has an interval that holds the truth in 95 % of cases") {
        int inside = 0;
        for (std::uint64_t seed = 1; seed <= 100; ++seed) {
            Random random(seed, 3);
            std::vector<double> ratios(40);
            for (double& r : ratios) r = std::exp(0.5 * random.normal() + std::log(0.7));
            const RatioInterval i = geometric_mean(ratios, 1);
            CHECK((i.low < i.mean && i.mean < i.high));
            inside += i.low < 0.7 && 0.7 < i.high ? 1 : 0;
        }
        CHECK(inside >= 87); // of 100 with probability 0.95 or somewhat less; deviation 2.2
        CHECK_THROWS_AS(geometric_mean({}, 1), InputError);
    }

    TEST_CASE("a measured test is predicted by a library that fits it, and the reason is given "
              "where it does not") {
        const SpecimenLibrary library = testing::synthetic_library(40, 1);
        const LibrarySpecimen& like = library.specimens[5];
        MeasuredCurves measured; // at strains between those of the library
        for (int k = 1; k <= 30; ++k) {
            const double strain = 5e-4 * k;
            const auto row = measured.add_row();
            row[quantity::axial_strain] = strain;
            const auto at = static_cast<std::size_t>(std::max(0.0, std::round(strain / 1e-3) - 1));
            row[quantity::deviatoric_stress] = double{like.tests[1].q[at]};
            row[quantity::volumetric_strain] = double{like.tests[1].volume[at]};
        }
        std::vector<NamedValue> settings = library.settings;
        const ModelOfTest model{settings, 0.39, 110e3};
        const TestPrediction t = predict_test(library, model, measured, {});
        CHECK(t.not_used.empty());
        const LibraryPrediction own = LibraryPredictor(library, {}, 1, 1).predict(like);
        CHECK(t.predicted.curves[quantity::deviatoric_stress][30] ==
              about(own.curves[quantity::deviatoric_stress][30]).epsilon(1e-6));
        CHECK(sentence_of(t).find("q and volume to 1 %") != std::string::npos);

        MeasuredCurves no_force = measured; // quality control removed some of q
        for (std::size_t k = 10; k < 14; ++k)
            no_force[quantity::deviatoric_stress][k] = std::nan("");
        CHECK_FALSE(predict_test(library, model, no_force, {}).used.force);
        CHECK(predict_test(library, model, no_force, {}).used.volume);
        MeasuredCurves nothing = no_force;
        nothing[quantity::volumetric_strain] = nothing[quantity::deviatoric_stress];
        CHECK(sentence_of(predict_test(library, model, nothing, {})).find("neither") !=
              std::string::npos);

        const auto reason = [&](const ModelOfTest& m) { return reason_against(library, m); };
        CHECK(reason(model).empty());
        CHECK(reason({settings, 0.32, 110e3}).find("0.320") != std::string::npos);
        CHECK(reason({settings, 0.39, 165e3}).find("165") != std::string::npos);
        settings[0] = {"bodies", "4000"};
        CHECK(reason({settings, 0.39, 110e3}).find("bodies 400") != std::string::npos);
    }

    TEST_CASE("of a folder of libraries the one that fits the model is used") {
        const TemporaryDirectory folder;
        SpecimenLibrary library = testing::synthetic_library(12, 1);
        const auto chosen = [&](const std::string& bodies) {
            const std::vector<NamedValue> settings{{"bodies", bodies}, {"grading", "arema_4"}};
            const ModelOfTest model{settings, 0.39, 110e3};
            return read_fitting_library(folder.path(), {&model, 1}).file;
        };
        CHECK_THROWS_AS(chosen("400"), InputError); // there is none
        write_library(folder / "b.h5", library);
        library.settings[0] = {"bodies", "4000"};
        write_library(folder / "a.h5", library);
        CHECK(chosen("400") == folder / "b.h5");
        CHECK(chosen("4000") == folder / "a.h5");
        CHECK(chosen("60") == folder / "a.h5"); // none fits: the first
        CHECK(read_fitting_library(folder / "b.h5", {}).file == folder / "b.h5");
    }

    TEST_CASE("a library of Hertz contacts serves rocks of its own elastic constants only, and a "
              "linear one does not ask for them") {
        SpecimenLibrary library = testing::synthetic_library(12, 1);
        std::vector<NamedValue> model = library.settings;
        const auto reason = [&] { return reason_against(library, {model, 0.39, 110e3}); };
        model.emplace_back("young_modulus_Pa", 7e10);
        CHECK(reason().empty());
        for (auto* settings : {&library.settings, &model})
            settings->emplace_back("law", "hertz_mindlin");
        CHECK(reason().find("young_modulus_Pa") != std::string::npos);
        library.settings.emplace_back("young_modulus_Pa", 7e10);
        CHECK(reason().empty());
        model.emplace_back("poisson_ratio", 0.2);
        library.settings.emplace_back("poisson_ratio", 0.3);
        CHECK(reason().find("poisson_ratio 0.3") != std::string::npos);
    }

    TEST_CASE("results are written with a line for each variant and quantity") {
        const TemporaryDirectory folder;
        const SpecimenLibrary library = testing::synthetic_library(12, 1);
        const ScoredVariant v{"as_asked", 55e3, {}, scores_within(library, {})};
        write_scores(folder / "scores.csv", {v}, 0.08);
        const std::string text = read_whole(folder / "scores.csv");
        CHECK(std::ranges::count(text, '\n') == 10);
        write_specimen_scores(folder / "specimens.csv", {v}, 0.08);
        const auto column = [&](const std::string& name) {
            const CsvForm form{.columns = {{name, name}}};
            return read_csv(folder / "specimens.csv", form).column(name);
        };
        const auto friction = column("friction"), low = column("friction_low"),
                   high = column("friction_high");
        REQUIRE(friction.size() == library.specimens.size());
        for (std::size_t k = 0; k < friction.size(); ++k) {
            CHECK(friction[k] == about(library.specimens[k].rocks.friction).epsilon(1e-3));
            CHECK((low[k] <= friction[k] && friction[k] <= high[k]) ==
                  v.scores[k].friction_is_inside());
        }
        const Report summary = scores_of(v, 0.08);
        CHECK(std::ranges::count(summary.entries(), std::string("q_1_to_4_percent_over_prior"),
                                 &NamedValue::key) == 1);
        CHECK(summary.text("", "").find("  q 1 to 4 percent over prior  ") != std::string::npos);
    }
}
