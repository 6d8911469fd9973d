#include "engine/io/csv.hpp"
#include "scenarios/library/live_prediction.hpp"
#include "tests/about.hpp"
#include "tests/scenarios/ensemble/synthetic_library.hpp"
#include "tests/temporary_directory.hpp"

#include <doctest/doctest.h>

#include <filesystem>

using namespace bris;

TEST_SUITE("library/live_prediction") {
    TEST_CASE("a test is predicted from its first record on, from what was measured so far") {
        const TemporaryDirectory folder;
        const SpecimenLibrary library = testing::synthetic_library(40, 1);
        write_library(folder / "library.h5", library);
        LivePrediction live(folder / "library.h5", library.settings, 0.39, 110e3);
        CHECK(live.reason().empty());
        const LibrarySpecimen& like = library.specimens[5];
        RecordedTest measured;
        measured.curves.add_row()[quantity::axial_strain] = 0;
        CHECK_FALSE(live.update(0, measured));
        int updates = 0;
        for (int stage = 1; stage <= 30; ++stage) { // three stages for each strain of the library
            const double strain = 1e-3 * stage / 3;
            const auto at = static_cast<std::size_t>(std::max(0, (stage + 1) / 3 - 1));
            const auto point = measured.curves.add_row();
            point[quantity::axial_strain] = strain;
            point[quantity::deviatoric_stress] = double{like.tests[1].q[at]};
            point[quantity::volumetric_strain] = double{like.tests[1].volume[at]};
            updates += live.update(strain, measured) ? 1 : 0;
        }
        CHECK(updates == 10);
        CHECK(live.times().size() == 10);
        CHECK(live.last().used.strain == about(0.01).epsilon(1e-9));
        CHECK(live.rings().strain == about(0.01).epsilon(1e-9));
        CHECK(live.rings().without_sensors.find("found 0") != std::string::npos);
        const LibraryPrediction own = LibraryPredictor(library, {}, 1, 1).predict(like);
        CHECK(live.last().predicted.curves[quantity::deviatoric_stress][60] ==
              about(own.curves[quantity::deviatoric_stress][60]).epsilon(1e-5));
        live.write(folder.path());
        CHECK(std::filesystem::exists(folder / "predicted.csv"));
        CHECK(std::filesystem::exists(folder / "predictions.csv"));
        CHECK(read_csv(folder / "rings.csv").rows.size() == 2); // at 0.5 and 1 %
    }

    TEST_CASE("a library that does not fit is not used, and the reason is given") {
        const TemporaryDirectory folder;
        const SpecimenLibrary library = testing::synthetic_library(10, 1);
        write_library(folder / "library.h5", library);
        LivePrediction live(folder / "library.h5", library.settings, 0.3, 110e3);
        CHECK(live.reason().find("porosities") != std::string::npos);
        CHECK_FALSE(live.update(0.01, {}));
        LivePrediction none({}, library.settings, 0.39, 110e3);
        CHECK(none.reason() == "none was given");
    }
}
