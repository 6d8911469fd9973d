#include "scenarios/specimens/fouling_options.hpp"

#include "components/fouling.hpp"
#include "components/material.hpp"
#include "engine/errors.hpp"
#include "systems/fields/vdb_file.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace bris {

double p4_of_vci(double vci, const FoulingSettings& settings, double ballast, double voids) {
    const double fines = 0.01 * vci * settings.density * voids / (1 + settings.void_ratio);
    return 100 * fines / (ballast + fines);
}

void check_fouling(const FoulingOptions& o) {
    require(o.p200 <= o.p4,
            fmt::format("--fouling-p200: expected at most --fouling-p4, {:g} %, found {:g} %", o.p4,
                        o.p200));
    require(o.pattern != "layered" || o.low < o.high,
            fmt::format("--fouling-low: expected less than --fouling-high, {:g}, found {:g}",
                        o.high, o.low));
    require(o.settings.least_void_ratio <= o.settings.void_ratio,
            fmt::format("--fouling-compacted-void-ratio: expected at most --fouling-void-ratio, "
                        "{:g}, found {:g}",
                        o.settings.void_ratio, o.settings.least_void_ratio));
    require(o.file.empty() || o.p4 == 0,
            "--fouling-file: expected no --fouling-p4 with it, found both");
    require(o.file.empty() || o.saturation == 0 || !find_vdb(o.file, "saturation"),
            fmt::format("--saturation: expected none with '{}', which has a grid saturation, "
                        "found {:g}",
                        o.file.string(), o.saturation));
}

void add_fouling(World& world, const FoulingOptions& o) { add_fouling(world, o.settings, o.law); }

void fill_with_fines(World& world, const FoulingOptions& o, std::uint64_t seed) {
    using Pattern = InitialFouling::Pattern;
    InitialFouling initial{.p4 = o.p4,
                           .p200 = o.p200,
                           .low = o.low,
                           .high = o.high,
                           .saturation = o.saturation,
                           .seed = seed,
                           .file = o.file};
    initial.pattern = !o.file.empty()          ? Pattern::file
                      : o.pattern == "layered" ? Pattern::layered
                      : o.pattern == "random"  ? Pattern::random
                                               : Pattern::uniform;
    fill_with_fines(world, initial);
}

void add_fouling_results(Summary& summary, const World& world) {
    const Fouling present = present_fouling(world);
    const FoulingMeasures m = measure_fouling(world, present);
    summary.add("fines_mass_kg", m.fines_mass);
    summary.add("fines_beyond_capacity_kg", present.fines_beyond);
    summary.add("fouling_index", m.fouling_index);
    summary.add("fouling_class", fouling_class(m.fouling_index));
    summary.add("void_contaminant_index_percent", m.contaminant_index);
    summary.add("void_contamination_percent", m.void_contamination);
    summary.add("saturation_percent", m.saturation);
    summary.add("field_updates", present.updates);
    if (present.updates == 0) return; // contacts are weakened in the first step
    double friction = 1, stiffness = 1, most_friction = 0, most_stiffness = 0;
    for (const WeakenedPair& pair : world.resource<Materials>().weakened()) {
        friction = std::min(friction, pair.friction);
        most_friction = std::max(most_friction, pair.friction);
        stiffness = std::min(stiffness, pair.stiffness);
        most_stiffness = std::max(most_stiffness, pair.stiffness);
    }
    summary.add("least_friction_factor", friction);
    summary.add("largest_friction_factor", std::max(friction, most_friction));
    summary.add("least_stiffness_factor", stiffness);
    summary.add("largest_stiffness_factor", std::max(stiffness, most_stiffness));
}

} // namespace bris
