#include "engine/scenario.hpp"
#include "systems/broadphase/lists.hpp"
#include "systems/build/clump_library.hpp"
#include "systems/build/scene.hpp"
#include "systems/output/porosity.hpp"
#include "systems/output/balance.hpp"
#include "systems/procedure/triaxial.hpp"
#include "systems/steps.hpp"
#include <chrono>
#include <cstdio>
#include <fmt/format.h>
namespace bris {
struct Triaxial {
    unsigned bodies = 400;
    TriaxialSettings t;
    double start_porosity = 0.36;
    void describe(auto& option) {
        option("bodies", bodies, "", "rocks, sensor rocks included", at_least(20));
        option("confining_pressure", t.confining_pressure, "Pa", "on the membrane", above(0));
        option("stage_strain", t.stage_strain, "", "axial strain of a stage", above(0));
        option("final_axial_strain", t.final_axial_strain, "", "", above(0));
        option("tolerance", t.tolerance, "", "", above(0));
        option("safety", t.safety, "", "", above(0));
        option("move_steps", t.move_steps, "", "", at_least(1));
        option("compaction_friction", t.compaction_friction, "", "", at_least(0));
        option("compaction_pressure", t.compaction_pressure, "Pa", "", above(0));
        option("porosity", t.porosity, "", "", above(0));
        option("start_porosity", start_porosity, "", "", above(0));
    }
};
}
int main(int argc, char** argv) {
    using namespace bris;
    return run_scenario<Triaxial>(argc, argv, "triaxial", "x", [](const Triaxial& in, const Common& common) {
        auto clumps = read_clumps(BRIS_ASSETS "/clumps");
        std::erase_if(clumps, [](const Clump& c) { return c.name == "cube"; });
        const auto grading = read_grading(BRIS_ASSETS "/gradings/arema_4.csv");
        const auto sample = sample_rocks(grading, clumps, in.bodies - 10, common.seed);
        SpecimenSettings s;
        s.seed = common.seed;
        const Clump smart = scaled(clumps[0], s.smartrock_size / clumps[0].sieve);
        s.radius = radius_for(sample.solid_volume + 10 * smart.volume, in.start_porosity, s.sectors);
        s.height = 4 * s.radius;
        std::printf("R %.4f H %.4f solids %.5f\n%s\n", s.radius, s.height, sample.solid_volume, describe(sample, sieve_back(sample.rocks, clumps, grading, sample.truncated_fraction)).c_str());
        const auto poses = smart_rock_poses(s, smart.bounding_radius);
        World world = make_triaxial_world(s, clumps, smart, sample.rocks, poses);
        add_lists(world, true);
        world.table<NearSpheres>().add<SlipWork>();
        world.table<NearFacets>().add<SlipWork>();
        world.table<NearPlanes>().add<SlipWork>();
        Simulation sim(std::move(world), steps(LawName::linear, true), common.threads, {.serial = common.serial, .timed = true});
        if (common.explain) { std::puts(sim.schedule().explain().c_str()); return; }
        TriaxialTest test(sim, in.t);
        auto began = std::chrono::steady_clock::now();
        std::uint64_t last_step = 0, lift = 99, n = 0; auto phase = TriaxialPhase::done;
        while (test.advance()) {
            const auto& st = test.state();
            const auto& clock = sim.world().resource<Clock>();
            ++n;
            if (st.phase != phase || st.lift != lift || n % 200 == 0) {
                const double wall = std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
                const auto& ls = sim.world().resource<ListState>();
                const double top = sim.world().column<Bodies, Position>()[row_of_body(sim.world(), sim.world().resource<Specimen>().top)].z();
                std::printf("%.1fs %s step %lu dt %.3g us/step %.1f t %.4f top %.4f p_top %.4g n_core %.4f contacts %zu near %zu pairs %zu listed %zu refr %lu prunes %lu stage steps %lu ring0 %.4g\n", wall, test.description().c_str(), clock.step, clock.dt,
                            (wall) / static_cast<double>(clock.step - last_step) * 1e6, clock.time(), top, sim.world().resource<Platen>().pressure, st.phase == TriaxialPhase::fill ? porosity(sim.world(), {0.6*s.radius, 0.1*s.height, 0.2*s.height}, 120) : st.prepared_porosity, measure_balance(sim.world()).contacts,
                            sim.world().resource<NearIndex<SpherePairs>>().size(), sim.world().table<SpherePairs>().size(), sim.world().table<Listed>().size(), ls.refreshes, ls.prunes, st.phase_steps, sim.world().resource<Membrane>().pressure[0]);
                std::fflush(stdout);
                phase = st.phase; lift = st.lift;
                last_step = clock.step; began = std::chrono::steady_clock::now();
            }
        }
        std::printf("drift %.4f core %.4f H %.4f\n", test.state().drift, test.state().core_porosity, test.state().height);
        for (std::size_t k = 0; k < test.points().size(); k += test.points().size() / 20 + 1) {
            const auto& p = test.points()[k];
            std::printf("e %.4f ev %.5f q %.1f kPa p_r %.2f ring err %.2g/%.2g contact %.2f %.2f bound %.2f %.2f unb %.1e Z %.2f W %.3f E %.3f fr %.3f da %.3f ke %.2g steps %.0f\n", p.axial_strain, p.volumetric_strain, p.deviatoric_stress/1e3, p.radial_stress/1e3, p.mean_ring_error, p.worst_ring_error, p.contact_axial/1e3, p.contact_radial/1e3, p.boundary_axial/1e3, p.boundary_radial/1e3, p.unbalanced, p.coordination, p.boundary_work, p.stored, p.friction_work, p.damping_work, p.kinetic, p.steps);
        }
        for (const auto& [name, sec] : sim.schedule().seconds()) std::printf("%8.3f s %s\n", sec, name.c_str());
    });
}
