#include "scenarios/forecast/site_ensemble.hpp"

#include "engine/ensemble.hpp"
#include "engine/errors.hpp"
#include "engine/estimation/low_discrepancy.hpp"
#include "engine/random.hpp"
#include "engine/resume.hpp"
#include "engine/run.hpp"

#include <fmt/format.h>

#include <cmath>
#include <optional>

namespace bris {

namespace {

constexpr std::size_t parameters = 4;

/// Common settings of a run in a folder of its own, which is created.
Common within_folder(const Common& common, const std::filesystem::path& folder) {
    Common own = common;
    own.out = folder;
    own.threads = 1;
    std::filesystem::create_directories(folder);
    return own;
}

/// Reads the passages of a site from its checkpoint; false if some are still to come.
bool is_complete(Site& site, std::size_t trains, const Common& own, const GoOn& go_on) {
    PassageRecord record;
    record.load(
        checkpoint_to_resume(site.state, own.scenario, own.settings, go_on.may_differ, go_on.option)
            .state);
    site.passages = record.passages;
    return site.passages.size() == trains;
}

/// Makes a site, trying one packing after the other, or goes on from its checkpoint in the folder.
Site made(const SiteDesign& design, Site site, const std::string& name,
          const std::vector<Train>& trains, const Common& own, const GoOn& go_on,
          const ReportProgress& report) {
    const std::uint64_t first = site.seed;
    const auto file = [&](unsigned packing) {
        return own.out / fmt::format("{}_packing_{}.ckpt.h5", name, packing + 1);
    };
    std::optional<unsigned> begun;
    for (unsigned k = 0; !go_on.option.empty() && k < design.packings && !begun; ++k)
        if (std::filesystem::exists(file(k))) begun = k;
    std::string why;
    for (unsigned k = begun.value_or(0); k < design.packings; ++k) {
        site.seed = first + k;
        site.redrawn = k;
        site.state = file(k);
        if (begun == k && is_complete(site, trains.size(), own, go_on)) return site;
        const std::string run = fmt::format("{}_packing_{}", name, k + 1);
        try {
            site.passages = run_trains({site.box, site.seed}, trains, own, run,
                                       begun == k ? site.state : "", go_on.may_differ, report)
                                .passages;
            return site;
        } catch (const SimulationError& error) {
            why = error.what();
            std::filesystem::remove(own.out / (run + ".stopped.ckpt.h5"));
            std::filesystem::remove(site.state);
        }
    }
    throw SimulationError(fmt::format("{}: none of {} packings can be made, the last one because "
                                      "of {}",
                                      name, design.packings, why));
}

} // namespace

BallastBox box_of_site(const BallastBox& middle, const SiteSpread& spread,
                       const std::vector<double>& u) {
    require(u.size() == parameters,
            fmt::format("site: expected {} numbers, found {}", parameters, u.size()));
    const auto factor = [](double most, double x) { return std::pow(most, 2 * x - 1); };
    BallastBox box = middle;
    box.friction_factor *= factor(spread.friction, u[0]);
    box.stiffness_factor *= factor(spread.stiffness, u[1]);
    box.subgrade_modulus *= factor(spread.subgrade, u[2]);
    box.porosity += spread.porosity * (2 * u[3] - 1);
    return box;
}

std::vector<Site> make_members(const SiteDesign& design, const std::vector<Train>& trains,
                               const Common& common, const std::filesystem::path& folder,
                               const GoOn& go_on) {
    constexpr std::uint64_t stream = 881; // of the shift of the sequence
    Random random(common.seed, stream);
    std::vector<double> shift(parameters);
    for (double& x : shift) x = random.uniform();
    const Common own = within_folder(common, folder);
    std::vector<Site> members(design.members);
    Progress progress = make_progress(common);
    run_ensemble(members.size(), common.threads, [&](std::size_t k) {
        auto u = low_discrepancy_point(k + 1, parameters);
        for (std::size_t i = 0; i < u.size(); ++i) u[i] = std::fmod(u[i] + shift[i], 1.0);
        const Site site{.box = box_of_site(design.box, design.spread, u),
                        .seed = (common.seed + 2000) * 1'000'000 + 10 * k};
        members[k] = made(design, site, fmt::format("member_{:02}", k + 1), trains, own, go_on,
                          progress_slot(progress, static_cast<unsigned>(k)));
    });
    progress.pause();
    return members;
}

std::vector<PassageMovements> pass_members(const std::vector<Site>& members,
                                           const std::vector<Train>& trains, const Common& common,
                                           const MayDiffer& may_differ) {
    const Common own = within_folder(common, common.out / "next");
    std::vector<PassageMovements> next(members.size());
    Progress progress = make_progress(common);
    run_ensemble(members.size(), common.threads, [&](std::size_t k) {
        const Site& member = members[k];
        next[k] =
            run_trains({member.box, member.seed}, trains, own, fmt::format("member_{:02}", k + 1),
                       member.state, may_differ, progress_slot(progress, static_cast<unsigned>(k)))
                .passages.back();
    });
    progress.pause();
    return next;
}

Site make_site(const SiteDesign& design, std::uint64_t seed, const std::vector<Train>& trains,
               const Common& common, const GoOn& go_on) {
    constexpr std::uint64_t stream = 882; // of the parameters of sites
    Random random(seed, stream);
    std::vector<double> u(parameters);
    for (double& x : u) x = random.uniform();
    const Site site{.box = box_of_site(design.box, design.spread, u),
                    .seed = (seed + 5000) * 1'000'000};
    Progress progress = make_progress(common);
    const Site done = made(design, site, "site", trains, within_folder(common, common.out / "site"),
                           go_on, progress_slot(progress, 0));
    progress.pause();
    return done;
}

} // namespace bris
