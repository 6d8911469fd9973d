#include "systems/steps.hpp"

#include "systems/broadphase/lists.hpp"
#include "systems/contact/collide.hpp"
#include "systems/contact/gather.hpp"
#include "systems/contact/list_contacts.hpp"
#include "systems/contact/share_patches.hpp"
#include "systems/fusion/correct.hpp"
#include "systems/fusion/fuse.hpp"
#include "systems/fusion/pull.hpp"
#include "systems/guard.hpp"
#include "systems/integration/motion.hpp"
#include "systems/servo/membrane.hpp"
#include "systems/servo/platen.hpp"
#include "systems/sleep/sleep.hpp"

namespace bris {

namespace {

template <class Pairs>
System gather_of(const char* name, LawName law, bool ledger) {
    if (has_rolling(law))
        return required(ledger ? row_local(name, gather_and_book<Pairs, PairTorque>)
                               : row_local(name, gather<Pairs, PairTorque>));
    return required(ledger && has_springs(law) ? row_local(name, gather_and_book<Pairs>)
                                               : row_local(name, gather<Pairs>));
}

/// Without friction, it has work to book only with dashpots.
System gather_of_membrane(LawName law, bool ledger) {
    constexpr auto name = "gather_membrane";
    return ledger && has_dashpots(law) ? row_local(name, gather_and_book<MembranePairs>)
                                       : row_local(name, gather<MembranePairs>);
}

bool sleep_or_lists_are_due(const World& world) {
    return lists_are_due(world) || sleep_is_due(world);
}

} // namespace

StepList steps(LawName law, bool ledger, PatchStiffness patch) {
    const auto due = lists_are_due, places_due = places_are_due;
    const StepChoices choices{ledger, patch};
    return {
        // rarely: new lists, then everything placed anew
        when(due, system("refresh_pairs", refresh_pairs)),
        when(due, system("prune_pairs", prune_pairs)),
        when(places_due, row_local("place_spheres again", place_spheres)),
        when(places_due, row_local("place again", place)),
        when(places_due, row_local("place_kicks again", place_kicks)),
        when(places_due, row_local("tell_corrections again", tell_corrections)),
        when(places_due, system("place_planes again", place_planes)),
        when(places_due, system("place_facets again", place_facets)),
        when(places_due, system("note_places", note_places)),
        when(sleep_or_lists_are_due, system("review_sleep", review_sleep)),
        // forces of pairs
        system("share_sphere_patches", share_sphere_patches),
        system("share_plane_patches", share_plane_patches),
        required(collide_spheres(law, choices)),
        required(collide_facets(law, choices)),
        required(collide_planes(law, choices)),
        required(collide_membrane(law, choices)),
        // who touches whom now
        system("list_sphere_contacts", list_contacts<SpherePairs>),
        system("list_facet_contacts", list_contacts<FacetPairs>),
        system("list_plane_contacts", list_contacts<PlanePairs>),
        system("list_membrane_contacts", list_contacts<MembranePairs>),
        // forces on bodies, and their motion: one pass over the rows
        row_local("clear_forces", clear_forces),
        row_local("weigh", weigh),
        gather_of<SpherePairs>("gather_spheres", law, ledger),
        gather_of<FacetPairs>("gather_facets", law, ledger),
        gather_of<PlanePairs>("gather_planes", law, ledger),
        gather_of_membrane(law, ledger),
        row_local("book_boundary_work", book_boundary_work),
        row_local("book_corrections", book_corrections),
        row_local("pull_spheres", pull_spheres),
        row_local("pull_clumps", pull_clumps),
        required(ledger ? row_local("damp_and_book", damp_and_book) : row_local("damp", damp)),
        row_local("integrate", integrate),
        row_local("turn_spheres", turn_spheres),
        row_local("turn", turn),
        row_local("turn_corrections", turn_corrections),
        row_local("shift_corrections", shift_corrections),
        row_local("hold_spheres", hold_spheres),
        row_local("hold_clumps", hold_clumps),
        row_local("place_spheres", place_spheres),
        row_local("place", place),
        row_local("place_kicks", place_kicks),
        row_local("tell_corrections", tell_corrections),
        row_local("measure_travel", measure_travel),
        row_local("measure_travel_and_turn", measure_travel_and_turn),
        // boundaries
        system("push_membrane", push_membrane),
        system("book_membrane_work", book_membrane_work),
        system("steer_membrane", steer_membrane),
        system("book_membrane_work again", book_membrane_work),
        system("steer_platen", steer_platen),
        system("book_platen_work", book_platen_work),
        system("place_planes", place_planes),
        system("place_facets", place_facets),
        // what sensors have recorded of their bodies
        when(fusion_is_due, system("fuse_spheres", fuse_spheres)),
        when(fusion_is_due, system("fuse_clumps", fuse_clumps)),
        // stop on what cannot be
        system("guard_motion", guard_motion),
        system("guard_spheres", guard_overlap<SpherePairs>),
        system("guard_facets", guard_overlap<FacetPairs>),
        system("guard_planes", guard_overlap<PlanePairs>),
        system("guard_membrane", guard_overlap<MembranePairs>),
    };
}

} // namespace bris
