#pragma once

#include "components/laws/table.hpp"
#include "components/pair.hpp"
#include "systems/contact/collide.hpp"

namespace bris {

/// A list of column types.
template <class...>
struct Columns {};

namespace detail {

/// System of one law. `make` receives the law, the columns of near rows and those of pairs.
template <class L, class... Share, class Make>
System make_system_of(bool energy_budget, Make&& make) {
    if constexpr (L::has_rolling) {
        using Pairs = Columns<Spring, Roll>;
        return energy_budget
                   ? make.template operator()<L, Columns<PairTorque, PairWork, Share...>, Pairs>()
                   : make.template operator()<L, Columns<PairTorque, Share...>, Pairs>();
    } else if constexpr (L::has_history) {
        using Pairs = Columns<Spring>;
        return energy_budget ? make.template operator()<L, Columns<PairWork, Share...>, Pairs>()
                             : make.template operator()<L, Columns<Share...>, Pairs>();
    } else {
        return make.template operator()<L, Columns<Share...>, Columns<>>();
    }
}

} // namespace detail

/// Calls make.template operator()<Law, columns of near rows, columns of pairs>() with the law of
/// that name and the columns that it needs in addition to the force record.
template <class Make>
System system_of_law(LawName law, const StepChoices& choices, Make&& make) {
    return with_law(law, [&]<class L>() {
        return choices.patch == PatchStiffness::shared
                   ? detail::make_system_of<L, const PatchShare>(choices.energy_budget, make)
                   : detail::make_system_of<L>(choices.energy_budget, make);
    });
}

} // namespace bris
