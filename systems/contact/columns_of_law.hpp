#pragma once

#include "components/body.hpp"
#include "components/laws/table.hpp"
#include "components/pair.hpp"
#include "systems/contact/collide.hpp"

namespace bris {

/// A list of column types.
template <class...>
struct Columns {};

namespace detail {

/// System of one law. `make` receives the law, the columns of near rows, of pairs and of bodies.
template <class L, class... Share, class Make>
System make_system_of(bool energy_budget, Make&& make) {
    using Near = Columns<Share...>;
    using Work =
        std::conditional_t<L::has_wear, Columns<FrictionWork, ViscousWork, RollingWork, WearWork>,
                           Columns<FrictionWork, ViscousWork, RollingWork>>;
    const auto make_with = [&]<class Pairs>() {
        return energy_budget ? make.template operator()<L, Near, Pairs, Work>()
                             : make.template operator()<L, Near, Pairs, Columns<>>();
    };
    if constexpr (L::has_wear)
        return make_with.template operator()<Columns<Spring, Roll, Worn>>();
    else if constexpr (L::has_rolling)
        return make_with.template operator()<Columns<Spring, Roll>>();
    else if constexpr (L::has_history)
        return make_with.template operator()<Columns<Spring>>();
    else
        return make.template operator()<L, Near, Columns<>, Columns<>>();
}

} // namespace detail

/// Calls make.template operator()<Law, columns of near rows, of pairs and of bodies>() with the law
/// of that name and the columns that it needs in addition to those of all laws.
template <class Make>
System system_of_law(LawName law, const StepChoices& choices, Make&& make) {
    return with_law(law, [&]<class L>() {
        return choices.patch == PatchStiffness::shared
                   ? detail::make_system_of<L, const PatchShare>(choices.energy_budget, make)
                   : detail::make_system_of<L>(choices.energy_budget, make);
    });
}

} // namespace bris
