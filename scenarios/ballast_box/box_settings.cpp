#include "scenarios/ballast_box/box_settings.hpp"

#include "engine/errors.hpp"
#include "systems/fields/vdb_file.hpp"

#include <fmt/format.h>

namespace bris {

namespace {

/// The grid of a file must cover the ballast that will lie in the box.
void check_fouling_file(const BallastBox& box) {
    const auto& file = box.fouling.file;
    if (file.empty()) return;
    const BoxSizes s = box_sizes(box);
    const Box3 covered = read_vdb(file, "fines").box();
    require(covered.low.maxCoeff() <= 0 && covered.high.x() >= s.width &&
                covered.high.y() >= s.across && covered.high.z() >= s.depth,
            fmt::format("{}: grid fines: expected voxels that cover the ballast, (0, 0, 0) to "
                        "({:g}, {:g}, {:g}) m, found ({:.3g}, {:.3g}, {:.3g}) to ({:.3g}, {:.3g}, "
                        "{:.3g}) m",
                        file.string(), s.width, s.across, s.depth, covered.low.x(), covered.low.y(),
                        covered.low.z(), covered.high.x(), covered.high.y(), covered.high.z()));
}

BoxSizes whole_box(unsigned ties) {
    constexpr double beyond_ties = 3.96 - 4 * tie_spacing, across = 3.36; // m, of the report's box
    BoxSizes sizes{.width = ties * tie_spacing + beyond_ties,
                   .ties = {},
                   .loaded = {ties / 2 - 1, ties / 2},
                   .across = across,
                   .middle = across / 2,
                   .tie = Vec3(tie_width, tie_length, tie_height),
                   .share = 1};
    for (unsigned k = 0; k < ties; ++k)
        sizes.ties.push_back(sizes.width / 2 + (k - (ties - 1) / 2.0) * tie_spacing);
    return sizes;
}

} // namespace

FoulingOptions fouling_of(const BallastBox& box) {
    constexpr double p4 = 17, p200 = 3, wet = 0.9; // %, %, saturation
    const BoxTest& test = box_test(box.run);
    FoulingOptions fouling = of_kind(box.fouling);
    if (!test.fouled) return fouling;
    if (fouling.file.empty() && fouling.p4 == 0) {
        fouling.p4 = p4;
        if (fouling.p200 == 0) fouling.p200 = p200;
    }
    // a file that has a grid of it takes precedence
    if (test.wet && fouling.saturation == 0) fouling.saturation = wet;
    return fouling;
}

void check_box(const BallastBox& box) {
    const BoxTest& test = box_test(box.run);
    require(box.peak() <= actuator_limit,
            fmt::format("--peak-load: expected at most the {:g} kN of an actuator, found {:g} kN",
                        1e-3 * actuator_limit, 1e-3 * box.peak()));
    const FoulingOptions& given = box.fouling;
    const auto expect_none = [&](const char* option, const std::string& found, const char* why) {
        require(found.empty() || found == "0",
                fmt::format("--{}: expected none in run {} on {} ballast, found {}", option,
                            box.run, why, found));
    };
    if (!test.fouled) {
        expect_none("fouling-p4", fmt::format("{:g}", given.p4), "clean");
        expect_none("fouling-file", given.file.string(), "clean");
    }
    if (!test.fouled || !test.wet)
        expect_none("saturation", fmt::format("{:g}", given.saturation),
                    test.fouled ? "dry" : "clean");
    check_fouling(given.file.empty() ? fouling_of(box) : given);
    check_fouling_file(box);
    require(box.restitution == 0 || box.restitution >= making_restitution,
            fmt::format("--restitution: expected 0 or {:g} to 1, found {:g}", making_restitution,
                        box.restitution));
    require(box.tie_support > 0 || box.is_bay(),
            "--tie-support: expected a stiffness above 0, found 0");
    const bool fits =
        box.is_full() ? box.ties() >= 4 && box.ties() % 2 == 0 : box.ties() == 2 || box.ties() == 4;
    require(fits, fmt::format("--box-ties: expected {}, found {}",
                              box.is_full() ? "an even number from 4 on" : "2 or 4", box.box_ties));
}

BoxSizes box_sizes(const BallastBox& box) {
    constexpr double bay = tie_spacing;
    const Vec3 half_tie(tie_width, tie_length / 2, tie_height);
    if (box.is_full()) return whole_box(box.ties());
    if (box.is_dynamic() && !box.is_bay())
        return {
            .width = 2 * bay, .ties = {0.5 * bay, 1.5 * bay}, .loaded = {0, 1}, .tie = half_tie};
    if (box.is_bay() || box.width > 0.6)
        return {.width = bay, .ties = {0.5 * bay}, .tie = half_tie};
    // plane strain: the tie reaches through the sides, so that no rock gets between
    return {.width = box.width,
            .ties = {0.5 * box.width},
            .tie = Vec3(box.width + 0.2, half_tie.y(), half_tie.z()),
            .share = 0.5 * box.width / tie_width};
}

} // namespace bris
