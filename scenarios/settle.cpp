// N spheres settle in a box: the first scene, and the one that peers are measured on.

#include "engine/parallel.hpp"
#include "engine/random.hpp"
#include "engine/scenario.hpp"
#include "engine/simulation.hpp"
#include "systems/broadphase/lists.hpp"
#include "systems/build/scene.hpp"
#include "systems/output/quantities.hpp"
#include "systems/steps.hpp"

#include <chrono>
#include <cstdio>

namespace bris {

struct Settle {
    unsigned spheres = 2000;
    double radius = 0.01;
    double normal_stiffness = 1e6;
    double friction = 0.5;
    double damping_rate = 5838;
    double density = 2600;
    double step = 1e-5;
    double duration = 0.5;
    void describe(auto& option) {
        option("spheres", spheres, "", "how many", at_least(1));
        option("radius", radius, "m", "of each", above(0));
        option("normal_stiffness", normal_stiffness, "N/m", "of a contact", above(0));
        option("friction", friction, "", "Coulomb coefficient", at_least(0));
        option("damping_rate", damping_rate, "1/s", "of the normal dashpot; the tangential one has half", at_least(0));
        option("density", density, "kg/m3", "of the spheres", above(0));
        option("step", step, "s", "time step", above(0));
        option("duration", duration, "s", "simulated", above(0));
    }
};

} // namespace bris

int main(int argc, char** argv) {
    using namespace bris;
    return run_scenario<Settle>(argc, argv, "settle", "spheres settle in a box", [](const Settle& s, const Common& common) {
        World world = make_world(Grains::spheres);
        // two partners act in series: each has twice the stiffness of their contact
        const auto material = world.resource<Materials>().add({"grain", s.density, 2 * s.normal_stiffness, 4.0 / 7 * s.normal_stiffness,
                                                               s.friction, s.damping_rate, s.damping_rate / 2});
        const auto n = static_cast<int>(std::ceil(std::cbrt(s.spheres * 0.5)));
        const double pitch = 2.05 * s.radius;
        Random random(common.seed, 0);
        unsigned made = 0;
        for (int k = 0; made < s.spheres; ++k)
            for (int j = 0; j < n && made < s.spheres; ++j)
                for (int i = 0; i < n && made < s.spheres; ++i, ++made)
                    add_sphere(world, Vec3((i + 0.5) * pitch, (j + 0.5) * pitch, (k + 0.5) * pitch) + 0.02 * s.radius * random.direction(), s.radius, material);
        add_box(world, Vec3::Zero(), Vec3(n * pitch, n * pitch, 100 * n * pitch), material);
        world.add_resource<Gravity>();
        world.resource<Clock>().dt = s.step;
        add_lists(world, true);
        Simulation sim(std::move(world), steps(LawName::linear_viscous), common.threads, {.serial = common.serial, .timed = true});
        if (common.explain) {
            std::puts(sim.schedule().explain().c_str());
            return;
        }
        const auto total = static_cast<std::uint64_t>(s.duration / s.step);
        for (int part = 0; part < 5; ++part) {
            const auto began = std::chrono::steady_clock::now();
            const auto before = sim.world().resource<ListState>();
            sim.advance(total / 5);
            const double wall = std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
            const auto& after = sim.world().resource<ListState>();
            const Quantities q = measure(sim.world());
            std::printf("%.3f s wall %.2f  %.3f M particle-steps/s  KE %.3e Z %.3f contacts %zu near %zu pairs %zu  prunes %llu refreshes %llu skins %.3g %.3g floor %.6g\n",
                        sim.world().resource<Clock>().time(), wall, s.spheres * static_cast<double>(total / 5) / wall * 1e-6,
                        q.kinetic_energy, q.coordination, q.contacts, sim.world().resource<NearIndex<SpherePairs>>().size(), sim.world().table<SpherePairs>().size(),
                        static_cast<unsigned long long>(after.prunes - before.prunes), static_cast<unsigned long long>(after.refreshes - before.refreshes),
                        sim.world().resource<ListSettings>().inner_skin / s.radius, sim.world().resource<ListSettings>().outer_skin / s.radius,
                        q.boundary_force.z() / q.weight.z());
        }
        for (const auto& [name, sec] : sim.schedule().seconds()) std::printf("%8.3f s %s\n", sec, name.c_str());
        std::printf("fingerprint %016llx\n", static_cast<unsigned long long>(fingerprint(sim.snapshot())));
    });
}
