// A library of clumps: random rocks, or one rock from an STL or OBJ file, filled with spheres, with
// a report of how well each clump stands for its solid.
#include "engine/errors.hpp"
#include "engine/scenario.hpp"
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

    void describe(auto& option) {
        option("count", library.count, "", "number of random rocks", within(1, 10000));
        option("spheres", spheres, "", "balls of a clump", within(4, 1000));
        option("least_radius", library.fill.fit.min_radius, "sieve", "of a ball",
               within(0.02, 0.4));
        option("method", method, "", "of filling", {"fitted", "level_set"});
        option("restarts", restarts, "", "fits of each rock; the best is kept", within(1, 100));
        option.group("rocks");
        option("least_flat_elongated", library.least_flat_elongated, "", "longest / shortest",
               within(1, 4));
        option("median_flat_elongated", library.median_flat_elongated, "", "", within(1, 4));
        option("greatest_flat_elongated", library.greatest_flat_elongated, "", "", within(1, 4));
        option("fewest_faces", library.fewest_faces, "", "the most angular rock", within(6, 60));
        option("most_faces", library.most_faces, "", "the least angular rock", within(6, 60));
        option("cube", library.cube, "", "also the cubic SmartRock");
        option("mesh", library.mesh, "", "STL or OBJ file: one clump of this shape instead");
    }
};

} // namespace

int main(int argc, char** argv) {
    return run_scenario<Clumps>(argc, argv,
                                {"clumps", "make a library of clumps and report how true they are",
                                 "a library is made anew", "no simulation is made"},
                                [](const Clumps& settings, const Common& common) {
                                    LibrarySettings library = settings.library;
                                    library.seed = common.seed;
                                    library.out = common.out;
                                    library.fill.fit.spheres = settings.spheres;
                                    library.fill.restarts = static_cast<int>(settings.restarts);
                                    library.fill.method = settings.method == "fitted"
                                                              ? FillMethod::fitted
                                                              : FillMethod::level_set;
                                    const std::string table = describe(make_library(library));
                                    std::fputs(table.c_str(), stdout);
                                });
}
