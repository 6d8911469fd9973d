// A library of specimens: triaxial tests of many packings whose friction, stiffness and porosity
// cover a range, kept on common strains. From it, early measurements of a specimen that was never
// simulated predict what follows.

#include "scenarios/library/specimen_library.hpp"

#include "engine/errors.hpp"
#include "engine/io/checkpoint.hpp"
#include "engine/report.hpp"
#include "scenarios/library/library_design.hpp"
#include "scenarios/library/library_join.hpp"
#include "scenarios/library/library_results.hpp"
#include "scenarios/library/ring_profile.hpp"
#include "scenarios/library/sensor_predictive.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace bris {

namespace {

constexpr auto library_file = "specimen_library.h5";

struct LibraryRun {
    Triaxial triaxial;
    LibraryDesign design;
    LibraryObservations observed;
    double learning_pressure = 0;
    bool compare = false;
    std::filesystem::path library = {}, truths = {}, joined = {};

    void declare_options(auto& option) {
        design.declare_options(option);
        option.group("Score");
        option("library", library, "",
               "File of a library that is scored instead of making one. Default: a new library is "
               "made.");
        option("truths", truths, "",
               "File of another library, whose specimens are predicted instead of those of the "
               "library itself. Default: each specimen is predicted from all others.");
        option("join", joined, "",
               "File of another library of the same rocks, of other ranges or another seed, whose "
               "specimens are added to those of --library; the results of the run are the joined "
               "library and its scores.");
        observed.declare_options(option);
        option("learning_pressure", learning_pressure, "Pa",
               "Confining pressure of the measurements that are assimilated. 0: each test is "
               "predicted from its own measurements.",
               within(0, 1e9));
        option("compare", compare, "",
               "Score other choices of measurements too, and those of another specimen.");
        triaxial.declare_options(option);
    }
};

/// The library in the folder --resume, or one without specimens.
SpecimenLibrary begin_library(const LibraryRun& s, const Common& common) {
    SpecimenLibrary library = empty_library(s.design, s.triaxial, common);
    if (common.resume.empty()) return library;
    const auto file = common.resume / library_file;
    require(std::filesystem::exists(file), fmt::format("--resume: expected {} in '{}', found none",
                                                       library_file, common.resume.string()));
    SpecimenLibrary before = read_library(file);
    require_same_run("--resume", file, {common.scenario, 0, before.settings, {}}, common.scenario,
                     library.settings, settings_that_may_differ());
    return before;
}

std::size_t index_of(double pressure, const SpecimenLibrary& library) {
    for (std::size_t p = 0; p < library.pressures.size(); ++p)
        if (std::abs(library.pressures[p] - pressure) < 1e-6 * pressure) return p;
    std::string all;
    for (const double p : library.pressures)
        all += fmt::format("{}{:g}", all.empty() ? "" : ", ", p);
    throw InputError(fmt::format("--learning-pressure: expected one of the library's pressures, {} "
                                 "Pa, found {:g}",
                                 all, pressure));
}

constexpr std::size_t fewest_scored = 10;

/// Scores a library, each test from the measurements that are asked for.
class LibraryScore {
public:
    LibraryScore(const LibraryRun& s, const Common& common, const SpecimenLibrary& library)
        : s_(s), common_(common), library_(library),
          last_(library.axis.strain(library.axis.count - 1)) {
        require(s.observed.strain < last_ / 2,
                fmt::format("--learning-strain: expected less than {:g}, half of the library's "
                            "last strain, found {:g}",
                            last_ / 2, s.observed.strain));
        if (!s.truths.empty()) truths_ = read_library(s.truths);
    }
    void run(Report& summary);

private:
    std::vector<SpecimenScore> scores(const Scoring& scoring) const {
        return s_.truths.empty() ? scores_within(library_, scoring)
                                 : scores_outside(library_, truths_, scoring);
    }
    Scoring scoring_at(std::size_t pressure) const {
        const std::size_t from =
            s_.learning_pressure > 0 ? index_of(s_.learning_pressure, library_) : pressure;
        return {s_.observed, from, pressure, false, common_.threads};
    }
    void draw(const Scoring& scoring, const std::vector<SpecimenScore>& scores) const;

    const LibraryRun& s_;
    const Common& common_;
    const SpecimenLibrary& library_;
    SpecimenLibrary truths_;
    double last_; // axial strain
};

void LibraryScore::run(Report& summary) {
    std::vector<ScoredVariant> variants;
    const bool sensors = library_.sensors > 0 &&
                         (s_.truths.empty() || truths_.sensors == library_.sensors) &&
                         s_.observed.strain > library_.axis.coarse_strain(0) * (1 - 1e-9);
    for (std::size_t p = 0; p < library_.pressures.size(); ++p) {
        Scoring scoring = scoring_at(p);
        const auto add = [&](const std::string& name) {
            variants.push_back({name, library_.pressures[p], scoring.observed, scores(scoring)});
        };
        add("as_asked");
        summary.add_part(folder_of(library_.pressures[p]), scores_of(variants.back(), last_));
        draw(scoring, variants.back().scores);
        if (!s_.compare) continue;
        for (const Variant& v : compared_variants(s_.observed, sensors)) {
            scoring.observed = v.observed;
            scoring.sham = v.sham;
            add(v.name);
        }
    }
    write_scores(common_.out / "scores.csv", variants, last_);
    write_specimen_scores(common_.out / "specimens.csv", variants, last_);
    summary.show_sentence("Ratios are errors of q over those of the prior ensemble, with intervals "
                          "of 95 %; scores.csv has those of all variants of what is assimilated.");
    if (!s_.truths.empty() || !s_.compare) return;
    write_ring_scores(common_.out / "rings.csv", score_rings(library_));
    const std::vector<SuspicionScore> suspicions = score_suspicions(library_);
    if (!suspicions.empty()) write_suspicions(common_.out / "suspicions.csv", suspicions);
}

void LibraryScore::draw(const Scoring& scoring, const std::vector<SpecimenScore>& scores) const {
    const std::size_t median = median_specimen(scores);
    SpecimenLibrary others = library_;
    const LibrarySpecimen example =
        s_.truths.empty() ? library_.specimens[median] : truths_.specimens[median];
    if (s_.truths.empty())
        others.specimens.erase(others.specimens.begin() + static_cast<std::ptrdiff_t>(median));
    const LibraryPredictor predictor(others, scoring.observed, scoring.measured_at,
                                     scoring.predicted_at);
    draw_scores(common_.out / (folder_of(library_.pressures[scoring.predicted_at]) + ".png"),
                library_, example, predictor.predict(example), predictor.prior(),
                scoring.predicted_at, scores);
}

/// The libraries that are to be joined and scored are read and fit each other.
void check_libraries(const LibraryRun& s, const Common& common) {
    SpecimenLibrary library = read_library(s.library);
    if (!s.joined.empty()) join(library, read_library(s.joined), s.joined);
    if (library.specimens.size() >= fewest_scored) LibraryScore(s, common, library);
}

void check_options(const LibraryRun& s, const Common& common) {
    require(s.library.empty() || common.resume.empty(),
            "--library, --resume: expected one of them; a library that is scored is not continued");
    require(s.truths.empty() || !s.library.empty(),
            "--truths: expected --library, the library that predicts them");
    require(s.joined.empty() || !s.library.empty(),
            "--join: expected --library, the library to which the specimens are added");
    if (!s.library.empty()) return check_libraries(s, common);
    check_design(s.design, s.triaxial);
    say_how_read(grading_named(s.triaxial.grading));
    require(s.triaxial.test.friction == TriaxialSettings{}.friction,
            "--friction: not used by this scenario, whose specimens have frictions from "
            "--lowest-friction to --highest-friction; expected --preparation-friction, that of "
            "the rocks while a specimen is made");
    require_memory_for(s.triaxial, common.threads, common.memory_limit,
                       static_cast<double>(common.threads) * s.triaxial.test.final_axial_strain /
                           s.triaxial.test.stage_strain);
}

SpecimenLibrary make_library(const LibraryRun& s, const Common& common) {
    SpecimenLibrary library = begin_library(s, common);
    complete_library(library, common.out / library_file, s.design, s.triaxial, common);
    return library;
}

SpecimenLibrary given_library(const LibraryRun& s, const Common& common) {
    SpecimenLibrary library = read_library(s.library);
    if (s.joined.empty()) return library;
    join(library, read_library(s.joined), s.joined);
    write_library(common.out / library_file, library);
    return library;
}

void run(const LibraryRun& s, const Common& common) {
    const SpecimenLibrary library =
        s.library.empty() ? make_library(s, common) : given_library(s, common);
    Report summary;
    summary.add("specimens_made", library.specimens.size());
    std::uint64_t redrawn = 0;
    for (const LibrarySpecimen& specimen : library.specimens) redrawn += specimen.redrawn;
    summary.add("packings_redrawn", redrawn);
    summary.add("specimens_given_up", library.given_up.size());
    summary.show({"specimens_made", "packings_redrawn", "specimens_given_up"});
    if (library.specimens.size() >= fewest_scored)
        LibraryScore(s, common, library).run(summary);
    else
        summary.show_sentence(
            fmt::format("A library of fewer than {} specimens is not scored.", fewest_scored));
    report_results(common, summary);
}

std::string explain(const LibraryRun& s, const Common& common) {
    return explain_triaxial(s.triaxial, common);
}

} // namespace

} // namespace bris

int main(int argc, char** argv) {
    return bris::run_scenario<bris::LibraryRun>(
        argc, argv,
        {.name = "specimen_library",
         .description = "Tests many specimens of different friction, stiffness, porosity and "
                        "packing, and keeps the results as a library for predictions.",
         .makes_beds = true},
        bris::check_options, bris::run, bris::explain);
}
