#include "components/laws/lanes.hpp"

#include <limits>

namespace bris {

namespace {
constexpr double infinity = std::numeric_limits<double>::infinity();
}

LawStep::LawStep(const ContactPolicy& policy, double step, bool energy_budget)
    : dt(step), least_force(policy.tension == Tension::allowed ? -infinity : 0),
      least_ratio(policy.shear_history == ShearHistory::total ? 1 : 0),
      largest_ratio(policy.shear_history == ShearHistory::incremental ? infinity : 1),
      shared(policy.patch == PatchStiffness::shared), accumulate_work(energy_budget) {}

} // namespace bris
