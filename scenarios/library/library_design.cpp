#include "scenarios/library/library_design.hpp"

#include "engine/ensemble.hpp"
#include "engine/errors.hpp"
#include "engine/estimation/low_discrepancy.hpp"
#include "engine/interrupt.hpp"
#include "engine/io/checkpoint.hpp"
#include "engine/random.hpp"
#include "engine/report.hpp"
#include "scenarios/ensemble/run_models.hpp"
#include "scenarios/library/library_member.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <mutex>
#include <optional>

namespace bris {

namespace {

/// Settings that do not change what a specimen of the library is: those that may differ in every
/// scenario, and those that say how many specimens there are and how they are judged.
bool is_of_specimens(const NamedValue& setting) {
    constexpr std::array others{"specimens",       "library",
                                "truths",          "compare",
                                "learning_strain", "learning_pressure_Pa",
                                "use_force",       "use_volume",
                                "use_rings",       "use_sensors",
                                "use_tilt",        "use_porosity",
                                "frame_stages",    "join"};
    return std::ranges::count(settings_that_may_differ(), setting.key) == 0 &&
           std::ranges::count(others, setting.key) == 0;
}

/// Makes specimens and adds them to a library.
class LibraryMaker {
public:
    LibraryMaker(SpecimenLibrary& library, const std::filesystem::path& file,
                 const LibraryDesign& design, const Triaxial& test, const Common& common)
        : library_(library), file_(file), design_(design), test_(test), common_(common),
          progress_(make_progress(common)) {}

    void run();

private:
    void make(std::size_t job, std::uint64_t number);
    LibrarySpecimen tested(std::size_t job, std::uint64_t number, std::uint64_t attempt);
    ReportProgress report_to(std::size_t slot) {
        return progress_slot(progress_, static_cast<unsigned>(slot));
    }
    void say(const std::string& text) {
        progress_.pause();
        report_news(common_, text);
    }

    SpecimenLibrary& library_;
    const std::filesystem::path& file_;
    const LibraryDesign& design_;
    const Triaxial& test_;
    const Common& common_;
    Progress progress_;
    std::mutex mutex_; // of the library, its file and the output
};

void LibraryMaker::run() {
    std::vector<std::uint64_t> missing;
    for (std::uint64_t number = 1; number <= design_.specimens; ++number)
        if (!library_.has(number)) missing.push_back(number);
    const double points = 1 + std::round(test_.test.final_axial_strain / test_.test.stage_strain);
    progress_.begin_job(static_cast<double>(missing.size() * library_.pressures.size()) * points);
    const SavesWhenInterrupted saves("continue with --resume " + common_.out.string());
    run_ensemble(missing.size(), common_.threads,
                 [&](std::size_t job) { make(job, missing[job]); });
    progress_.pause();
}

void LibraryMaker::make(std::size_t job, std::uint64_t number) {
    for (std::uint64_t attempt = 0; attempt < design_.packings; ++attempt) {
        try {
            LibrarySpecimen specimen = tested(job, number, attempt);
            const std::lock_guard lock(mutex_);
            library_.add(std::move(specimen));
            write_library(file_, library_);
            return;
        } catch (const SimulationError& error) {
            const std::lock_guard lock(mutex_);
            const std::string what = error.what(); // its checkpoint is not kept
            say(fmt::format("specimen {}, packing {}: {}", number, attempt + 1,
                            what.substr(0, what.find(" (state saved"))));
        }
    }
    const std::lock_guard lock(mutex_);
    library_.given_up.push_back(number);
    std::ranges::sort(library_.given_up);
    write_library(file_, library_);
    say(fmt::format("specimen {} is given up after {} packings", number, design_.packings));
}

LibrarySpecimen LibraryMaker::tested(std::size_t job, std::uint64_t number, std::uint64_t attempt) {
    const DesignPoint point = design_point(design_, number, attempt, common_.seed);
    const std::size_t sensors = make_scene(test_, point.seed).poses.size();
    require(sensors == library_.sensors,
            fmt::format("--bodies: expected a size at which every specimen has {} sensor rocks, "
                        "found one with {}; --sensor-poses gives them for all",
                        library_.sensors, sensors));
    const std::size_t tests = library_.pressures.size();
    LibrarySpecimen made{.number = number,
                         .seed = point.seed,
                         .redrawn = attempt,
                         .rocks = point.rocks,
                         .porosity = point.porosity,
                         .diameter = 0,
                         .tests = {}};
    const auto remove = [&] {
        std::filesystem::remove_all(common_.out / folder_of_packing(point.seed));
    };
    try {
        const PreparedSpecimen prepared = make_packing(
            test_, {point.porosity, point.seed}, common_.settings, common_, report_to(job * tests));
        made.diameter = 2 * prepared.scene.specimen.radius;
        TriaxialSettings settings = test_.test;
        settings.porosity = point.porosity;
        for (std::size_t k = 0; k < tests; ++k) {
            settings.confining_pressure = library_.pressures[k];
            const ModelRun run =
                run_model(prepared.scene, settings, prepared.state,
                          {.name = fmt::format("specimen {}", number), .rocks = point.rocks},
                          {.progress = report_to(job * tests + k)});
            made.tests.push_back(sampled(run, library_.axis));
            made.core_porosity += run.core_porosity / static_cast<double>(tests);
        }
    } catch (const SimulationError&) {
        remove();
        throw;
    }
    remove();
    return made;
}

} // namespace

DesignPoint design_point(const LibraryDesign& design, std::uint64_t number, std::uint64_t attempt,
                         std::uint64_t seed) {
    constexpr std::uint64_t stream = 771; // of the shift of the sequence
    auto u = low_discrepancy_point(number, 3);
    Random shift(seed, stream);
    for (double& x : u) x = std::fmod(x + shift.uniform(), 1.0);
    const auto between = [](double low, double high, double x) { return low + (high - low) * x; };
    return {{std::exp(between(std::log(design.lowest_friction), std::log(design.highest_friction),
                              u[0])),
             between(design.lowest_stiffness, design.highest_stiffness, u[1])},
            between(design.lowest_porosity, design.highest_porosity, u[2]),
            (seed + 1000) * 1000000 + 10 * number + attempt};
}

void check_design(const LibraryDesign& d, const Triaxial& t) {
    const auto require_order = [](const char* name, double low, double high) {
        require(low <= high, fmt::format("--lowest-{}, --highest-{}: expected a lowest value below "
                                         "the highest, found {:g} and {:g}",
                                         name, name, low, high));
    };
    require_order("friction", d.lowest_friction, d.highest_friction);
    require_order("stiffness", d.lowest_stiffness, d.highest_stiffness);
    require_order("porosity", d.lowest_porosity, d.highest_porosity);
    require(t.test.porosity == 0, "--porosity: not used by this scenario, whose specimens have "
                                  "porosities from --lowest-porosity to --highest-porosity");
    const auto require_multiple = [](const char* what, double a, double b) {
        require(a / b > 0.999 && std::abs(a / b - std::round(a / b)) < 1e-6 * a / b,
                fmt::format("{}, found {:g} and {:g}", what, a, b));
    };
    require_multiple("--strain-step: expected a multiple of --stage-strain", d.strain_step,
                     t.test.stage_strain);
    require_multiple("--final-axial-strain: expected a multiple of --strain-step",
                     t.test.final_axial_strain, d.strain_step);
    check_test(t);
}

SpecimenLibrary empty_library(const LibraryDesign& design, const Triaxial& t,
                              const Common& common) {
    SpecimenLibrary library;
    std::ranges::copy_if(common.settings, std::back_inserter(library.settings), is_of_specimens);
    library.axis = {.step = design.strain_step,
                    .count = static_cast<std::size_t>(
                        std::llround(t.test.final_axial_strain / design.strain_step))};
    library.pressures = t.confining_pressure;
    library.rings = t.specimen.rings;
    library.sensors = make_scene(t, common.seed).poses.size();
    return library;
}

void complete_library(SpecimenLibrary& library, const std::filesystem::path& file,
                      const LibraryDesign& design, const Triaxial& test, const Common& common) {
    LibraryMaker(library, file, design, test, common).run();
}

} // namespace bris
