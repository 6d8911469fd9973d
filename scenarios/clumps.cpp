// A library of clumps: random rocks, or one rock from an STL, OBJ or PLY file, are filled with
// spheres, and a report states how closely each clump represents its solid.
#include "engine/errors.hpp"
#include "engine/report.hpp"
#include "scenarios/rocks/make_library.hpp"

#include <fmt/format.h>

#include <cstdio>

namespace {

using namespace bris;

struct Clumps {
    LibrarySettings library;
    unsigned spheres = 30;
    unsigned restarts = 4;
    std::string method = "fitted";

    void declare_options(auto& option) {
        option("count", library.count, "", "Number of random rocks.", within(1, 10000));
        option("spheres", spheres, "", "Number of spheres in a clump.", within(4, 1000));
        option("least_radius", library.fill.fit.min_radius, "sieve",
               "Smallest radius of a sphere, relative to the sieve size of the rock.",
               within(0.02, 0.4));
        option(
            "method", method, "",
            "Method by which spheres fill a rock. fitted: the spheres are fitted to the "
            "surface. level_set: OpenVDB's filling, whose spheres touch the surface from inside.",
            {"fitted", "level_set"});
        option("restarts", restarts, "",
               "Number of fits of each rock from different starts. The best one is kept.",
               within(1, 100));
        option.group("Rocks");
        option("least_flat_elongated", library.least_flat_elongated, "",
               "Smallest flat and elongated ratio (longest over shortest dimension).",
               within(1, 4));
        option("median_flat_elongated", library.median_flat_elongated, "",
               "Median flat and elongated ratio.", within(1, 4));
        option("greatest_flat_elongated", library.greatest_flat_elongated, "",
               "Largest flat and elongated ratio.", within(1, 4));
        option("fewest_faces", library.fewest_faces, "",
               "Number of faces of the most angular rock.", within(6, 60));
        option("most_faces", library.most_faces, "", "Number of faces of the least angular rock.",
               within(6, 60));
        option("cube", library.cube, "", "Also make a clump of the cubic SmartRock.");
        option("mesh", library.mesh, "",
               "STL, OBJ or PLY file of a rock. If it is given, one clump of this shape is made "
               "instead "
               "of random rocks.");
    }
};

} // namespace

int main(int argc, char** argv) {
    return run_scenario<Clumps>(
        argc, argv,
        {"clumps",
         "Makes a library of clumps and reports how closely each one "
         "represents its rock.",
         "a library is always made from the beginning", "no simulation is run"},
        [](const Clumps& settings, const Common& common) {
            LibrarySettings library = settings.library;
            library.seed = common.seed;
            library.out = common.out;
            library.fill.fit.spheres = settings.spheres;
            library.fill.restarts = static_cast<int>(settings.restarts);
            library.fill.method =
                settings.method == "fitted" ? FillMethod::fitted : FillMethod::level_set;
            Report summary;
            summary.show_sentence(sentence_of(make_library(library)));
            summary.show_sentence("More about each clump is in report.csv; lengths are in units of "
                                  "the sieve size.");
            report_results(common, summary);
        });
}
