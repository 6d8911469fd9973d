#pragma once

#include "engine/options.hpp"
#include "engine/summary.hpp"
#include "systems/fields/initial_fouling.hpp"

#include <filesystem>
#include <string>

namespace bris {

/// Fines and water in the voids, as options of a scenario.
struct FoulingOptions {
    double p4 = 0, p200 = 0; ///< %
    std::string pattern = "uniform";
    double low = 0, high = 0.3;
    double saturation = 0;
    std::filesystem::path file = {};
    std::string kind = "assumed"; ///< of fines; others than assumed replace settings and law
    FoulingSettings settings = {};
    FoulingLaw law = {};

    void declare_options(auto& option);
    /// Whether there are fines or water.
    bool any() const { return p4 > 0 || saturation > 0 || !file.empty(); }
};

/// FoulingOptions::p4 (%) of fines that fill `vci` (%, void contaminant index) of the voids (m3)
/// in place, beside ballast of this mass (kg).
double p4_of_vci(double vci, const FoulingSettings& settings, double ballast, double voids);
/// With the settings and the law of its kind of fines. Throws InputError if they are stated too.
FoulingOptions of_kind(FoulingOptions options);
/// Throws InputError if options contradict each other.
void check_fouling(const FoulingOptions& options);
/// Adds the fields to a world before its State is loaded, or empty (add_fouling).
void add_fouling(World& world, const FoulingOptions& options);
/// Fills them for the present rocks (fill_with_fines).
void fill_with_fines(World& world, const FoulingOptions& options, std::uint64_t seed);
/// Results: measures of fouling, and factors of the contacts.
void add_fouling_results(Summary& summary, const World& world);

void FoulingOptions::declare_options(auto& option) {
    option.group("Fouling");
    option("fouling_p4", p4, "%",
           "Mass of fines (passing 4.75 mm) over the mass of ballast and fines. 0: no fines.",
           within(0, 50));
    option("fouling_p200", p200, "%",
           "Part of --fouling-p4 that passes 0.075 mm. The fouling index is the sum of both.",
           within(0, 50));
    option("fouling_pattern", pattern, "",
           "Distribution of the fines: uniform in the voids; layered, between --fouling-low and "
           "--fouling-high; random, different in each cube of four voxels.",
           {"uniform", "layered", "random"});
    option("fouling_low", low, "",
           "Lower end of the layer as a share of the height of the ballast.", within(0, 1));
    option("fouling_high", high, "",
           "Upper end of the layer as a share of the height of the ballast.", within(0, 1));
    option("fouling_file", file, "",
           "File .vdb with the grid fines (kg/m3), instead of the distribution, and, where it has "
           "one, the grid saturation (0 to 1), instead of --saturation.");
    option("saturation", saturation, "",
           "Share of the voids left by the fines that water fills. It acts only where there are "
           "fines.",
           within(0, 1));
    option("fouling_kind", kind, "",
           "Fines: assumed, by the options below. mineral (dust of the ballast), clay and coal "
           "state density, void ratio, friction and cushions themselves, with sources, and take "
           "none of those options.",
           {"assumed", "mineral", "clay", "coal"});
    option("fouling_voxel", settings.voxel, "m", "Edge of the voxels of the fields.",
           within(1e-4, 1));
    option("fouling_density", settings.density, "kg/m3", "Density of the particles of the fines.",
           within(100, 1e4));
    option("fouling_void_ratio", settings.void_ratio, "", "Void ratio of the fines in place.",
           within(0.1, 10));
    option("fouling_compacted_void_ratio", settings.least_void_ratio, "",
           "Void ratio of compacted fines, which limits what the voids can hold.",
           within(0.05, 10));
    option("fouling_friction_loss", law.friction_loss, "",
           "Loss of friction by fines, a_f of 1 - a_f g with g = VCI / (VCI + c). An assumption, "
           "not fitted to tests.",
           within(0, 0.99));
    option("fouling_moisture_loss", law.moisture_loss, "",
           "Further loss of friction by water among fines, a_w of 1 - a_w g s with the saturation "
           "s. An assumption, not fitted to tests.",
           within(0, 0.99));
    option("fouling_stiffness_loss", law.stiffness_loss, "",
           "Loss of normal and tangential stiffness by fines, b_f of 1 - b_f g. An assumption, not "
           "fitted to tests.",
           within(0, 0.99));
    option("fouling_dry_cushion", law.dry_cushion, "",
           "Stiffness of a contact over that of the film of dry fines in it: stiffness is divided "
           "by 1 + c g.",
           within(0, 1000));
    option("fouling_wet_cushion", law.wet_cushion, "", "The same of saturated fines.",
           within(0, 1000));
    option("fouling_half_effect", law.half_effect, "",
           "Void contaminant index, as a fraction, at which g is 1/2 (c).", within(1e-3, 1e3));
    option("fouling_least_friction", law.least_friction, "",
           "Friction does not fall below this by fines.", within(0, 100));
    option("fouling_least_stiffness", law.least_stiffness, "",
           "Stiffness does not fall below this share of that without fines.", within(0.01, 1));
}

} // namespace bris
