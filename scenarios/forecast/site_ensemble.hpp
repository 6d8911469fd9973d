#pragma once

#include "engine/options.hpp"
#include "engine/progress.hpp"
#include "engine/scenario.hpp"
#include "scenarios/ballast_box/track_slice.hpp"

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace bris {

/// How sites differ from the box that describes their middle, beside their packings: factors are
/// uniform in their logarithm from 1 / F to F, and the porosity is uniform within +- its spread.
struct SiteSpread {
    double friction = 1.25, stiffness = 2, subgrade = 2, porosity = 0.015;
    void declare_options(auto& option);
};

/// A site: `u` are four numbers in [0, 1), its place within the spreads of friction, stiffness,
/// modulus of the subgrade and porosity.
BallastBox box_of_site(const BallastBox& middle, const SiteSpread& spread,
                       const std::vector<double>& u);

/// What the members of an ensemble, and the site that they stand for, are made of.
struct SiteDesign {
    BallastBox box = {.fines = "filled"}; ///< a track in use is fouled when it is made
    SiteSpread spread = {};
    unsigned members = 16;
    unsigned packings = 4; ///< tried for a member before the ensemble is given up
};

/// A member of the ensemble or a simulated site.
struct Site {
    BallastBox box = {};
    std::uint64_t seed = 0;           ///< of its packing
    std::filesystem::path state = {}; ///< checkpoint after the passages
    std::vector<PassageMovements> passages = {};
    unsigned redrawn = 0; ///< packings that could not be made
};

/// Settings in a checkpoint that may differ from those of the run that reads it.
using MayDiffer = std::vector<std::string_view>;

/// Whether checkpoints that are in a folder already are read, complete or not.
struct GoOn {
    std::string option; ///< that names them in messages; empty: all is made anew
    MayDiffer may_differ = {};
};

/// Makes the members of an ensemble, over each of which all trains pass, `threads` at a time, with
/// their checkpoints in `folder`. Throws SimulationError if none of the packings of a member can be
/// made; InputError, OutputError, Interrupted.
std::vector<Site> make_members(const SiteDesign& design, const std::vector<Train>& trains,
                               const Common& common, const std::filesystem::path& folder,
                               const GoOn& go_on);

/// Lets the last of all trains pass over each member, whose checkpoint stays as it is. New
/// checkpoints are in the folder `next` of the results. Throws as make_members.
std::vector<PassageMovements> pass_members(const std::vector<Site>& members,
                                           const std::vector<Train>& trains, const Common& common,
                                           const MayDiffer& may_differ);

/// A site that no member knows: its parameters and packing follow from `seed`. All trains pass over
/// it; its checkpoints are in the folder `site` of the results. Throws as make_members.
Site make_site(const SiteDesign& design, std::uint64_t seed, const std::vector<Train>& trains,
               const Common& common, const GoOn& go_on);

void SiteSpread::declare_options(auto& option) {
    option.group("Spread of the sites about the ballast and track described above");
    option("friction_spread", friction, "",
           "Sites have a friction from that of the ballast divided by this number to that times "
           "this number.",
           within(1, 2));
    option("stiffness_spread", stiffness, "", "The same for the contact stiffness.", within(1, 10));
    option("subgrade_spread", subgrade, "", "The same for the modulus of the subgrade.",
           within(1, 10));
    option("porosity_spread", porosity, "",
           "Sites have a porosity from --porosity minus to --porosity plus this number.",
           within(0, 0.05));
}

} // namespace bris
