#include "systems/steps.hpp"

#include "engine/ranks.hpp"
#include "systems/broadphase/lists.hpp"
#include "systems/contact/collide.hpp"
#include "systems/contact/share_patches.hpp"
#include "systems/contact/sum_contacts.hpp"
#include "systems/fields/coupled_fields.hpp"
#include "systems/fields/weaken_contacts.hpp"
#include "systems/fusion/correct.hpp"
#include "systems/fusion/fuse.hpp"
#include "systems/guard.hpp"
#include "systems/integration/motion.hpp"
#include "systems/loads/table.hpp"
#include "systems/recorder/record_motion.hpp"
#include "systems/servo/membrane.hpp"
#include "systems/servo/platen.hpp"
#include "systems/slabs/slabs.hpp"
#include "systems/sleep/sleep.hpp"
#include "systems/sleeve/sleeve.hpp"
#include "systems/steps/move_spheres.hpp"

#include <algorithm>
#include <utility>

namespace bris {

namespace {

System damping_of(bool energy_budget) {
    return required(energy_budget ? row_local("damp_and_accumulate_work", damp_and_accumulate_work)
                                  : row_local("damp", damp));
}

/// Analyses read the records of contact forces, as readers outside the step do.
void note_observation(World& world) {
    world.resource<Observation>().due =
        world.resource<Clock>().observed || (world.has_resource<Replay>() && fusion_is_due(world));
}

/// Where nothing but contacts reads the motion of the bodies in every step, its columns are needed
/// only by the lists and after the last step. A new system that reads them in other steps has to be
/// named here.
void note_readers_of_motion(World& world) {
    MotionColumns& columns = world.resource<MotionColumns>();
    columns.current = !std::exchange(columns.skipped, false);
    columns.due = world.resource<Clock>().last || world.has_resource<Replay>() ||
                  world.has_resource<Weakening>() || world.has_resource<Sleep>() ||
                  world.has_resource<InertialRecorders>();
}

/// Contacts are weakened anew when fields, or the candidate pairs, have changed.
bool fields_or_lists_are_due(const World& world) {
    return world.has_resource<Weakening>() &&
           (weakening_is_due(world) || fields_are_due(world) || lists_are_due(world));
}

bool sleep_or_lists_are_due(const World& world) {
    return lists_are_due(world) || sleep_is_due(world);
}

StepList joined(const std::vector<StepList>& parts) {
    StepList list;
    for (const StepList& part : parts) list.insert(list.end(), part.begin(), part.end());
    return list;
}

StepList begin_of_step() {
    return {
        // where the world is one rank's part of a whole: not at the end of the step before, after
        // which the contacts of an observed step are read
        system("review_candidates", review_candidates),
        system("exchange_bodies", exchange_bodies),
        system("note_observation", note_observation),
        system("note_readers_of_motion", note_readers_of_motion),
        when(positions_are_due, system("complete_motion", complete_motion)),
    };
}

/// New lists when they are due, and then all positions that contacts read.
StepList lists_of_step() {
    const auto due = lists_are_due, moved = positions_are_due;
    return {
        when(due, system("rebuild_pairs", rebuild_pairs)),
        system("share_census", share_census),
        system("list_ghosts", list_ghosts),
        when(due, system("prune_pairs", prune_pairs)),
        when(moved, row_local("update_sphere_positions again", update_sphere_positions)),
        when(moved, row_local("update_clump_positions again", update_clump_positions)),
        when(moved, row_local("update_kicks again", update_kicks)),
        when(moved, row_local("apply_correction_velocity again", apply_correction_velocity)),
        when(moved, system("update_planes again", update_planes)),
        when(moved, system("update_facets again", update_facets)),
        when(moved, system("update_turned_facets again", update_turned_facets)),
        when(moved, system("update_triangles again", update_triangles)),
        when(moved, system("note_positions", note_positions)),
        when(sleep_or_lists_are_due, system("review_sleep", review_sleep)),
        when(fields_or_lists_are_due, system("weaken_contacts", weaken_contacts)),
    };
}

StepList contacts_of_step(LawName law, const StepChoices& choices) {
    return {
        system("choose_force_grid", choose_force_grid),
        system("share_sphere_patches", share_sphere_patches),
        system("share_plane_patches", share_plane_patches),
        required(collide_spheres(law, choices)),
        required(collide_facets(law, choices)),
        required(collide_planes(law, choices)),
        required(collide_membrane(law, choices)),
        required(collide_sleeve(law, choices)),
        system("sum_boundaries", sum_boundaries),
        system("share_boundary_forces", share_boundary_forces),
    };
}

/// Forces on bodies, which are complete after damping.
StepList forces_of_step(bool energy_budget) {
    return joined({
        {row_local("sum_contacts", sum_contacts), row_local("apply_gravity", apply_gravity)},
        force_systems_of_elements(),
        {row_local("accumulate_boundary_work", accumulate_boundary_work),
         row_local("accumulate_correction_work", accumulate_correction_work),
         damping_of(energy_budget)},
        work_systems_of_elements(),
    });
}

StepList motion_of_step() {
    return {
        row_local("note_motion", note_motion),
        row_local("integrate", integrate),
        row_local("rotate_spheres", rotate_spheres),
        row_local("rotate_clumps", rotate_clumps),
        row_local("apply_correction_rotation", apply_correction_rotation),
        row_local("apply_correction_displacement", apply_correction_displacement),
        row_local("hold_spheres", hold_spheres),
        row_local("hold_clumps", hold_clumps),
        system("pass_spheres", pass_spheres),
        system("pass_clumps", pass_clumps),
        system("pass_resting", pass_resting),
        row_local("update_sphere_positions", update_sphere_positions),
        row_local("update_clump_positions", update_clump_positions),
        row_local("update_kicks", update_kicks),
        row_local("apply_correction_velocity", apply_correction_velocity),
        row_local("bound_displacement", bound_displacement),
        row_local("bound_displacement_and_rotation", bound_displacement_and_rotation),
        row_local("watch_motion", watch_motion),
        combined(parts_of_move_spheres, row_local("move_spheres", move_spheres)),
        combined(parts_of_move_spheres_of_slab,
                 system("move_spheres_of_slab", move_spheres_of_slab)),
    };
}

StepList boundaries_of_step() {
    return {
        system("sum_membrane", sum_membrane),
        system("share_membrane_forces", share_membrane_forces),
        system("push_membrane", push_membrane),
        system("accumulate_membrane_work", accumulate_membrane_work),
        system("servo_membrane", servo_membrane),
        system("accumulate_membrane_work again", accumulate_membrane_work),
        system("sum_sleeve", sum_sleeve),
        system("share_sleeve_forces", share_sleeve_forces),
        system("pull_sleeve", pull_sleeve),
        system("accumulate_sleeve_work", accumulate_sleeve_work),
        system("count_platen_contacts", count_platen_contacts),
        system("share_platen_contacts", share_platen_contacts),
        system("servo_platen", servo_platen),
        system("accumulate_platen_work", accumulate_platen_work),
        system("move_sleeve", move_sleeve),
        system("accumulate_sleeve_work again", accumulate_sleeve_work),
        system("update_planes", update_planes),
        system("update_facets", update_facets),
        system("update_turned_facets", update_turned_facets),
        system("update_triangles", update_triangles),
    };
}

StepList end_of_step() {
    return {
        // assimilation of sensor recordings
        when(fusion_is_due, system("fuse_spheres", fuse_spheres)),
        when(fusion_is_due, system("fuse_clumps", fuse_clumps)),
        system("forget_sums_of_ghosts", forget_sums_of_ghosts),
        system("guard_sums", guard_sums),
        system("guard_spheres", guard_contacts<SpherePairs>),
        system("guard_facets", guard_contacts<FacetPairs>),
        system("guard_planes", guard_contacts<PlanePairs>),
        system("guard_membrane", guard_contacts<MembranePairs>),
        system("complete_motion_in_trouble", complete_motion_in_trouble),
        system("guard_motion", guard_motion),
        system("complete_motion_in_trouble again", complete_motion_in_trouble),
        // where the world is one rank's part of a whole
        system("review_lists", review_lists),
        system("agree_on_lists", agree_on_lists),
        // inertial recorders, which take no sample of a step that has failed
        when(is_recording, system("share_motion", share_motion)),
        when(is_recording, system("record_motion", record_motion)),
        system("complete_motion_for_ranks", complete_motion_for_ranks),
    };
}

} // namespace

bool whole_step_is_due(const World& world) {
    if (world.has_resource<Replay>() && fusion_is_due(world)) return true; // on all ranks alike
    if (!fields_are_checked(world)) return false;
    const bool here = fields_are_due(world);
    return world.has_resource<Slab>() ? Ranks::any(here) : here; // a part knows its own rocks only
}

bool can_be_observed(const World& part) {
    const Table& bodies = part.table<Bodies>();
    if (!bodies.has<PatchesOf>()) return true;
    const auto patches = bodies.column<PatchesOf>();
    const auto spheres = bodies.column<SpheresOf>();
    bool held = false;
    for (Row b = 0; b < patches.size(); ++b)
        held = held || (patches[b] > 0 && spheres[b].count > 0);
    return !Ranks::any(held);
}

StepList steps(LawName law, bool energy_budget, PatchStiffness patch) {
    // forces on bodies and their motion are one pass over the rows
    return joined({begin_of_step(), systems_of_fields(), lists_of_step(),
                   contacts_of_step(law, {energy_budget, patch}), forces_of_step(energy_budget),
                   motion_of_step(), boundaries_of_step(), end_of_step()});
}

} // namespace bris
