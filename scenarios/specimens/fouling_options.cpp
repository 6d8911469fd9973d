#include "scenarios/specimens/fouling_options.hpp"

#include "components/fouling.hpp"
#include "components/material.hpp"
#include "engine/errors.hpp"
#include "systems/fields/vdb_file.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace bris {

namespace {

/// Friction by shear tests, cushions by moduli. A film of fines between two rocks is squeezed until
/// it is some 0.1 mm thin and 10 mm wide: a modulus of E (MPa) makes it as stiff as 0.79 E MN/m, a
/// contact of 63 MN/m rocks is 31.5 MN/m.
struct FinesKind {
    const char* name;
    double density, void_ratio;                                    ///< kg/m3, -
    double friction_loss, moisture_loss, dry_modulus, wet_modulus; ///< -, -, MPa, MPa
};
constexpr FinesKind kinds[]{
    // no loss of strength when dry: Qian et al. (2022), Transp. Geotech. 34; wet: that of the rock
    {"mineral", 2650, 0.8, 0, 0.11, 50, 20},
    // tan of the friction angle falls by 0.36 at a VCI of 0.4, where g = 0.44: Sweta and Hussaini
    // (granite, soil); the loss by water is an assumption
    {"clay", 2600, 1.0, 0.81, 0.3, 20, 5},
    // filled voids have the strength of the dust, 34 degrees: Huang, Tutumluer, Dombrow (2009)
    {"coal", 1300, 1.0, 0.5, 0.3, 20, 5},
};

constexpr double film_stiffness = 0.79e6;    // N/m for each MPa
constexpr double contact_stiffness = 31.5e6; // N/m

} // namespace

FoulingOptions of_kind(FoulingOptions o) {
    const auto found = std::ranges::find(kinds, o.kind, &FinesKind::name);
    if (found == std::end(kinds)) return o;
    const FoulingSettings usual;
    const FoulingLaw law;
    require(FoulingLaw::fields(o.law) == FoulingLaw::fields(law) &&
                o.settings.density == usual.density && o.settings.void_ratio == usual.void_ratio,
            fmt::format("--fouling-kind: expected none of the options that {} states itself, found "
                        "another density, void ratio, loss, limit or cushion",
                        o.kind));
    o.kind = "assumed"; // by the options, which now have its numbers
    o.settings.density = found->density;
    o.settings.void_ratio = found->void_ratio;
    o.law = {.friction_loss = found->friction_loss,
             .moisture_loss = found->moisture_loss,
             .stiffness_loss = 0,
             .dry_cushion = contact_stiffness / (film_stiffness * found->dry_modulus),
             .wet_cushion = contact_stiffness / (film_stiffness * found->wet_modulus)};
    return o;
}

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
    (void)of_kind(o);
    require(o.file.empty() || o.p4 == 0,
            "--fouling-file: expected no --fouling-p4 with it, found both");
    require(o.file.empty() || o.saturation == 0 || !find_vdb(o.file, "saturation"),
            fmt::format("--saturation: expected none with '{}', which has a grid saturation, "
                        "found {:g}",
                        o.file.string(), o.saturation));
}

void add_fouling(World& world, const FoulingOptions& given) {
    const FoulingOptions o = of_kind(given);
    add_fouling(world, o.settings, o.law);
}

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
