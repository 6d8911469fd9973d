#pragma once

#include "components/body.hpp"
#include "components/laws/table.hpp"
#include "systems/contact/collide.hpp"

namespace bris {

/// Calls make.template operator()<Law, columns of work...>() with the law of that name as it acts
/// on a membrane: only its normal spring and the dashpot of that, and no force beyond touch.
template <class Make>
System system_of_smooth_law(LawName law, const StepChoices& choices, Make&& make) {
    return with_law(law, [&]<class L>() {
        using Smooth = Law<typename L::Normal, typename L::DampingPart, Frictionless>;
        if constexpr (Smooth::has_dashpots)
            return choices.energy_budget
                       ? make.template operator()<Smooth, FrictionWork, ViscousWork, RollingWork>()
                       : make.template operator()<Smooth>();
        else
            return make.template operator()<Smooth>();
    });
}

} // namespace bris
