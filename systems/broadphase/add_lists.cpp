#include "components/boundary.hpp"
#include "components/census.hpp"
#include "components/force_sums.hpp"
#include "components/membrane.hpp"
#include "components/sleeve.hpp"
#include "systems/broadphase/lists.hpp"
#include "systems/broadphase/sphere_rows.hpp"

namespace bris {

void forget_lists(World& world) {
    invalidate_lists(world);
    for_each_kind_of_pair([&]<class Pairs>() {
        if (world.has<Pairs>()) world.resource<NearIndex<Pairs>>() = {};
    });
    detail::find_runs(world);
}

namespace {

template <class Pairs>
void add_pair_tables(World& world, LawName law) {
    Table& pairs = world.table<Pairs>();
    pairs.add<PairKey>();
    pairs.add<PairRows>();
    if (has_springs(law)) pairs.add<Spring>();
    if (has_rolling(law)) pairs.add<Roll>();
    // a membrane is too soft to blunt an edge
    if (has_wear(law) && !std::is_same_v<Pairs, MembranePairs>) pairs.add<Worn>();
    Table& near = world.table<typename Pairs::Near>();
    near.add<NearPair>();
    near.add<PartnerSum>();
    near.add<PairForce>();
    world.add_resource<NearIndex<Pairs>>();
    world.add_resource<detail::Candidates<Pairs>>();
}

} // namespace

void add_lists(World& world, LawName law, ListSettings settings) {
    Table& bodies = world.table<Bodies>();
    const bool has_clumps = !bodies.has<SphereInertia>();
    bodies.add<SpheresOf>();
    bodies.add<DisplacementBound>();
    bodies.add<PrunedAt>();
    bodies.add<RebuiltAt>();
    if (has_clumps) {
        bodies.add<PrunedOrientation>();
        bodies.add<RebuiltOrientation>();
    }
    bodies.add<InnerSkin>();
    bodies.add<OuterSkin>();
    bodies.add<SurfaceSpeed>();
    bodies.add<SumsFromOthers>();
    bodies.add<Force>();
    bodies.add<Torque>();
    bodies.add<RigidMotion>();
    bodies.add<CentreOf>();
    if (has_dashpots(law)) bodies.add<Kick>();
    world.table<ForceSums>().add<ContactSum>();
    world.table<ForceSums>().add<NextSum>();
    world.table<Spheres>().add<ListedSlot>();
    world.table<Spheres>().add<EnlargedSphere>();
    Table& listed = world.table<Listed>();
    if (has_clumps) listed.add<ListedBall>();
    listed.add<ListedBody>();
    listed.add<ListedPosition>();
    add_pair_tables<SpherePairs>(world, law);
    if (world.has<Planes>()) add_pair_tables<PlanePairs>(world, law);
    if (world.has<Facets>()) add_pair_tables<FacetPairs>(world, law);
    if (world.has<Elements>() || world.has<Triangles>())
        add_pair_tables<MembranePairs>(world,
                                       LawName::linear_frictionless); // for any law between grains
    if (world.has<Triangles>()) {
        world.table<NearMembrane>().add<TreadOf>();
        world.add_resource<SleeveSums>();
    }
    if (world.has<Elements>()) {
        world.table<NearMembrane>().add<FootOf>();
        world.add_resource<MembraneBands>();
        world.add_resource<ElementSums>();
        world.add_resource<MembraneSums>();
    }
    if (world.resource<Materials>().policy.patch == PatchStiffness::shared) {
        world.table<NearSpheres>().add<PatchShare>();
        if (world.has<Planes>()) world.table<NearPlanes>().add<PatchShare>();
    }
    world.add_resource(settings);
    world.add_resource(ContactLaw{law});
    world.add_resource<ListState>();
    world.add_resource<ForceGrid>();
    world.add_resource<BoundarySums>();
    world.add_resource<Overload>();
    world.add_resource<Census>();
    world.add_resource<Observation>();
    world.add_resource<MotionColumns>();
}

} // namespace bris
