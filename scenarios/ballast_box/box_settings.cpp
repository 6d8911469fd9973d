#include "scenarios/ballast_box/box_settings.hpp"

#include "engine/errors.hpp"

#include <fmt/format.h>

namespace bris {

void check_box(const BallastBox& box) {
    const BoxTest& test = box_test(box.run);
    require(box.peak() <= actuator_limit,
            fmt::format("--peak-load: expected at most the {:g} kN of an actuator, found {:g} kN",
                        1e-3 * actuator_limit, 1e-3 * box.peak()));
    require(!test.fouled || box.friction_factor < 1 || box.stiffness_factor < 1,
            fmt::format("--run: {} is a run on fouled ballast; expected --friction-factor or "
                        "--stiffness-factor below 1, which stand for the fouling, found neither",
                        box.run));
    require(box.box_ties == 2 || box.box_ties == 4,
            fmt::format("--box-ties: expected 2 or 4, found {}", box.box_ties));
}

BoxSizes box_sizes(const BallastBox& box) {
    constexpr double half_tie = 1.295, tie_height = 0.23, bay = 0.61;
    if (box.is_dynamic())
        return {.width = 2 * bay,
                .ties = {0.5 * bay, 1.5 * bay},
                .tie = Vec3(tie_width, half_tie, tie_height),
                .share = 0.5};
    // plane strain: the tie reaches through the sides, so that no rock gets between
    const bool whole_bay = box.width > 0.6;
    if (whole_bay)
        return {.width = bay,
                .ties = {0.5 * bay},
                .tie = Vec3(tie_width, half_tie, tie_height),
                .share = 0.5};
    return {.width = box.width,
            .ties = {0.5 * box.width},
            .tie = Vec3(box.width + 0.2, half_tie, tie_height),
            .share = 0.5 * box.width / tie_width};
}

} // namespace bris
