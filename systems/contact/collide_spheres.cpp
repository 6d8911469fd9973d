#include "components/kinds.hpp"
#include "components/settings.hpp"
#include "systems/contact/clump_spheres.hpp"
#include "systems/contact/collide.hpp"
#include "systems/contact/single_spheres.hpp"

namespace bris {

namespace {

template <class Law, class Near, class Pairs, class Work>
struct Collide;
template <class Law, class... Near, class... Pairs, class... Work>
struct Collide<Law, Columns<Near...>, Columns<Pairs...>, Columns<Work...>> {
    static void
    spheres(Rows<NearSpheres, const NearPair, const PartnerSum, PairForce, Near...> near,
            detail::ListedSpheres listed, detail::MovingBodies<Law, Work...> bodies,
            Rows<SpherePairs, Pairs...> pairs, NearIndex<SpherePairs>& index,
            Rows<ForceSums, ContactSum> force_sums, const ForceGrid& grid,
            const Materials& materials, const Limits& limits, const Observation& observation,
            const Clock& clock) {
        const auto target = detail::target_of<Law>(
            near, pairs, bodies, {force_sums, grid, materials, limits, observation, clock});
        const detail::SphereSurfaces surfaces{{listed, bodies, index},
                                              limits.overlap_of_contacts()};
        if (index.centred)
            detail::collide_all<Law>(target, detail::SingleSpheres{surfaces}, index);
        else
            detail::collide_all<Law>(target, detail::ClumpSpheres{surfaces}, index);
    }
};

} // namespace

System collide_spheres(LawName law, const StepChoices& choices) {
    return system_of_law(law, choices, []<class Law, class Near, class Pairs, class Work>() {
        return system("collide_spheres", Collide<Law, Near, Pairs, Work>::spheres);
    });
}

} // namespace bris
