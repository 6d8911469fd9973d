#pragma once

#include "components/laws/hertz_edges.hpp"
#include "components/laws/hertz_frictionless.hpp"
#include "components/laws/hertz_mindlin.hpp"
#include "components/laws/hertz_mindlin_rolling.hpp"
#include "components/laws/hertz_mindlin_viscous.hpp"
#include "components/laws/linear.hpp"
#include "components/laws/linear_bridge.hpp"
#include "components/laws/linear_edges.hpp"
#include "components/laws/linear_frictionless.hpp"
#include "components/laws/linear_rolling.hpp"
#include "components/laws/linear_viscous.hpp"

namespace bris {

template <class... Ls>
struct LawList {};

/// All contact laws, in the order of LawName. A new law needs its own file, a name in LawName and
/// an entry here.
using Laws = LawList<LinearFrictionless, Linear, LinearViscous, LinearRolling, HertzFrictionless,
                     HertzMindlin, HertzMindlinViscous, HertzMindlinRolling, LinearBridge,
                     LinearEdges, HertzEdges>;

namespace detail {

template <class Visit, class First, class... Others>
auto with_law_of(LawList<First, Others...>, LawName law, Visit&& visit) {
    auto result = visit.template operator()<First>();
    (void)((Others::id == law ? (result = visit.template operator()<Others>(), true) : false) ||
           ...);
    return result;
}

} // namespace detail

/// Calls visit.template operator()<L>() with the law of that name, and returns its result.
template <class Visit>
auto with_law(LawName law, Visit&& visit) {
    return detail::with_law_of(Laws{}, law, std::forward<Visit>(visit));
}

} // namespace bris
