#include "scenarios/specimens/equilibrium.hpp"

#include "engine/clock.hpp"
#include "engine/errors.hpp"

#include <fmt/format.h>

namespace bris {

bool carries_load(const Balance& balance) {
    return balance.contacts > 0 && balance.contacts >= balance.free_bodies - balance.idle_bodies;
}

std::uint64_t find_equilibrium(Simulation& simulation, const EquilibriumSettings& settings) {
    Balance balance;
    for (std::uint64_t done = 0; done < settings.longest;) {
        simulation.advance(settings.every);
        done += settings.every;
        balance = compute_balance(simulation.world());
        if (carries_load(balance) && balance.unbalanced_ratio <= settings.ratio) return done;
    }
    const bool loaded = carries_load(balance);
    const auto& clock = simulation.world().resource<Clock>();
    throw SimulationError(
        fmt::format("step {}, time {:.6g} s: {} after {} steps: unbalanced ratio {:.2e} (required "
                    "{:.1e}), {} contacts of {} free bodies, {} of "
                    "which have no contact",
                    clock.step, clock.time(), loaded ? "no equilibrium" : "no load path",
                    settings.longest, balance.unbalanced_ratio, settings.ratio, balance.contacts,
                    balance.free_bodies, balance.idle_bodies));
}

} // namespace bris
